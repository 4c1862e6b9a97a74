//! The eight boxes of a branch, and the eight triangles of a block, against one ray.

use leafwalk_core::boxes::Slabs;
use leafwalk_core::lanes::Mask as _;
use leafwalk_core::layout::{Block, Branch};
use leafwalk_core::triangle::{Shear, Sheared};
use leafwalk_core::{Nearest, per_axis};

use crate::lanes::Eight;

/// Which of a branch's eight boxes a ray meets, and where it enters them.
#[inline(always)]
pub(crate) fn meet<L: Eight>(slabs: &Slabs<L>, branch: &Branch, nearest: &Nearest) -> (L, u32) {
    let sides: [[L; 3]; 2] =
        [per_axis!(k => L::from_steps(&branch.sides[k][0])), per_axis!(k => L::from_steps(&branch.sides[k][1]))];
    let (first, last) = slabs.clip(sides[0], sides[1], L::splat(nearest.t_min), L::splat(nearest.t));
    (first, first.at_most(last).to_bits())
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
