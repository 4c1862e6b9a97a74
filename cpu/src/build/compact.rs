//! Blocks of compact octrees: equal corners become one vertex, which blocks name by number.

use std::collections::HashMap;

use leafwalk_core::layout::{BLOCK_WIDTH, Block, IndexedBlock};

/// Vertices that a block can name, from its base on.
const REACH: usize = 1 << 16;
/// Vertices that a block names at most.
const CORNERS: usize = 3 * BLOCK_WIDTH;

/// Blocks in the order of the file as they name their vertices, and these, numbered as they are first named.
///
/// A corner that was last named out of a block's reach becomes a vertex once more.
pub(crate) fn index(blocks: impl Iterator<Item = Block>) -> (Vec<IndexedBlock>, Vec<[f32; 3]>) {
    let (mut indexed, mut vertices) = (Vec::new(), Vec::new());
    let mut latest = HashMap::new();
    for block in blocks {
        // However many of its corners are new, all that it names are then within reach of each other.
        let first_in_reach = (vertices.len() + CORNERS).saturating_sub(REACH);
        let mut numbers = [[0; BLOCK_WIDTH]; 3];
        for lane in 0..BLOCK_WIDTH {
            for (corner, vertex) in block.corners(lane).into_iter().enumerate() {
                let next = vertices.len();
                let number = latest.entry(vertex.map(f32::to_bits)).or_insert(next);
                if *number < first_in_reach {
                    *number = next;
                }
                if *number == next {
                    vertices.push(vertex);
                }
                numbers[corner][lane] = *number;
            }
        }
        let base = numbers.as_flattened().iter().copied().min().unwrap_or(0);
        let numbers = numbers.map(|corner| corner.map(|number| (number - base) as u16));
        indexed.push(IndexedBlock { primitives: block.primitives, base: base as u32, numbers });
    }
    (indexed, vertices)
}

#[cfg(test)]
mod tests {
    use leafwalk_core::layout::NONE;

    use super::*;

    /// A block of two triangles, of vertices given by numbers.
    fn block(vertices: [[u32; 3]; 2]) -> Block {
        let corner = |number: u32| [number as f32, (number % 7) as f32, 0.0];
        let lane = |lane: usize| if lane == 1 { vertices[1] } else { vertices[0] };
        Block {
            vertices: core::array::from_fn(|c| {
                core::array::from_fn(|k| core::array::from_fn(|l| corner(lane(l)[c])[k]))
            }),
            primitives: [0, 1, NONE, NONE, NONE, NONE, NONE, NONE],
        }
    }

    #[test]
    fn vertices_out_of_reach_come_again() {
        // Strips of ever new vertices that all share vertex 0.
        let strips = (0..20_000).map(|i| block([[0, 4 * i + 1, 4 * i + 2], [4 * i + 3, 4 * i + 4, 0]]));
        let blocks: Vec<Block> = strips.collect();
        let (indexed, vertices) = index(blocks.iter().copied());
        let again = vertices.iter().filter(|vertex| **vertex == [0.0; 3]).count();
        assert_eq!((again, vertices.len()), (2, 80_000 + 2));
        for (block, indexed) in blocks.iter().zip(&indexed) {
            for lane in 0..BLOCK_WIDTH {
                let vertex = |c: usize| vertices[indexed.base as usize + usize::from(indexed.numbers[c][lane])];
                assert_eq!(block.corners(lane), [vertex(0), vertex(1), vertex(2)]);
            }
        }
    }
}
