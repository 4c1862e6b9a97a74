//! What nodes list: triangles grouped into blocks of eight, their boxes, payloads.

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

/// Where what a leaf lists goes.
pub(crate) struct Place {
    /// Number of the first block; the others follow it.
    pub(crate) block: u32,
    /// Number of the second payload, where there is one; the others follow it.
    pub(crate) chain: u32,
}

/// Fills the blocks of one leaf and returns its payloads.
pub(crate) fn fill(
    cell: Key,
    references: &[u32],
    triangles: &[(u32, [[f32; 3]; 3])],
    settings: &Settings,
    place: &Place,
    blocks: &mut [Block],
) -> Vec<Payload> {
    let mut listed: Vec<Listed> = references
        .iter()
        .map(|&reference| {
            let (lower, upper) = bounds_inside(cell, &triangles[reference as usize].1, settings.padding);
            Listed { reference, lower, upper }
        })
        .collect();
    group(&mut listed);

    let groups = listed.chunks_mut(BLOCK_WIDTH).collect::<Vec<_>>();
    let boxes: Vec<_> = groups.iter().map(|group| spoil(round_out(cell, group), settings.spoiled)).collect();
    for (group, block) in groups.into_iter().zip(blocks) {
        // Ascending primitives, so that the block's bytes do not depend on how it was found.
        group.sort_unstable_by_key(|listed| listed.reference);
        *block = pack(group, triangles);
    }
    let count = payload_count(references.len());
    let in_payload = |(i, own): (usize, &[LatticeBox])| {
        let payload = Payload::of_boxes(core::array::from_fn(|b| own.get(b).copied().unwrap_or(ABSENT)));
        let (lower, upper) = if i == 0 { hull(boxes.iter().copied()) } else { payload.hull() };
        let next = if i + 1 == count { NONE } else { place.chain + i as u32 };
        Payload { lower, upper, first: place.block + (i * PAYLOAD_BLOCKS) as u32, next, ..payload }
    };
    boxes.chunks(PAYLOAD_BLOCKS).enumerate().map(in_payload).collect()
}

/// The payload of an inner node, given those of its children that list something, by octant.
pub(crate) fn gather(children: &[Option<&Payload>; 8], first: u32) -> Payload {
    let payload = Payload::of_boxes(children.map(|child| child.map_or(ABSENT, Payload::hull)));
    let present = (0..8).fold(0, |mask, octant| mask | u16::from(children[octant].is_some()) << octant);
    Payload { children: present, first, ..payload }
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

fn pack(group: &[Listed], triangles: &[(u32, [[f32; 3]; 3])]) -> Block {
    let mut block = Block { vertices: [[[0.0; BLOCK_WIDTH]; 3]; 3], primitives: [NONE; BLOCK_WIDTH] };
    for lane in 0..BLOCK_WIDTH {
        let listed = group.get(lane);
        let (primitive, corners) = &triangles[listed.unwrap_or(&group[0]).reference as usize];
        block.primitives[lane] = listed.map_or(NONE, |_| *primitive);
        for (corner, axis) in (0..9).map(|i| (i / 3, i % 3)) {
            block.vertices[corner][axis][lane] = corners[corner][axis];
        }
    }
    block
}
