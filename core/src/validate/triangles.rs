//! The triangles of blocks: their primitives, and their corners or the numbers of their vertices.

use core::ops::RangeInclusive;

use super::wrong_length;
use crate::blocks::{Blocks, Indexed};
use crate::error::DecodeError;
use crate::layout::{BLOCK_WIDTH, Block, IndexedBlock, NONE, SMALLEST, VERTEX_WORDS};
use crate::octree::Parts;
use crate::wire::Section;

/// Checks all blocks, and that they hold as many triangles as the header says.
pub(super) fn check(parts: &Parts<'_>, margin: f32) -> Result<(), DecodeError> {
    let inside = margin..=1.0 - margin;
    let references = match parts.blocks {
        Blocks::Packed(blocks) => packed(blocks, parts.header.primitives, &inside)?,
        Blocks::Indexed(blocks) => indexed(blocks, parts.header.primitives, &inside)?,
    };
    if references == parts.header.references { Ok(()) } else { Err(DecodeError::Header { field: "references" }) }
}

/// Checks blocks with corners; returns how many triangles they hold.
fn packed(blocks: &[Block], primitives: u32, inside: &RangeInclusive<f32>) -> Result<u32, DecodeError> {
    let mut references = 0;
    for (number, block) in (0..).zip(blocks) {
        references += lanes(&block.primitives, number, primitives, |lane| has_corners(block, lane, inside))?;
    }
    Ok(references)
}

/// Checks blocks that name their vertices, and these; returns how many triangles they hold.
fn indexed(indexed: Indexed<'_>, primitives: u32, inside: &RangeInclusive<f32>) -> Result<u32, DecodeError> {
    let Indexed { blocks, vertices } = indexed;
    if let Some(vertex) = vertices.iter().position(|vertex| !is_inside(vertex, inside)) {
        return Err(DecodeError::BadVertex { vertex: vertex as u32 });
    }
    let (mut references, mut named) = (0, 0);
    for (number, block) in (0..).zip(blocks) {
        let corners = |lane| names_vertices(block, lane, vertices.len(), &mut named);
        references += lanes(&block.primitives, number, primitives, corners)?;
    }
    if named == vertices.len() {
        Ok(references)
    } else {
        Err(wrong_length(Section::Vertices, vertices.len(), VERTEX_WORDS))
    }
}

/// Checks a block by its primitives and what is asked of the corners of each lane; returns how many triangles it holds.
fn lanes(
    own: &[u32; BLOCK_WIDTH],
    number: u32,
    primitives: u32,
    mut has_corners: impl FnMut(usize) -> bool,
) -> Result<u32, DecodeError> {
    let mut triangles = 0;
    for (lane, &primitive) in own.iter().enumerate() {
        let is_vacant = primitive == NONE;
        let has_primitive = if is_vacant { lane > 0 && own[0] != NONE } else { primitive < primitives };
        if !has_primitive || !has_corners(lane) {
            return Err(DecodeError::BadBlock { block: number, lane: lane as u32 });
        }
        triangles += u32::from(!is_vacant);
    }
    Ok(triangles)
}

/// A vacant lane has the corners of the first one.
fn has_corners(block: &Block, lane: usize, inside: &RangeInclusive<f32>) -> bool {
    let corners = block.corners(lane);
    match block.primitives[lane] {
        NONE => corners == block.corners(0),
        _ => corners.iter().all(|corner| is_inside(corner, inside)),
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
