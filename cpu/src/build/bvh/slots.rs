//! Which slot of a node each child is put into.

use leafwalk_core::layout::BVH_WIDTH;

/// Puts each of up to eight boxes, given by twice their centres, into the free octant that it lies in most of all; those far
/// from the middle come first.
pub(crate) fn by_octant(centres: &[[f32; 3]]) -> [usize; BVH_WIDTH] {
    let mut low = [f32::INFINITY; 3];
    let mut high = [f32::NEG_INFINITY; 3];
    for centre in centres {
        for k in 0..3 {
            (low[k], high[k]) = (low[k].min(centre[k]), high[k].max(centre[k]));
        }
    }
    let mut offs = [([0.0f32; 3], 0.0); BVH_WIDTH];
    for (centre, off) in centres.iter().zip(&mut offs) {
        let from_middle: [f32; 3] = core::array::from_fn(|k| centre[k] - 0.5 * (low[k] + high[k]));
        *off = (from_middle, from_middle.iter().map(|c| c.abs()).sum());
    }
    let mut order: [usize; BVH_WIDTH] = core::array::from_fn(|i| i);
    order[..centres.len()].sort_by(|&a, &b| offs[b].1.total_cmp(&offs[a].1));
    let mut slot_of = [0; BVH_WIDTH];
    let mut free = [true; BVH_WIDTH];
    for &child in &order[..centres.len()] {
        let [x, y, z] = offs[child].0;
        let mut best = (f32::NEG_INFINITY, 0);
        for slot in (0..BVH_WIDTH).filter(|slot| free[*slot]) {
            let toward = |k: usize, c: f32| if slot >> k & 1 == 1 { c } else { -c };
            let along = toward(0, x) + toward(1, y) + toward(2, z);
            if along >= best.0 {
                best = (along, slot);
            }
        }
        (slot_of[child], free[best.1]) = (best.1, false);
    }
    slot_of
}
