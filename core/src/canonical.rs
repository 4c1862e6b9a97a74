//! From the caller's rays to canonical ones.
//!
//! Most rays start near the root and have numbers of common size: [`CommonRays`] makes these canonical in f32, in any lanes,
//! with the bits that f64 would give. The others go through f64 one by one.

use core::ops::RangeInclusive;

use crate::clock::Clock;
use crate::contract::{PADDING, SMALLEST, SMALLEST_DIRECTION};
use crate::frame::{Frame, exponent, flush, power_of_two};
use crate::lanes::{Bits, Lanes};
use crate::layout::LATTICE;
use crate::policy::{Policy, Standard};
use crate::ray::{CanonicalRay, Ray};
use crate::ray_f64::RayF64;
use crate::unroll;

/// The root's edge.
const EDGE: f32 = LATTICE as f32;
/// Origins in this range, seen from the root's corner, surely lie within one root edge of the root, rounding or not.
const NEAR: (f32, f32) = (-0.999 * EDGE, 1.999 * EDGE);
/// Largest direction components from its inverse to this keep the factors that scale them normal numbers.
const COMMON_EXPONENT: i32 = 60;
/// Powers of two that a unit of t' may be worth, such that no t of a hit is rounded: t' is 0 or from 2^-60 to 2^19, with
/// 24 bits, and t must be a normal number.
const EXACT_UNITS: RangeInclusive<i32> = -66..=108;
/// Powers of two that a lattice step may be worth, so that its inverse is a normal number.
const COMMON_STEPS: RangeInclusive<i32> = -120..=120;
/// Bias of an f32's exponent, and where it starts.
const BIAS: i32 = 127;
const EXPONENT_SHIFT: u32 = 23;

/// A frame, with all that [`CommonRays`] wants to know of it. Made once, it serves for all rays.
#[derive(Clone, Copy, Debug)]
pub struct PreparedFrame {
    frame: Frame,
    anchor: [f32; 3],
    /// Lattice steps in a unit of the caller's.
    per_unit: f32,
    step_exponent: i32,
    /// The largest components that common directions may have; none where no ray is common.
    directions: (f32, f32),
}

impl PreparedFrame {
    /// The frame itself.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// As [`Frame::canonical`].
    #[inline(always)]
    pub fn canonical(&self, ray: &Ray) -> Option<CanonicalRay> {
        match self.common_ray(ray) {
            None => self.frame.uncommon::<Standard>(ray),
            common => common,
        }
    }

    /// A ray of the common kind.
    #[inline(always)]
    fn common_ray(&self, ray: &Ray) -> Option<CanonicalRay> {
        let rays = CommonRays::<f32>::new(self, ray.origin, ray.direction, ray.t_min, ray.t_max);
        let CommonRays { origin, within, direction, t_min, t_max, unit, is_common } = rays;
        let clock = Clock { entry: 0.0, unit: f64::from(unit) };
        is_common.then_some(CanonicalRay { origin, within, t_min, direction, t_max, clock })
    }
}

impl Frame {
    /// The frame as it serves for many rays.
    #[inline]
    pub fn prepare(&self) -> PreparedFrame {
        let step_exponent = self.step_exponent();
        let anchor = self.anchor.map(|c| c as f32);
        let is_f32 = (0..3).all(|k| f64::from(anchor[k]) == self.anchor[k]);
        // A unit of t' is worth a lattice step over the power of two of the direction.
        let least = (-COMMON_EXPONENT).max(step_exponent - EXACT_UNITS.end());
        let most = COMMON_EXPONENT.min(step_exponent - EXACT_UNITS.start());
        let is_common = is_f32 && COMMON_STEPS.contains(&step_exponent) && least <= most;
        let power = |exponent: i32| power_of_two(exponent) as f32;
        PreparedFrame {
            frame: *self,
            anchor,
            per_unit: if is_common { power(-step_exponent) } else { 0.0 },
            step_exponent,
            directions: if is_common { (power(least), power(most)) } else { (f32::INFINITY, 0.0) },
        }
    }
}

