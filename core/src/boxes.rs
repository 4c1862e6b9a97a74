//! Rays against boxes quantised to a cell, dilated by the box margin: a test that may err only by keeping too much.

use crate::lanes::Lanes;
use crate::layout::{BOX_MARGIN, LATTICE};
use crate::step::Line;

/// Slices of a cell along an axis.
const SLICES: f32 = 256.0;
const MARGIN: f32 = BOX_MARGIN * LATTICE as f32;

/// A ray's distances to the slices of one cell: t' of a box's near side is `near + slice * per_slice`, per axis.
#[derive(Clone, Copy, Debug)]
pub struct Boxes {
    near: [f32; 3],
    far: [f32; 3],
    per_slice: [f32; 3],
}

impl Boxes {
    /// The slices of a cell, given by its lower corner and its edge in lattice steps.
    #[inline(always)]
    pub fn new(corner: [u32; 3], size: u32, line: &Line<f32>) -> Self {
        let slice = size as f32 * (1.0 / SLICES);
        let from_origin: [f32; 3] = core::array::from_fn(|k| corner[k] as f32 - line.origin[k]);
        let is_negative = |k: usize| line.neg >> k & 1 == 1;
        // Of the slice that holds a side, the farther plane counts.
        let lower: [f32; 3] = core::array::from_fn(|k| (from_origin[k] - MARGIN) * line.inverse[k]);
        let upper: [f32; 3] = core::array::from_fn(|k| (from_origin[k] + (slice + MARGIN)) * line.inverse[k]);
        Self {
            near: core::array::from_fn(|k| if is_negative(k) { upper[k] } else { lower[k] }),
            far: core::array::from_fn(|k| if is_negative(k) { lower[k] } else { upper[k] }),
            per_slice: line.inverse.map(|inverse| slice * inverse),
        }
    }

    /// The part between `first` and `last` of the ray that lies in boxes, one a lane: it is met where the part's start is
    /// at most its end. `near` holds upper sides on axes along which the ray moves down, else lower ones.
    #[inline(always)]
    pub fn clip<L: Lanes>(&self, near: [L; 3], far: [L; 3], first: L, last: L) -> (L, L) {
        let at =
            |slice: L, k: usize, base: [f32; 3]| slice.about_mul_add(L::splat(self.per_slice[k]), L::splat(base[k]));
        let [x, y, z] = core::array::from_fn(|k| at(near[k], k, self.near));
        let first = first.max(x).max(y.max(z));
        let [x, y, z] = core::array::from_fn(|k| at(far[k], k, self.far));
        (first, last.min(x).min(y.min(z)))
    }
}

/// Per axis, what lies near along a ray of octant `neg`: of lower and upper sides.
#[inline(always)]
pub fn near_and_far<T: Copy>(neg: u32, lower: [T; 3], upper: [T; 3]) -> ([T; 3], [T; 3]) {
    let is_negative = |k: usize| neg >> k & 1 == 1;
    (
        core::array::from_fn(|k| if is_negative(k) { upper[k] } else { lower[k] }),
        core::array::from_fn(|k| if is_negative(k) { lower[k] } else { upper[k] }),
    )
}
