//! The lattice frame: the caller's units on one side, the unit root cube on the other.

use crate::layout::{MESH_MARGIN, PADDING, SMALLEST, SMALLEST_DIRECTION};
use crate::policy::{Policy, Standard};
use crate::ray::{CanonicalRay, Clock, Ray};

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

    /// A frame without the margin, which the contract forbids: the mesh may touch the root's faces.
    #[doc(hidden)]
    pub fn touching(lower: [f32; 3], upper: [f32; 3]) -> Self {
        Self::around_with_margin(lower, upper, 0.0)
    }

    fn around_with_margin(lower: [f32; 3], upper: [f32; 3], margin: f32) -> Self {
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
    pub fn to_lattice(&self, point: [f32; 3]) -> [f32; 3] {
        let inverse = power_of_two(-self.scale_exponent);
        core::array::from_fn(|k| flush(((f64::from(point[k]) - self.origin[k]) * inverse) as f32, SMALLEST))
    }

    /// A lattice point in the caller's units.
    pub fn to_caller(&self, point: [f32; 3]) -> [f64; 3] {
        core::array::from_fn(|k| self.origin[k] + self.scale() * f64::from(point[k]))
    }

    /// The ray that every backend traces, or `None`: it is invalid, or passes the root by.
    pub fn canonical(&self, ray: &Ray) -> Option<CanonicalRay> {
        self.canonical_with::<Standard>(ray)
    }

    /// [`Frame::canonical`] under a policy that tests may spoil.
    #[doc(hidden)]
    pub fn canonical_with<P: Policy>(&self, ray: &Ray) -> Option<CanonicalRay> {
        if !ray.is_valid() {
            return None;
        }
        let inverse = power_of_two(-self.scale_exponent);
        let origin: [f64; 3] = core::array::from_fn(|k| (f64::from(ray.origin[k]) - self.origin[k]) * inverse);
        let direction = ray.direction.map(f64::from);
        let largest = exponent(direction.iter().fold(0.0, |most, c| c.abs().max(most)));
        let shrink = power_of_two(-largest);
        let direction = direction.map(|c| c * shrink);

        let excess = origin.iter().map(|c| (c - 1.0).max(-c)).fold(0.0, f64::max);
        let (t_entry, origin) = if excess > 1.0 { enter::<P>(origin, direction)? } else { (0.0, origin) };

        let per_t = power_of_two(largest - self.scale_exponent);
        let limit = |t: f32| (f64::from(t) * per_t - t_entry) as f32;
        let t_min = if P::CLAMPS_T_MIN { limit(ray.t_min).max(0.0) } else { limit(ray.t_min) };
        Some(CanonicalRay {
            origin: origin.map(|c| flush(c as f32, SMALLEST)),
            t_min,
            direction: direction.map(|c| flush(c as f32, SMALLEST_DIRECTION)),
            t_max: limit(ray.t_max),
            clock: Clock { entry: t_entry, unit: power_of_two(self.scale_exponent - largest) },
        })
    }
}

/// Where a line that meets the root dilated by the padding enters the root: t', and the point clamped to the root.
///
/// The root itself is entered, not the dilated one: clamping the point of the latter would move every ray.
fn enter<P: Policy>(origin: [f64; 3], direction: [f64; 3]) -> Option<(f64, [f64; 3])> {
    let margin = if P::DILATES_ROOT { f64::from(PADDING) } else { 0.0 };
    let (mut entry, mut first, mut last) = (f64::NEG_INFINITY, f64::NEG_INFINITY, f64::INFINITY);
    for k in 0..3 {
        let (near, far, outward) = if direction[k] < 0.0 { (1.0, 0.0, margin) } else { (0.0, 1.0, -margin) };
        if direction[k] != 0.0 {
            entry = entry.max((near - origin[k]) / direction[k]);
            first = first.max((near + outward - origin[k]) / direction[k]);
            last = last.min((far - outward - origin[k]) / direction[k]);
        } else if origin[k] < near + outward || origin[k] > far - outward {
            return None;
        }
    }
    // A line that passes through the margin alone may leave it before it would come to the root.
    let entry = entry.min(last);
    let point = core::array::from_fn(|k| (origin[k] + entry * direction[k]).clamp(0.0, 1.0));
    (first <= last).then_some((entry, point))
}

/// `x`, or 0 where its magnitude is under `smallest`: neither subnormals nor the sign of zero carry meaning.
pub(crate) fn flush(x: f32, smallest: f32) -> f32 {
    if x.abs() < smallest { 0.0 } else { x }
}

/// 2 to a power within -1022..=1023.
fn power_of_two(exponent: i32) -> f64 {
    debug_assert!((-1022..=1023).contains(&exponent));
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

/// The exponent of a positive normal number: `2^e <= x < 2^(e+1)`.
fn exponent(x: f64) -> i32 {
    (x.to_bits() >> 52) as i32 - 1023
}