/// Rays a lane, canonical where they are of the common kind.
#[derive(Clone, Copy, Debug)]
pub struct CommonRays<L: Lanes> {
    /// On the lattice.
    pub origin: [L; 3],
    /// The origin as seen from the root's corner.
    pub within: [L; 3],
    /// Canonical.
    pub direction: [L; 3],
    /// t'.
    pub t_min: L,
    /// t'.
    pub t_max: L,
    /// One unit of t' in the caller's t: a power of two.
    pub unit: L,
    /// The lanes whose rays are valid, near and of common size; the others hold nothing of use.
    pub is_common: L::Mask,
}

impl<L: Lanes> CommonRays<L> {
    /// Takes rays as given.
    #[inline(always)]
    pub fn new(frame: &PreparedFrame, given: [L; 3], direction: [L; 3], t_min: L, t_max: L) -> Self {
        let per_unit = L::splat(frame.per_unit);
        let origin: [L; 3] = unroll!(k in 0..3 => ((given[k] - L::splat(frame.anchor[k])) * per_unit).flush(SMALLEST));
        let within: [L; 3] = unroll!(k in 0..3 => origin[k] - L::splat(frame.frame.corner[k]));
        let [x, y, z]: [L; 3] = unroll!(k in 0..3 => direction[k].abs());
        let largest = x.max(y.max(z));
        let [a, b, c]: [L; 3] = unroll!(k in 0..3 => self_difference(direction[k]) + self_difference(given[k]));
        let is_finite = (((a + b) + c) + self_difference(t_min)).equal(L::splat(0.0)) & t_max.equal(t_max);
        let is_near = in_range(within[0], NEAR) & in_range(within[1], NEAR) & in_range(within[2], NEAR);
        let exponent = largest.bits() >> L::Bits::splat(EXPONENT_SHIFT);
        let shrink = power::<L>(L::Bits::splat(2 * BIAS as u32).minus(exponent));
        let per_t = exponent.minus(L::Bits::splat(frame.step_exponent as u32));
        let unit = power::<L>(L::Bits::splat(2 * BIAS as u32).minus(per_t));
        let per_t = power::<L>(per_t);
        let limits = (t_min * per_t, t_max * per_t);
        let are_plain = is_plain(t_min, limits.0) & is_plain(t_max, limits.1);
        Self {
            origin,
            within,
            direction: unroll!(k in 0..3 => (direction[k] * shrink).flush(SMALLEST_DIRECTION)),
            t_min: limits.0,
            t_max: limits.1,
            unit,
            is_common: is_finite & is_near & are_plain & in_range(largest, frame.directions),
        }
    }
}

/// Whether a limit is no smaller on the lattice than any t' but 0, so that it was not rounded, or is 0.
#[inline(always)]
fn is_plain<L: Lanes>(given: L, scaled: L) -> L::Mask {
    L::splat(SMALLEST).at_most(scaled.abs()) | given.equal(L::splat(0.0))
}

/// 0, but NaN for what is not finite.
#[inline(always)]
fn self_difference<L: Lanes>(x: L) -> L {
    let same = x;
    x - same
}

#[inline(always)]
fn in_range<L: Lanes>(x: L, (low, high): (f32, f32)) -> L::Mask {
    L::splat(low).at_most(x) & x.at_most(L::splat(high))
}

/// 2 to a power, given with the bias.
#[inline(always)]
fn power<L: Lanes>(biased: L::Bits) -> L {
    L::from_bits(biased << L::Bits::splat(EXPONENT_SHIFT))
}

impl Frame {
    /// The ray that every backend traces, or `None`: it is invalid, or passes the root by.
    #[inline(always)]
    pub fn canonical(&self, ray: &Ray) -> Option<CanonicalRay> {
        self.prepare().canonical(ray)
    }

    /// The canonical form of a ray of f64. What is rounded, once, is its origin as seen from the anchor; or, where that is
    /// far away, the point at which it enters the root.
    pub fn canonical_f64(&self, ray: &RayF64) -> Option<CanonicalRay> {
        if !ray.is_valid() {
            return None;
        }
        self.by_f64::<Standard>(ray.origin, ray.direction, |clock| clock.limits_f64(ray.t_min, ray.t_max))
    }

    /// See [`crate::testing::canonical`].
    #[inline(always)]
    pub(crate) fn canonical_with<P: Policy>(&self, ray: &Ray) -> Option<CanonicalRay> {
        // A ray that is not moved meets no other clause that a policy may spoil.
        if !P::CLAMPS_T_MIN
            && let Some(ray) = self.prepare().common_ray(ray)
        {
            return Some(ray);
        }
        self.uncommon::<P>(ray)
    }

