//! What leaves list: triangles grouped into blocks of eight, their boxes, payloads.

use glam::DVec3;
use leafwalk_core::layout::{
    ABSENT, BLOCK_WIDTH, Block, Key, LATTICE, LatticeBox, NONE, PAYLOAD_BLOCKS, Payload, hull,
};

use super::clip::clipped_bounds;
use super::{Settings, Spoiled};

/// A triangle of a leaf with the bounds of its part inside the cell.
#[derive(Clone, Copy)]
struct Listed {
    reference: u32,
    lower: DVec3,
    upper: DVec3,
}

/// Blocks that `references` triangles fill.
pub(crate) fn block_count(references: usize) -> usize {
    references.div_ceil(BLOCK_WIDTH)
}

/// Payloads that `references` triangles need.
pub(crate) fn payload_count(references: usize) -> usize {
    block_count(references).div_ceil(PAYLOAD_BLOCKS)
}

/// Orders the references of one leaf by blocks, and returns its payloads: numbered from `payload` on, their blocks from
/// `block` on.
pub(crate) fn list(
    cell: Key,
    references: &mut [u32],
    triangles: &[(u32, [[f32; 3]; 3])],
    settings: &Settings,
    payload: u32,
    block: u32,
) -> Vec<Payload> {
    let mut listed: Vec<Listed> = references
        .iter()
        .map(|&reference| {
            let (lower, upper) = bounds_inside(cell, &triangles[reference as usize].1, settings.padding);
            Listed { reference, lower, upper }
        })
        .collect();
    group(&mut listed);
    let boxes: Vec<_> =
        listed.chunks(BLOCK_WIDTH).map(|group| spoil(round_out(cell, group), settings.spoiled)).collect();
    for (group, references) in listed.chunks_mut(BLOCK_WIDTH).zip(references.chunks_mut(BLOCK_WIDTH)) {
        // Ascending primitives, so that the block's bytes do not depend on how it was found.
        group.sort_unstable_by_key(|listed| listed.reference);
        for (reference, listed) in references.iter_mut().zip(group) {
            *reference = listed.reference;
        }
    }
    let count = payload_count(references.len());
    let in_payload = |(i, own): (usize, &[LatticeBox])| {
        let listing = Payload::of_boxes(core::array::from_fn(|b| own.get(b).copied().unwrap_or(ABSENT)));
        let (lower, upper) = if i == 0 { hull(boxes.iter().copied()) } else { listing.hull() };
        let next = if i + 1 == count { NONE } else { payload + i as u32 + 1 };
        Payload { lower, upper, first: block + (i * PAYLOAD_BLOCKS) as u32, next, ..listing }
    };
    boxes.chunks(PAYLOAD_BLOCKS).enumerate().map(in_payload).collect()
}

/// Bounds of the part of a triangle inside a dilated cell. Binning is more generous than clipping: what only touches
/// gets the box of the whole cell.
fn bounds_inside(cell: Key, corners: &[[f32; 3]; 3], padding: f32) -> (DVec3, DVec3) {
    let (lower, upper) = cell.bounds();
    let (lower, upper) = (lower.map(|c| c - padding), upper.map(|c| c + padding));
    let whole = || (DVec3::from_array(lower.map(f64::from)), DVec3::from_array(upper.map(f64::from)));
    clipped_bounds(corners, lower, upper).unwrap_or_else(whole)
}

/// The lattice steps that a triangle's block box must cover.
pub(crate) fn box_inside(cell: Key, corners: &[[f32; 3]; 3], padding: f32) -> LatticeBox {
    let (lower, upper) = bounds_inside(cell, corners, padding);
    round_out(cell, &[Listed { reference: 0, lower, upper }])
}

/// Orders triangles so that every run of eight lies close together: halves along the longest axis of the centres.
fn group(listed: &mut [Listed]) {
    if listed.len() <= BLOCK_WIDTH {
        return;
    }
    let centre = |listed: &Listed| listed.lower + listed.upper;
    let (low, high) = listed.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), listed| {
        (low.min(centre(listed)), high.max(centre(listed)))
    });
    let axis = (high - low).max_position();
    // The left half fills whole blocks, so that only the last block of a leaf has vacant lanes.
    let middle = block_count(listed.len()).div_ceil(2) * BLOCK_WIDTH;
    listed.select_nth_unstable_by(middle, |a, b| {
        centre(a)[axis].total_cmp(&centre(b)[axis]).then(a.reference.cmp(&b.reference))
    });
    let (left, right) = listed.split_at_mut(middle);
    group(left);
    group(right);
}

/// The box of a group in lattice steps. What the padding adds outside the cell is left to the box margin.
fn round_out(cell: Key, group: &[Listed]) -> LatticeBox {
    let step = |c: f64, k: usize| {
        let first = cell.corner[k];
        ((c * f64::from(LATTICE)).floor() as u32).clamp(first, first + cell.size() - 1) as u16
    };
    let lower = |k: usize| group.iter().map(|listed| listed.lower[k]).fold(f64::INFINITY, f64::min);
    let upper = |k: usize| group.iter().map(|listed| listed.upper[k]).fold(f64::NEG_INFINITY, f64::max);
    (core::array::from_fn(|k| step(lower(k), k)), core::array::from_fn(|k| step(upper(k), k)))
}

/// A step smaller where boxes are spoiled.
fn spoil((lower, upper): LatticeBox, spoiled: Spoiled) -> LatticeBox {
    let shrink = |k: usize| u16::from(spoiled == Spoiled::Boxes && lower[k] < upper[k]);
    (lower, core::array::from_fn(|k| upper[k] - shrink(k)))
}

/// The block of up to eight references.
pub(crate) fn pack(group: &[u32], triangles: &[(u32, [[f32; 3]; 3])]) -> Block {
    let mut block = Block::VACANT;
    for lane in 0..BLOCK_WIDTH {
        let reference = group.get(lane);
        let (primitive, corners) = &triangles[*reference.unwrap_or(&group[0]) as usize];
        block.primitives[lane] = reference.map_or(NONE, |_| *primitive);
        for (corner, axis) in (0..9).map(|i| (i / 3, i % 3)) {
            block.vertices[corner][axis][lane] = corners[corner][axis];
        }
    }
    block
}
