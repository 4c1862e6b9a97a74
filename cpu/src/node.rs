//! The eight boxes of a payload, and the eight triangles of a block, against one ray.

use leafwalk_core::boxes::Slabs;
use leafwalk_core::lanes::Mask as _;
use leafwalk_core::layout::{Block, Payload};
use leafwalk_core::triangle::{Shear, Sheared};
use leafwalk_core::{Nearest, per_axis};

use crate::lanes::Eight;

/// Which of a payload's eight boxes a ray meets, and where it enters them.
#[inline(always)]
pub(crate) fn meet<L: Eight>(slabs: &Slabs<L>, neg: u32, payload: &Payload, nearest: &Nearest) -> ([f32; 8], u32) {
    let (near, far) = (payload.facing(neg), payload.facing(!neg));
    let (near, far) = (per_axis!(k => L::from_steps(near[k])), per_axis!(k => L::from_steps(far[k])));
    let (first, last) = slabs.clip(near, far, L::splat(nearest.t_min), L::splat(nearest.t));
    (first.to_array(), first.at_most(last).to_bits())
}

/// Tests the eight triangles of a block.
#[inline(always)]
pub(crate) fn test_block<L: Eight>(block: &Block, shear: &Shear<L>, axes: [usize; 3], nearest: &mut Nearest) {
    let corners = per_axis!(corner => per_axis!(k => L::load(&block.vertices[corner][axes[k]])));
    let sheared = Sheared::new(shear, corners);
    let candidates = sheared.is_candidate();
    if !candidates.any() {
        return;
    }
    let (accepted, found) = sheared.finish(shear);
    let mut accepted = (accepted & candidates).to_bits();
    let (t, u, v) = (found.t.to_array(), found.u.to_array(), found.v.to_array());
    while accepted != 0 {
        let lane = accepted.trailing_zeros() as usize;
        accepted &= accepted - 1;
        nearest.offer(t[lane], u[lane], v[lane], block.primitives[lane]);
    }
}
