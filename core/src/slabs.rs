//! Rays against boxes in lattice steps, dilated by the box margin: a test that may err only by keeping too much.

use crate::contract::BOX_MARGIN;
use crate::lanes::Lanes;
use crate::layout::{LATTICE, Lattice};
use crate::unroll;

/// A ray's distances to planes: t' of a side in step n is `n * inverse + lower`, or `+ upper`, per axis.
#[derive(Clone, Copy, Debug)]
pub struct Slabs<L> {
    /// t' of a lattice step.
    pub inverse: [L; 3],
    /// t' of the lower side of a box whose lower side is in step 0.
    pub lower: [L; 3],
    /// t' of the upper side of a box whose upper side is in step 0.
    pub upper: [L; 3],
}

impl<L: Lanes> Slabs<L> {
    /// The slabs of rays, given origins as seen from the root's corner, and inverse directions; see
    /// [`crate::step::Line::inverse`].
    #[inline(always)]
    pub fn new(origin: [L; 3], inverse: [L; 3]) -> Self {
        let (zero, margin, step) = (L::splat(0.0), L::splat(BOX_MARGIN), L::splat(1.0 + BOX_MARGIN));
        Self {
            inverse,
            // From the step that a side lies in to the plane that counts: its lower end, or its upper one.
            lower: unroll!(k in 0..3 => (zero - (origin[k] + margin)) * inverse[k]),
            upper: unroll!(k in 0..3 => (step - origin[k]) * inverse[k]),
        }
    }

    /// The slabs of rays in steps of a lattice of its own, given the exact origins in lattice coordinates.
    ///
    /// Boxes are dilated by the same share of the distance to what they may hold as the box margin is of the root's edge.
    #[inline(always)]
    pub fn in_lattice(lattice: &Lattice, origin: [L; 3], inverse: [L; 3]) -> Self {
        const EDGE: f32 = LATTICE as f32;
        let step = L::splat(lattice.step);
        let away: [L; 3] = unroll!(k in 0..3 => L::splat(lattice.corner[k]) - origin[k]);
        let farthest = away[0].abs().max(away[1].abs()).max(away[2].abs()) + L::splat(EDGE * lattice.step);
        let margin = farthest * L::splat(BOX_MARGIN / EDGE);
        let beyond = step + margin;
        Self {
            inverse: unroll!(k in 0..3 => inverse[k] * step),
            lower: unroll!(k in 0..3 => (away[k] - margin) * inverse[k]),
            upper: unroll!(k in 0..3 => (away[k] + beyond) * inverse[k]),
        }
    }

    /// What the near and the far sides of boxes add to t', per axis; each lane by its own octant.
    #[inline(always)]
    pub fn near_far(&self) -> [[L; 3]; 2] {
        let is_down: [L::Mask; 3] = unroll!(k in 0..3 => self.inverse[k].less(L::splat(0.0)));
        [
            unroll!(k in 0..3 => self.upper[k].or_else(is_down[k], self.lower[k])),
            unroll!(k in 0..3 => self.lower[k].or_else(is_down[k], self.upper[k])),
        ]
    }

    /// The part between `first` and `last` of the ray that lies in boxes, one a lane: it is met where the part's start is
    /// at most its end.
    #[inline(always)]
    pub fn clip(&self, lower: [L; 3], upper: [L; 3], first: L, last: L) -> (L, L) {
        let a: [L; 3] = unroll!(k in 0..3 => lower[k].about_mul_add(self.inverse[k], self.lower[k]));
        let b: [L; 3] = unroll!(k in 0..3 => upper[k].about_mul_add(self.inverse[k], self.upper[k]));
        let [x, y, z] = unroll!(k in 0..3 => a[k].min(b[k]));
        let first = first.max(x).max(y.max(z));
        let [x, y, z] = unroll!(k in 0..3 => a[k].max(b[k]));
        (first, last.min(x).min(y.min(z)))
    }
}
