//! The eight boxes of a BVH node, and the eight triangles of a block, against rays.

use leafwalk_core::lanes::{Bits as _, Mask as _};
use leafwalk_core::layout::{Block, BvhNode, NONE};
use leafwalk_core::slabs::Slabs;
use leafwalk_core::triangle::{Candidate, Shear, Sheared, intersect};
use leafwalk_core::{Nearest, unroll};

use crate::lanes::Eight;
use crate::trace::packet::load_integers;

/// Boxes as rays of one octant meet them, one a lane.
///
/// Which sides of a box a ray enters by is known from its octant, so no minimum and maximum is taken for each (A. Williams
/// and others, "An Efficient and Robust Ray-Box Intersection Algorithm", Journal of Graphics Tools 10(1), 2005,
/// <https://doi.org/10.1080/2151237X.2005.10129188>).
pub(crate) struct NearFarBoxes<L> {
    /// The sides that rays meet first, in lattice steps, axis by axis.
    near: [L; 3],
    /// The sides opposite to them.
    far: [L; 3],
}

impl<L: Eight> NearFarBoxes<L> {
    /// The eight boxes of a node.
    #[inline(always)]
    pub(crate) fn new(node: &BvhNode, order: L::Order, neg: u32) -> Self {
        let (near, far) = (node.near_sides(neg), node.near_sides(!neg));
        Self {
            near: unroll!(k in 0..3 => L::from_steps(near[k], order)),
            far: unroll!(k in 0..3 => L::from_steps(far[k], order)),
        }
    }

    /// Lanes whose box a ray meets between `first` and `last`, as [`Slabs::clip`] has it. The ray's slabs are t' of a
    /// lattice step, and what near and far sides add to it.
    #[inline(always)]
    pub(crate) fn hit_by(&self, [inverse, near, far]: &[[L; 3]; 3], first: L, last: L) -> L::Mask {
        let a: [L; 3] = unroll!(k in 0..3 => self.near[k].about_mul_add(inverse[k], near[k]));
        let b: [L; 3] = unroll!(k in 0..3 => self.far[k].about_mul_add(inverse[k], far[k]));
        first.max(a[0]).max(a[1].max(a[2])).at_most(last.min(b[0]).min(b[1].min(b[2])))
    }

    /// The box of one child in every lane.
    #[inline(always)]
    pub(crate) fn splat(node: &BvhNode, slot: usize, neg: u32) -> Self {
        let (near, far) = (node.near_sides(neg), node.near_sides(!neg));
        Self {
            near: unroll!(k in 0..3 => L::splat(f32::from(near[k][slot]))),
            far: unroll!(k in 0..3 => L::splat(f32::from(far[k][slot]))),
        }
    }
}

/// Slabs by the sides that rays meet first and last.
#[inline(always)]
pub(crate) fn near_far<L: Eight>(Slabs { inverse, lower, upper }: Slabs<L>) -> [[L; 3]; 3] {
    let is_down: [L::Mask; 3] = unroll!(k in 0..3 => inverse[k].less(L::splat(0.0)));
    [
        inverse,
        unroll!(k in 0..3 => upper[k].or_else(is_down[k], lower[k])),
        unroll!(k in 0..3 => lower[k].or_else(is_down[k], upper[k])),
    ]
}

/// Which of a node's eight boxes a ray meets, a bit a lane, and t' where it enters them.
#[inline(always)]
pub(crate) fn boxes_hit<L: Eight>(slabs: &Slabs<L>, order: L::Order, node: &BvhNode, nearest: &Nearest) -> (L, u32) {
    let (first, last) = clip_boxes(slabs, order, node, (nearest.t_min, nearest.t));
    (first, first.at_most(last).to_bits())
}

/// The part of a part of a ray that lies in each of a node's eight boxes: see [`Slabs::clip`].
#[inline(always)]
pub(crate) fn clip_boxes<L: Eight>(
    slabs: &Slabs<L>,
    order: L::Order,
    node: &BvhNode,
    (first, last): (f32, f32),
) -> (L, L) {
    let lower = unroll!(k in 0..3 => L::from_steps(&node.sides[k][0], order));
    let upper = unroll!(k in 0..3 => L::from_steps(&node.sides[k][1], order));
    slabs.clip(lower, upper, L::splat(first), L::splat(last))
}

/// Tests the eight triangles of a block against a ray, and keeps the nearest hit.
#[inline(always)]
pub(crate) fn test_block<L: Eight>(block: &Block, shear: &Shear<f32>, axes: [usize; 3], nearest: &mut Nearest) {
    let corners = unroll!(corner in 0..3 => unroll!(k in 0..3 => L::load(&block.vertices[corner][axes[k]])));
    let shears = Shear::<L>::splat(shear);
    let sheared = Sheared::new(&shears, corners);
    let candidates = sheared.is_candidate();
    if !candidates.any() {
        return;
    }
    let (accepted, found) = sheared.finish(shears.slope[2]);
    // Vacant lanes are hit as often as the lane that they repeat.
    let is_taken = L::below(load_integers::<L>(&block.primitives), L::Bits::splat(NONE));
    let accepted = accepted & candidates & is_taken;
    let shear = *shear;
    let t = distances(accepted, &found, move |lane| (shear, block.permuted(lane, axes)));
    let is_between = L::splat(nearest.t_min).less(t) & t.at_most(L::splat(nearest.t));
    let mut accepted = (accepted & is_between).to_bits();
    let (t, u, v) = (t.to_array(), found.u.to_array(), found.v.to_array());
    while accepted != 0 {
        let lane = accepted.trailing_zeros() as usize;
        accepted &= accepted - 1;
        nearest.offer(true, t[lane], u[lane], v[lane], block.primitives[lane]);
    }
}

/// The t' of hits, given the ray and the triangle of a lane for those that are short.
#[inline(always)]
pub(crate) fn distances<L: Eight>(accepted: L::Mask, found: &Candidate<L>, of_lane: impl Fn(usize) -> Pair) -> L {
    let short = (accepted & found.is_short).to_bits();
    if short == 0 { found.t } else { L::load(&met(found.t.to_array(), short, of_lane)) }
}

/// A ray and the corners of a triangle.
type Pair = (Shear<f32>, [[f32; 3]; 3]);

/// Computes some t' anew, one by one.
#[cold]
#[inline(never)]
fn met(mut t: [f32; 8], mut short: u32, of_lane: impl Fn(usize) -> Pair) -> [f32; 8] {
    while short != 0 {
        let lane = short.trailing_zeros() as usize & 7;
        short &= short - 1;
        let (shear, corners) = of_lane(lane);
        t[lane] = intersect(&shear, &corners).map_or(t[lane], |found| found.t);
    }
    t
}
