//! The triangles of blocks: their primitives, and their corners or the numbers of their vertices.

use super::wrong_length;
use crate::blocks::{Blocks, Indexed};
use crate::contract::SMALLEST;
use crate::error::DecodeError;
use crate::layout::{BLOCK_WIDTH, Block, IndexedBlock, LATTICE, NONE, Section, VERTEX_WORDS};
use crate::parts::Parts;

/// Checks all blocks, and that they hold as many triangles as the mesh has, but for those dropped.
pub(super) fn check(parts: &Parts<'_>, margin: f32) -> Result<(), DecodeError> {
    let primitives = parts.header.primitives;
    let inside = parts.frame.corner.map(|corner| Inside { corner, margin });
    let listed = match parts.blocks {
        Blocks::Packed(blocks) => {
            let mut listed = 0;
            for (number, block) in (0..).zip(blocks) {
                listed += packed(block, number, primitives, &inside)?;
            }
            listed
        }
        Blocks::Indexed(blocks) => indexed(blocks, primitives, &inside)?,
    };
    if listed == primitives - parts.header.dropped { Ok(()) } else { Err(DecodeError::Header { field: "dropped" }) }
}

/// What coordinates along an axis lie inside the root, by a margin.
struct Inside {
    corner: f32,
    margin: f32,
}

impl Inside {
    /// Whether a coordinate is one that a mesh may have: inside, and neither tiny nor -0.
    #[inline(always)]
    fn holds(&self, coordinate: f32) -> bool {
        let within = coordinate - self.corner;
        let is_inside = (within >= self.margin) & (within <= LATTICE as f32 - self.margin);
        is_inside & ((coordinate.abs() >= SMALLEST) | (coordinate.to_bits() == 0))
    }
}

/// Checks a block with corners, all lanes at once; returns how many triangles it holds. A vacant lane has the corners of the
/// first one.
fn packed(block: &Block, number: u32, primitives: u32, inside: &[Inside; 3]) -> Result<u32, DecodeError> {
    let (mut outside, mut unlike_first) = ([false; BLOCK_WIDTH], [0; BLOCK_WIDTH]);
    for corner in &block.vertices {
        for (coordinates, inside) in corner.iter().zip(inside) {
            for lane in 0..BLOCK_WIDTH {
                outside[lane] |= !inside.holds(coordinates[lane]);
                unlike_first[lane] |= coordinates[lane].to_bits() ^ coordinates[0].to_bits();
            }
        }
    }
    let is_wrong = |lane: usize| match block.primitives[lane] {
        NONE => lane == 0 || unlike_first[lane] != 0,
        primitive => primitive >= primitives || outside[lane],
    };
    match (0..BLOCK_WIDTH).find(|lane| is_wrong(*lane)) {
        Some(lane) => Err(DecodeError::BadBlock { block: number, lane: lane as u32 }),
        None => Ok(block.primitives.iter().filter(|primitive| **primitive != NONE).count() as u32),
    }
}

/// Checks blocks that name their vertices, and these; returns how many triangles they hold.
fn indexed(indexed: Indexed<'_>, primitives: u32, inside: &[Inside; 3]) -> Result<u32, DecodeError> {
    let Indexed { blocks, vertices } = indexed;
    let is_outside = |vertex: &[f32; 3]| vertex.iter().zip(inside).any(|(c, inside)| !inside.holds(*c));
    if let Some(vertex) = vertices.iter().position(is_outside) {
        return Err(DecodeError::BadVertex { vertex: vertex as u32 });
    }
    let (mut listed, mut named) = (0, 0);
    for (number, block) in (0..).zip(blocks) {
        for (lane, primitive) in block.primitives.into_iter().enumerate() {
            let is_vacant = primitive == NONE;
            let has_primitive = if is_vacant { lane > 0 } else { primitive < primitives };
            if !has_primitive || !names_vertices(block, lane, vertices.len(), &mut named) {
                return Err(DecodeError::BadBlock { block: number, lane: lane as u32 });
            }
            listed += u32::from(!is_vacant);
        }
    }
    if named == vertices.len() {
        Ok(listed)
    } else {
        Err(wrong_length(Section::Vertices, vertices.len(), VERTEX_WORDS))
    }
}

/// Each vertex is one that was named before, or the next of all: so none is left out. A vacant lane names those of the
/// first one.
fn names_vertices(block: &IndexedBlock, lane: usize, vertices: usize, named: &mut usize) -> bool {
    if block.primitives[lane] == NONE {
        return block.numbers.iter().all(|corner| corner[lane] == corner[0]);
    }
    block.numbers.iter().all(|corner| {
        let vertex = (block.base as usize).saturating_add(usize::from(corner[lane]));
        *named += usize::from(vertex == *named);
        vertex < *named && vertex < vertices
    })
}
