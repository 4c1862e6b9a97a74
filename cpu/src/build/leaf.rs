//! What nodes list: triangles grouped into blocks of eight, their boxes, payloads.

use glam::DVec3;
use leafwalk_core::layout::{
    ABSENT, BLOCK_WIDTH, Block, Key, LATTICE_STEP, NONE, PAYLOAD_BLOCKS, Payload, QuantisedBox, hull,
};

use super::clip::clipped_bounds;

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
    padding: f32,
    place: &Place,
    blocks: &mut [Block],
) -> Vec<Payload> {
    let mut listed: Vec<Listed> = references
        .iter()
        .map(|&reference| {
            let (lower, upper) = bounds_inside(cell, &triangles[reference as usize].1, padding);
            Listed { reference, lower, upper }
        })
        .collect();
    group(&mut listed);

    let groups = listed.chunks_mut(BLOCK_WIDTH).collect::<Vec<_>>();
    let boxes: Vec<_> = groups.iter().map(|group| quantise(cell, group)).collect();
    for (group, block) in groups.into_iter().zip(blocks) {
        // Ascending primitives, so that the block's bytes do not depend on how it was found.
        group.sort_unstable_by_key(|listed| listed.reference);
        *block = pack(group, triangles);
    }
    let count = payload_count(references.len());
    let in_payload = |(i, own): (usize, &[QuantisedBox])| {
        let (lower, upper) = hull(if i == 0 { &boxes } else { own }.iter().copied());
        let slot = |b: usize| own.get(b).copied().unwrap_or(ABSENT);
        Payload {
            lower,
            count: own.len() as u8,
            upper,
            children: 0,
            first: place.block + (i * PAYLOAD_BLOCKS) as u32,
            next: if i + 1 == count { NONE } else { place.chain + i as u32 },
            box_lower: core::array::from_fn(|k| core::array::from_fn(|b| slot(b).0[k])),
            box_upper: core::array::from_fn(|k| core::array::from_fn(|b| slot(b).1[k])),
        }
    };
    boxes.chunks(PAYLOAD_BLOCKS).enumerate().map(in_payload).collect()
}

/// The payload of an inner node, given those of its children that list something, by octant.
pub(crate) fn gather(children: &[Option<&Payload>; 8], first: u32) -> Payload {
    let slot = |octant: usize| children[octant].map_or(ABSENT, |child| child.seen_from_parent(octant as u32));
    let (lower, upper) = hull((0..8).map(slot));
    let present = (0..8).fold(0, |mask, octant| mask | u8::from(children[octant].is_some()) << octant);
    Payload {
        lower,
        count: present.count_ones() as u8,
        upper,
        children: present,
        first,
        next: NONE,
        box_lower: core::array::from_fn(|k| core::array::from_fn(|octant| slot(octant).0[k])),
        box_upper: core::array::from_fn(|k| core::array::from_fn(|octant| slot(octant).1[k])),
    }
}

/// Bounds of the part of a triangle inside a dilated cell. Binning is more generous than clipping: what only touches
/// gets the box of the whole cell.
fn bounds_inside(cell: Key, corners: &[[f32; 3]; 3], padding: f32) -> (DVec3, DVec3) {
    let (lower, upper) = cell.bounds();
    let (lower, upper) = (lower.map(|c| c - padding), upper.map(|c| c + padding));
    let whole = || (DVec3::from_array(lower.map(f64::from)), DVec3::from_array(upper.map(f64::from)));
    clipped_bounds(corners, lower, upper).unwrap_or_else(whole)
}

/// The slices of a cell that a triangle's block box must cover.
pub(crate) fn quantised_bounds(cell: Key, corners: &[[f32; 3]; 3], padding: f32) -> QuantisedBox {
    let (lower, upper) = bounds_inside(cell, corners, padding);
    quantise(cell, &[Listed { reference: 0, lower, upper }])
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

/// The box of a group in slices of the cell. What the padding adds outside the cell is left to the box margin.
fn quantise(cell: Key, group: &[Listed]) -> QuantisedBox {
    let corner = DVec3::from_array(cell.bounds().0.map(f64::from));
    let slices = 256.0 / f64::from(cell.size() as f32 * LATTICE_STEP);
    let slice = |c: f64, k: usize| ((c - corner[k]) * slices).floor().clamp(0.0, 255.0) as u8;
    let lower = |k: usize| group.iter().map(|listed| listed.lower[k]).fold(f64::INFINITY, f64::min);
    let upper = |k: usize| group.iter().map(|listed| listed.upper[k]).fold(f64::NEG_INFINITY, f64::max);
    (core::array::from_fn(|k| slice(lower(k), k)), core::array::from_fn(|k| slice(upper(k), k)))
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
