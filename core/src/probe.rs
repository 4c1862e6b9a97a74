//! `Probe`: one ray with all that the boxes and triangles of leaves are tested with, in the scalar walk.

use crate::lanes::Lanes;
use crate::layout::{BVH_WIDTH, BvhNode, Lattice, NONE};
use crate::ray::CanonicalRay;
use crate::slabs::Slabs;
use crate::step::Line;
use crate::triangle::Shear;

/// The slabs of a ray (see [`Slabs`]), by the sides that it meets first and last.
#[derive(Clone, Copy)]
pub(crate) struct Sides {
    inverse: [f32; 3],
    near: [f32; 3],
    far: [f32; 3],
}

impl Sides {
    #[inline(always)]
    fn new(slabs: &Slabs<f32>) -> Self {
        let [near, far] = slabs.near_far();
        Self { inverse: slabs.inverse, near, far }
    }
}

/// What a ray's visits to leaves share.
pub(crate) struct Probe {
    /// The sides of boxes that count the root's steps.
    pub(crate) sides: Sides,
    origin: [f32; 3],
    inverse: [f32; 3],
    pub(crate) neg: u32,
    pub(crate) shear: Shear<f32>,
    pub(crate) axes: [usize; 3],
}

/// A node that a ray has entered.
#[derive(Clone, Copy)]
pub(crate) struct Entered<'a> {
    pub(crate) node: &'a BvhNode,
    /// The node's number; [`NONE`] for what a leaf lists.
    pub(crate) number: u32,
    /// The children whose boxes are met and that have not been visited, a bit each, in the ray's order: slot XOR octant.
    pub(crate) waiting: u32,
}

impl Entered<'_> {
    pub(crate) const NONE: Self = Self { node: &BvhNode::VACANT, number: NONE, waiting: 0 };
}

impl Probe {
    pub(crate) fn new(ray: &CanonicalRay, line: &Line<f32>) -> Self {
        let (shear, axes) = Shear::<f32>::new(ray);
        let sides = Sides::new(&Slabs::new(line.origin, line.inverse));
        Self { sides, origin: ray.origin, inverse: line.inverse, neg: line.neg, shear, axes }
    }

    /// The sides of boxes that count the steps of a lattice of their own.
    #[inline(always)]
    pub(crate) fn sides_in(&self, lattice: &Lattice) -> Sides {
        Sides::new(&Slabs::in_lattice(lattice, self.origin, self.inverse))
    }

    /// Tests all eight boxes of a node against a part of the ray, in loops that compilers turn into SIMD: a bit for each that
    /// is met, in the ray's order.
    pub(crate) fn enter(&self, sides: &Sides, node: &BvhNode, part: (f32, f32), nearest: f32) -> u32 {
        let mut first = [part.0; BVH_WIDTH];
        let mut last = [Lanes::min(part.1, nearest); BVH_WIDTH];
        let (near, far) = (node.near_sides(self.neg), node.near_sides(!self.neg));
        for k in 0..3 {
            for slot in 0..BVH_WIDTH {
                first[slot] = Lanes::max(first[slot], f32::from(near[k][slot]) * sides.inverse[k] + sides.near[k]);
                last[slot] = Lanes::min(last[slot], f32::from(far[k][slot]) * sides.inverse[k] + sides.far[k]);
            }
        }
        let mut met = 0;
        for slot in 0..BVH_WIDTH {
            met |= u32::from(first[slot] <= last[slot]) << slot;
        }
        in_order(met, self.neg)
    }

    /// The part of a part of the ray that lies in a child's box, before the nearest hit.
    #[inline]
    pub(crate) fn clip(
        &self,
        sides: &Sides,
        node: &BvhNode,
        slot: usize,
        part: (f32, f32),
        nearest: f32,
    ) -> (f32, f32) {
        let (near, far) = (node.near_sides(self.neg), node.near_sides(!self.neg));
        let along = |side: u16, k: usize, offset: f32| f32::from(side) * sides.inverse[k] + offset;
        let first = (0..3).fold(part.0, |first, k| Lanes::max(first, along(near[k][slot], k, sides.near[k])));
        let last = (0..3).fold(part.1, |last, k| Lanes::min(last, along(far[k][slot], k, sides.far[k])));
        (first, Lanes::min(last, nearest))
    }
}

/// Lanes by slot as lanes in the order of a ray of octant `neg`: bit i goes to i XOR `neg`.
#[inline(always)]
fn in_order(met: u32, neg: u32) -> u32 {
    let swap = |met: u32, k: u32, low: u32| {
        let swapped = (met & low) << (1 << k) | met >> (1 << k) & low;
        if neg >> k & 1 == 1 { swapped } else { met }
    };
    swap(swap(swap(met, 0, 0x55), 1, 0x33), 2, 0x0f)
}
