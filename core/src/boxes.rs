//! Rays against boxes in lattice steps, dilated by the box margin: a test that may err only by keeping too much.

use crate::lanes::Lanes;
use crate::layout::{BOX_MARGIN, LATTICE};
use crate::per_axis;

/// The box margin in lattice steps.
const MARGIN: f32 = BOX_MARGIN * LATTICE as f32;

/// A ray's distances to planes: t' of a box's near side is `side * inverse + near`, per axis.
#[derive(Clone, Copy, Debug)]
pub struct Slabs<L> {
    /// t' of a lattice step.
    pub inverse: [L; 3],
    /// t' of the near side of a box whose near side is in step 0.
    pub near: [L; 3],
    /// t' of the far side of a box whose far side is in step 0.
    pub far: [L; 3],
}

impl<L: Lanes> Slabs<L> {
    /// Of origins and inverse directions in lattice steps; see [`crate::step::Line::inverse`].
    #[inline(always)]
    pub fn new(origin: [L; 3], inverse: [L; 3]) -> Self {
        let (zero, margin, step) = (L::splat(0.0), L::splat(MARGIN), L::splat(1.0 + MARGIN));
        // From the step that a side lies in to the plane that counts: its lower end, or its upper one.
        let lower: [L; 3] = per_axis!(k => (zero - (origin[k] + margin)) * inverse[k]);
        let upper: [L; 3] = per_axis!(k => (step - origin[k]) * inverse[k]);
        let is_negative: [L::Mask; 3] = per_axis!(k => inverse[k].less(zero));
        Self {
            inverse,
            near: per_axis!(k => upper[k].or_else(is_negative[k], lower[k])),
            far: per_axis!(k => lower[k].or_else(is_negative[k], upper[k])),
        }
    }

    /// The part between `first` and `last` of the ray that lies in boxes, one a lane: it is met where the part's start is
    /// at most its end. `near` holds upper sides on axes along which the ray moves down, else lower ones.
    #[inline(always)]
    pub fn clip(&self, near: [L; 3], far: [L; 3], first: L, last: L) -> (L, L) {
        let [x, y, z] = per_axis!(k => near[k].about_mul_add(self.inverse[k], self.near[k]));
        let first = first.max(x).max(y.max(z));
        let [x, y, z] = per_axis!(k => far[k].about_mul_add(self.inverse[k], self.far[k]));
        (first, last.min(x).min(y.min(z)))
    }
}
