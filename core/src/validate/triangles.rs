//! The triangles of blocks: their primitives, and their corners or the numbers of their vertices.

use core::ops::RangeInclusive;

use super::wrong_length;
use crate::blocks::{Blocks, Indexed};
use crate::contract::SMALLEST;
use crate::error::DecodeError;
use crate::layout::{BLOCK_WIDTH, Block, IndexedBlock, NONE, Section, VERTEX_WORDS};
use crate::parts::Parts;

/// Checks all blocks, and that they hold as many triangles as the header says.
pub(super) fn check(parts: &Parts<'_>, margin: f32) -> Result<(), DecodeError> {
    let primitives = parts.header.primitives;
    let references = match parts.blocks {
        Blocks::Packed(blocks) => {
            let mut references = 0;
            for (number, block) in (0..).zip(blocks) {
                references += packed(block, number, primitives, margin)?;
            }
            references
        }
        Blocks::Indexed(blocks) => indexed(blocks, primitives, &(margin..=1.0 - margin))?,
    };
    if references == parts.header.references { Ok(()) } else { Err(DecodeError::Header { field: "references" }) }
}

/// Checks a block with corners, all lanes at once; returns how many triangles it holds. A vacant lane has the corners of the
/// first one.
fn packed(block: &Block, number: u32, primitives: u32, margin: f32) -> Result<u32, DecodeError> {
    // Floats that are not negative are ordered as their bits are; NaN and those below zero are outside as integers.
    let (least, most) = (margin.max(SMALLEST).to_bits() as i32, (1.0 - margin).to_bits() as i32);
    let zero = u32::from(margin == 0.0);
    let (mut outside, mut unlike_first) = ([0; BLOCK_WIDTH], [0; BLOCK_WIDTH]);
    for coordinates in block.vertices.as_flattened() {
        let bits = coordinates.map(|c| c.to_bits() as i32);
        for lane in 0..BLOCK_WIDTH {
            let is_zero = zero & u32::from(bits[lane] == 0);
            outside[lane] |= u32::from(bits[lane] < least) & !is_zero | u32::from(bits[lane] > most);
            unlike_first[lane] |= bits[lane] ^ bits[0];
        }
    }
    let is_wrong = |lane: usize| match block.primitives[lane] {
        NONE => lane == 0 || unlike_first[lane] != 0,
        primitive => primitive >= primitives || outside[lane] != 0,
    };
    match (0..BLOCK_WIDTH).find(|lane| is_wrong(*lane)) {
        Some(lane) => Err(DecodeError::BadBlock { block: number, lane: lane as u32 }),
        None => Ok(block.primitives.iter().filter(|primitive| **primitive != NONE).count() as u32),
    }
}

/// Checks blocks that name their vertices, and these; returns how many triangles they hold.
fn indexed(indexed: Indexed<'_>, primitives: u32, inside: &RangeInclusive<f32>) -> Result<u32, DecodeError> {
    let Indexed { blocks, vertices } = indexed;
    if let Some(vertex) = vertices.iter().position(|vertex| !is_inside(vertex, inside)) {
        return Err(DecodeError::BadVertex { vertex: vertex as u32 });
    }
    let (mut references, mut named) = (0, 0);
    for (number, block) in (0..).zip(blocks) {
        for (lane, primitive) in block.primitives.into_iter().enumerate() {
            let is_vacant = primitive == NONE;
            let has_primitive = if is_vacant { lane > 0 } else { primitive < primitives };
            if !has_primitive || !names_vertices(block, lane, vertices.len(), &mut named) {
                return Err(DecodeError::BadBlock { block: number, lane: lane as u32 });
            }
            references += u32::from(!is_vacant);
        }
    }
    if named == vertices.len() {
        Ok(references)
    } else {
        Err(wrong_length(Section::Vertices, vertices.len(), VERTEX_WORDS))
    }
}

fn is_inside(corner: &[f32; 3], inside: &RangeInclusive<f32>) -> bool {
    corner.iter().all(|c| inside.contains(c) && (c.to_bits() == 0 || *c >= SMALLEST))
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
