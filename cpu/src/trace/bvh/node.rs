//! The eight boxes of a BVH node, and the eight triangles of a block, against rays.

use leafwalk_core::lanes::{Bits as _, Mask as _};
use leafwalk_core::layout::{BLOCK_WIDTH, Block, BvhNode, NONE};
use leafwalk_core::slabs::Slabs;
use leafwalk_core::triangle::{Candidate, Shear, Sheared, intersect};
use leafwalk_core::{Nearest, unroll};

use crate::lanes::Eight;
use crate::trace::packet::load_integers;
use crate::trace::query::Query;

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

/// Tests the eight triangles of a block against a ray, and keeps the nearest hit. The ray is asked for again where a hit is
/// short, instead of being held in registers until then.
#[inline(always)]
pub(crate) fn test_block<L: Eight, Q: Query>(
    block: &Block,
    (shear, axes): ShearedRay,
    again: impl Fn() -> ShearedRay,
    nearest: &mut Nearest,
) {
    let shear = Shear::<L>::splat(&shear);
    let corners = unroll!(corner in 0..3 => unroll!(k in 0..3 => L::load(&block.vertices[corner][axes[k]])));
    let sheared = Sheared::new(&shear, corners);
    let candidates = sheared.is_candidate();
    if !candidates.any() {
        return;
    }
    let (accepted, found) = sheared.finish(shear.slope[2]);
    // Vacant lanes are hit as often as the lane that they repeat.
    let is_taken = L::below(load_integers::<L>(&block.primitives), L::Bits::splat(NONE));
    let accepted = accepted & candidates & is_taken;
    let limits = [L::splat(nearest.t_min), L::splat(nearest.t)];
    let t = distances::<L, Q>(accepted, &found, limits, move |lane| (again(), block, lane));
    let is_between = limits[0].less(t) & t.at_most(limits[1]);
    let mut accepted = (accepted & is_between).to_bits();
    let (t, u, v) = (t.to_array(), found.u.to_array(), found.v.to_array());
    while accepted != 0 {
        let lane = accepted.trailing_zeros() as usize;
        accepted &= accepted - 1;
        nearest.offer(true, t[lane], u[lane], v[lane], block.primitives[lane]);
    }
}

/// A ray's shear, and the order of its axes.
pub(crate) type ShearedRay = (Shear<f32>, [usize; 3]);

/// The t' of hits. Short ones are computed anew where they may be within the limits of a ray, and where more is asked than
/// whether they are; `of_lane` gives the ray, the block and the triangle's place in it.
#[inline(always)]
pub(crate) fn distances<'a, L: Eight, Q: Query>(
    accepted: L::Mask,
    found: &Candidate<L>,
    [t_min, t_max]: [L; 2],
    of_lane: impl Fn(usize) -> (ShearedRay, &'a Block, usize),
) -> L {
    let short = accepted & found.is_short;
    if !short.any() {
        return found.t;
    }
    let mut short = short & found.may_be_between(t_min, t_max);
    if Q::ANY {
        short = short & !found.is_surely_between(t_min, t_max);
    }
    if short.any() { L::load(&met(found.t.to_array(), short.to_bits(), of_lane)) } else { found.t }
}

/// Computes some t' anew, one by one. Nothing in it panics, so compilers see that it changes nothing else.
#[cold]
#[inline(never)]
fn met<'a>(mut t: [f32; 8], mut lanes: u32, of_lane: impl Fn(usize) -> (ShearedRay, &'a Block, usize)) -> [f32; 8] {
    while lanes != 0 {
        let lane = lanes.trailing_zeros() as usize % 8;
        lanes &= lanes - 1;
        let ((shear, axes), block, triangle) = of_lane(lane);
        let corners = block.corners(triangle % BLOCK_WIDTH);
        let corners = unroll!(corner in 0..3 => unroll!(k in 0..3 => corners[corner][axes[k] % 3]));
        if let Some(found) = intersect(&shear, &corners) {
            t[lane] = found.t;
        }
    }
    t
}
