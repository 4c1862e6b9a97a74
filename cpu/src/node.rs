//! The eight boxes of a branch, and the eight triangles of a block, against one ray.

use leafwalk_core::boxes::Slabs;
use leafwalk_core::lanes::Mask as _;
use leafwalk_core::layout::{Block, Branch};
use leafwalk_core::triangle::{Shear, Sheared};
use leafwalk_core::{Nearest, per_axis};

use crate::lanes::Eight;

/// The boxes of a branch as rays of one octant meet them.
pub(crate) struct Facing<L> {
    /// The sides that come first, in lattice steps, axis by axis.
    pub(crate) near: [L; 3],
    /// The opposite ones.
    pub(crate) far: [L; 3],
}

impl<L: Eight> Facing<L> {
    #[inline(always)]
    pub(crate) fn new(branch: &Branch, order: L::Order, neg: u32) -> Self {
        let (near, far) = (branch.facing(neg), branch.facing(!neg));
        Self { near: per_axis!(k => L::from_steps(near[k], order)), far: per_axis!(k => L::from_steps(far[k], order)) }
    }

    /// Lanes whose box a ray meets between `first` and `last`: as [`Slabs::clip`] has it, but that near and far sides
    /// are told apart. The ray's slabs are t' of a lattice step, and what near and far sides add to it.
    #[inline(always)]
    pub(crate) fn met(&self, [inverse, near, far]: &[[L; 3]; 3], first: L, last: L) -> L::Mask {
        let a: [L; 3] = per_axis!(k => self.near[k].about_mul_add(inverse[k], near[k]));
        let b: [L; 3] = per_axis!(k => self.far[k].about_mul_add(inverse[k], far[k]));
        first.max(a[0]).max(a[1].max(a[2])).at_most(last.min(b[0]).min(b[1].min(b[2])))
    }
}

impl<L: Eight> Facing<L> {
    /// The same box in every lane.
    #[inline(always)]
    pub(crate) fn splat(branch: &Branch, slot: usize, neg: u32) -> Self {
        let (near, far) = (branch.facing(neg), branch.facing(!neg));
        Self {
            near: per_axis!(k => L::splat(f32::from(near[k][slot]))),
            far: per_axis!(k => L::splat(f32::from(far[k][slot]))),
        }
    }
}

/// Which of a branch's eight boxes a ray meets, and where it enters them.
#[inline(always)]
pub(crate) fn meet<L: Eight>(slabs: &Slabs<L>, order: L::Order, branch: &Branch, nearest: &Nearest) -> (L, u32) {
    let sides: [[L; 3]; 2] = [
        per_axis!(k => L::from_steps(&branch.sides[k][0], order)),
        per_axis!(k => L::from_steps(&branch.sides[k][1], order)),
    ];
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
    let is_between = L::splat(nearest.t_min).less(found.t) & found.t.at_most(L::splat(nearest.t));
    let mut accepted = (accepted & candidates & is_between).to_bits();
    let (t, u, v) = (found.t.to_array(), found.u.to_array(), found.v.to_array());
    while accepted != 0 {
        let lane = accepted.trailing_zeros() as usize;
        accepted &= accepted - 1;
        nearest.offer(true, t[lane], u[lane], v[lane], block.primitives[lane]);
    }
}
