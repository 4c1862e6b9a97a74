//! The lattice frame: the caller's units on one side, the unit root cube on the other.

use crate::contract::{MESH_MARGIN, SMALLEST};
use crate::unroll;

/// `caller = origin + 2^scale_exponent * lattice`; the root cube is 0..1 on every lattice axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The root's lower corner in the caller's units.
    pub origin: [f64; 3],
    /// The root's edge is 2 to this power.
    pub scale_exponent: i32,
}

impl Frame {
    /// Exponents that meshes of finite f32 positions can need.
    pub const SCALE_EXPONENTS: core::ops::RangeInclusive<i32> = -149..=131;

    /// The smallest frame that keeps the box `lower..=upper` (finite, in the caller's units) inside the root by the
    /// mesh margin of 2^-17 on every side, after rounding.
    pub fn around(lower: [f32; 3], upper: [f32; 3]) -> Self {
        Self::around_with_margin(lower, upper, MESH_MARGIN)
    }

    /// See [`crate::testing::frame_touching`].
    pub(crate) fn around_with_margin(lower: [f32; 3], upper: [f32; 3], margin: f32) -> Self {
        let extent = (0..3).map(|k| f64::from(upper[k]) - f64::from(lower[k])).fold(0.0, f64::max);
        let mut scale_exponent = if extent > 0.0 { exponent(extent) } else { 0 };
        scale_exponent = scale_exponent.max(*Self::SCALE_EXPONENTS.start());
        loop {
            let half = power_of_two(scale_exponent - 1);
            let centre = |k: usize| 0.5 * (f64::from(lower[k]) + f64::from(upper[k]));
            let frame = Self { origin: core::array::from_fn(|k| centre(k) - half), scale_exponent };
            let (low, high) = (frame.to_lattice(lower), frame.to_lattice(upper));
            if low.iter().all(|c| *c >= margin) && high.iter().all(|c| *c <= 1.0 - margin) {
                return frame;
            }
            // A box of no extent far away: its lattice coordinates are all one half, so this ends at once.
            scale_exponent += 1;
        }
    }

    /// The root's edge in the caller's units.
    pub fn scale(&self) -> f64 {
        power_of_two(self.scale_exponent)
    }

    /// A point in lattice units, rounded once; magnitudes under 2^-60 become 0.
    #[inline(always)]
    pub fn to_lattice(&self, point: [f32; 3]) -> [f32; 3] {
        let inverse = power_of_two(-self.scale_exponent);
        unroll!(k in 0..3 => flush(((f64::from(point[k]) - self.origin[k]) * inverse) as f32, SMALLEST))
    }

    /// A lattice point in the caller's units.
    pub fn to_caller(&self, point: [f32; 3]) -> [f64; 3] {
        core::array::from_fn(|k| self.origin[k] + self.scale() * f64::from(point[k]))
    }
}

/// `x`, or 0 where its magnitude is under `smallest`: neither subnormals nor the sign of zero carry meaning.
#[inline(always)]
pub(crate) fn flush(x: f32, smallest: f32) -> f32 {
    if x.abs() < smallest { 0.0 } else { x }
}

/// 2 to a power within -1022..=1023.
#[inline(always)]
pub(crate) fn power_of_two(exponent: i32) -> f64 {
    debug_assert!((-1022..=1023).contains(&exponent));
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

/// The exponent of a positive normal number: `2^e <= x < 2^(e+1)`.
pub(crate) fn exponent(x: f64) -> i32 {
    (x.to_bits() >> 52) as i32 - 1023
}