    /// Any ray of f32.
    #[inline(never)]
    fn uncommon<P: Policy>(&self, ray: &Ray) -> Option<CanonicalRay> {
        if !ray.is_valid() {
            return None;
        }
        self.by_f64::<P>(ray.origin.map(f64::from), ray.direction.map(f64::from), |clock| match P::ROUNDS_LIMITS {
            true => clock.rounded_limits(ray.t_min, ray.t_max),
            false => clock.limits(ray.t_min, ray.t_max),
        })
    }

    /// A valid ray, whose limits of t' the clock tells.
    #[inline(always)]
    fn by_f64<P: Policy>(
        &self,
        given: [f64; 3],
        direction: [f64; 3],
        limits: impl Fn(&Clock) -> (f32, f32),
    ) -> Option<CanonicalRay> {
        let per_unit = power_of_two(-self.step_exponent());
        let corner = self.corner.map(f64::from);
        let lattice: [f64; 3] = core::array::from_fn(|k| (given[k] - self.anchor[k]) * per_unit);
        let largest = exponent(direction.iter().fold(0.0, |most, c| c.abs().max(most)));
        let shrink = power_of_two(-largest);
        let direction = direction.map(|c| c * shrink);

        let edge = f64::from(EDGE);
        let within: [f64; 3] = core::array::from_fn(|k| lattice[k] - corner[k]);
        let excess = within.iter().map(|c| (c - edge).max(-c)).fold(0.0, f64::max);
        let mut entry = 0.0;
        let mut origin = lattice.map(|c| flush(c as f32, SMALLEST));
        if excess > edge {
            let (t, point) = enter::<P>(within, direction)?;
            origin = core::array::from_fn(|k| flush((corner[k] + point[k]) as f32, SMALLEST));
            // The moved origin was rounded: as far as that is along the ray, the clock knows better.
            let moved: [f64; 3] = core::array::from_fn(|k| f64::from(origin[k]) - corner[k]);
            let along = |k: usize| (moved[k] - (within[k] + t * direction[k])) * direction[k];
            let squared = direction.iter().map(|c| c * c).sum::<f64>();
            entry = t + (along(0) + along(1) + along(2)) / squared;
        }
        let clock = Clock { entry, unit: power_of_two(self.step_exponent() - largest) };
        let (t_min, t_max) = limits(&clock);
        let t_min = if P::CLAMPS_T_MIN { t_min.max(0.0) } else { t_min };
        let direction = direction.map(|c| flush(c as f32, SMALLEST_DIRECTION));
        Some(CanonicalRay { origin, within: self.to_root(origin), t_min, direction, t_max, clock })
    }
}

/// Where a line that meets the root dilated by the padding enters the root: t', and the point clamped to the root, all as
/// seen from the root's corner.
///
/// The root itself is entered, not the dilated one: clamping the point of the latter would move every ray.
fn enter<P: Policy>(origin: [f64; 3], direction: [f64; 3]) -> Option<(f64, [f64; 3])> {
    let edge = f64::from(EDGE);
    let margin = if P::DILATES_ROOT { f64::from(PADDING) } else { 0.0 };
    let (mut entry, mut first, mut last) = (f64::NEG_INFINITY, f64::NEG_INFINITY, f64::INFINITY);
    for k in 0..3 {
        let (near, far, outward) = if direction[k] < 0.0 { (edge, 0.0, margin) } else { (0.0, edge, -margin) };
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
    let point = core::array::from_fn(|k| (origin[k] + entry * direction[k]).clamp(0.0, edge));
    (first <= last).then_some((entry, point))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clock::FARTHEST;

    /// The common kind and f64 agree wherever the former applies, up to its limits.
    #[test]
    fn common_rays_have_the_bits_of_f64() {
        let sizes =
            [0.0, 1e-40, 1e-19, 8.6e-19, 8.7e-19, 1e-3, 1.0, 1.5, 3.0, 1e17, 1.1e18, 1.2e18, 1e30, f32::INFINITY];
        let (mut common, mut uncommon) = (0, 0);
        for scale_exponent in [-149, -105, -61, -60, -3, 0, 7, 60, 61, 108, 131] {
            let edge = power_of_two(scale_exponent);
            for anchor in [0.0, 0.25 * edge, 1.625 * edge, 2.1 * edge] {
                let anchor = [anchor, -anchor, 0.0].map(|c| f64::from(c as f32));
                let frame = Frame { anchor, corner: [-7.0, 1300.0, 0.0], scale_exponent };
                for (i, a) in sizes.into_iter().enumerate() {
                    for (b, c) in [(sizes[i / 2], -1.0), (-a, 0.0), (0.0, -1e-13), (f32::NAN, 1.0)] {
                        for at in [-0.9, 0.0, 1e-20, 0.7, 2.3] {
                            let origin = core::array::from_fn(|k| (anchor[k] + at * edge) as f32);
                            let ray = Ray::between(origin, [a, b, c], -a, sizes[sizes.len() - 1 - i]);
                            let Some(found) = frame.prepare().common_ray(&ray) else {
                                uncommon += 1;
                                continue;
                            };
                            common += 1;
                            let expected = frame.uncommon::<Standard>(&ray).expect("a valid ray");
                            assert_eq!(bits(&found), bits(&expected), "{ray:?} {frame:?}");
                            // Beyond what any t' may be, limits need not be the same.
                            let limits =
                                |ray: &CanonicalRay| [ray.t_min, ray.t_max].map(|t| t.clamp(-FARTHEST, FARTHEST));
                            assert_eq!(limits(&found), limits(&expected), "{ray:?} {frame:?}");
                        }
                    }
                }
            }
        }
        assert!(common > 100 && uncommon > 100, "{common} common rays, {uncommon} others");
    }

    /// A ray of f32 is the same ray in f64, and its limits hold for the t that f64 has.
    #[test]
    fn rays_of_f64_have_the_bits_of_f32() {
        let frame = Frame { anchor: [0.25, -3.0, 1e6], corner: [-7.0, 1300.0, 0.0], scale_exponent: 3 };
        for (origin, direction) in [
            ([0.3, -2.0, 1_000_001.0], [0.1, -0.2, 3.0]),
            ([5.0, -2.0, 999_990.0], [0.0, 0.0, 1e-20]),
            ([-1e9, -3.0, 1e6], [1.0, 1e-9, 0.0]),
        ] {
            for (t_min, t_max) in [(0.0, f32::INFINITY), (-0.7, 0.3), (1e-30, 1e9)] {
                let ray = Ray::between(origin, direction, t_min, t_max);
                let expected = frame.canonical(&ray).expect("a ray that meets the root");
                let found = frame.canonical_f64(&ray.into()).expect("the same ray");
                assert_eq!(bits(&found), bits(&expected), "{ray:?}");
                let clock = found.clock;
                let is_inside = |t: f32| clock.reported_f64(t) > t_min.into() && clock.reported_f64(t) < t_max.into();
                for t in [found.t_min, found.t_max].into_iter().filter(|t| t.abs() < 1e5) {
                    // No hit has a smaller t', and none lies farther behind a moved origin.
                    let least = if clock.entry == 0.0 { f32::MIN } else { -1.0 };
                    let is_possible = |t: &f32| (*t == 0.0 || t.abs() >= SMALLEST) && *t > least;
                    for t in [t * 0.999_999_9, t, t * 1.000_000_1].into_iter().filter(is_possible) {
                        assert_eq!(t > found.t_min && t < found.t_max, is_inside(t), "{t} of {ray:?}");
                    }
                }
            }
        }
        for direction in [[0.0, 1e-46, 0.0], [1e39, 0.0, 0.0], [f64::NAN, 0.0, 1.0]] {
            assert!(frame.canonical_f64(&RayF64::new([0.0; 3], direction)).is_none(), "{direction:?}");
        }
    }

    fn bits(ray: &CanonicalRay) -> ([u32; 9], [u64; 2]) {
        let CanonicalRay { origin: o, within: w, direction: d, clock, .. } = ray;
        let numbers = [o[0], o[1], o[2], w[0], w[1], w[2], d[0], d[1], d[2]].map(f32::to_bits);
        (numbers, [clock.entry, clock.unit].map(f64::to_bits))
    }
}
