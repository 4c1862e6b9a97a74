//! From the caller's rays to canonical ones.
//!
//! Most rays start near the root and have numbers of common size: [`CommonRays`] makes these canonical in f32, in any lanes,
//! with the bits that f64 would give. The others go through f64 one by one.

use crate::contract::{PADDING, SMALLEST, SMALLEST_DIRECTION};
use crate::frame::{Frame, exponent, flush, power_of_two};
use crate::lanes::{Bits, Lanes};
use crate::policy::{Policy, Standard};
use crate::ray::{CanonicalRay, Clock, Ray};
use crate::unroll;

/// Origins in this range surely lie within one root edge of the root, rounding or not.
const NEAR: (f32, f32) = (-0.999, 1.999);
/// Largest direction components from its inverse to this, and as many root edges, keep all factors normal numbers.
const COMMON_EXPONENT: i32 = 60;
/// Bias of an f32's exponent, and where it starts.
const BIAS: i32 = 127;
const EXPONENT_SHIFT: u32 = 23;

/// Rays a lane, canonical where they are of the common kind.
#[derive(Clone, Copy, Debug)]
pub struct CommonRays<L: Lanes> {
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
    /// Takes rays as given, and their origins in lattice units.
    #[inline(always)]
    pub fn new(frame: &Frame, given: [L; 3], origin: [L; 3], direction: [L; 3], t_min: L, t_max: L) -> Self {
        let [x, y, z]: [L; 3] = unroll!(k in 0..3 => direction[k].abs());
        let largest = x.max(y.max(z));
        let [a, b, c]: [L; 3] = unroll!(k in 0..3 => self_difference(direction[k]) + self_difference(given[k]));
        let is_finite = (((a + b) + c) + self_difference(t_min)).equal(L::splat(0.0)) & t_max.equal(t_max);
        let is_near = in_range(origin[0], NEAR) & in_range(origin[1], NEAR) & in_range(origin[2], NEAR);
        // The sizes of no ray are common where those of the root are not.
        let most = if (-COMMON_EXPONENT..=COMMON_EXPONENT).contains(&frame.scale_exponent) {
            (1u64 << COMMON_EXPONENT) as f32
        } else {
            0.0
        };
        let is_common = is_finite & is_near & in_range(largest, (1.0 / (1u64 << COMMON_EXPONENT) as f32, most));
        let exponent = largest.bits() >> L::Bits::splat(EXPONENT_SHIFT);
        let shrink = power::<L>(L::Bits::splat(2 * BIAS as u32).minus(exponent));
        let per_t = exponent.minus(L::Bits::splat(frame.scale_exponent as u32));
        let unit = power::<L>(L::Bits::splat(2 * BIAS as u32).minus(per_t));
        let per_t = power::<L>(per_t);
        Self {
            direction: unroll!(k in 0..3 => (direction[k] * shrink).flush(SMALLEST_DIRECTION)),
            t_min: t_min * per_t,
            t_max: t_max * per_t,
            unit,
            is_common,
        }
    }
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
        self.canonical_with::<Standard>(ray)
    }

    /// See [`crate::testing::canonical`].
    #[inline(always)]
    pub(crate) fn canonical_with<P: Policy>(&self, ray: &Ray) -> Option<CanonicalRay> {
        // A ray that is not moved meets no other clause that a policy may spoil.
        if !P::CLAMPS_T_MIN
            && let Some(ray) = self.common(ray)
        {
            return Some(ray);
        }
        self.uncommon::<P>(ray)
    }

    /// A ray of the common kind.
    #[inline(always)]
    fn common(&self, ray: &Ray) -> Option<CanonicalRay> {
        let origin = self.to_lattice(ray.origin);
        let common = CommonRays::<f32>::new(self, ray.origin, origin, ray.direction, ray.t_min, ray.t_max);
        let CommonRays { direction, t_min, t_max, unit, is_common } = common;
        let clock = Clock { entry: 0.0, unit: f64::from(unit) };
        is_common.then_some(CanonicalRay { origin, t_min, direction, t_max, clock })
    }

    /// Any ray, by f64.
    #[inline(never)]
    fn uncommon<P: Policy>(&self, ray: &Ray) -> Option<CanonicalRay> {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The common kind and f64 agree wherever the former applies, up to its limits.
    #[test]
    fn common_rays_have_the_bits_of_f64() {
        let sizes =
            [0.0, 1e-40, 1e-19, 8.6e-19, 8.7e-19, 1e-3, 1.0, 1.5, 3.0, 1e17, 1.1e18, 1.2e18, 1e30, f32::INFINITY];
        let (mut common, mut uncommon) = (0, 0);
        for scale_exponent in [-149, -61, -60, -3, 0, 7, 60, 61, 131] {
            let frame = Frame { origin: [0.25 * power_of_two(scale_exponent); 3], scale_exponent };
            for (i, a) in sizes.into_iter().enumerate() {
                for (b, c) in [(sizes[i / 2], -1.0), (-a, 0.0), (0.0, -1e-13), (f32::NAN, 1.0)] {
                    for at in [-0.9, 0.0, 0.7, 2.3] {
                        let origin = [(at * frame.scale()) as f32; 3];
                        let ray = Ray::between(origin, [a, b, c], -a, sizes[sizes.len() - 1 - i]);
                        let Some(found) = frame.common(&ray) else {
                            uncommon += 1;
                            continue;
                        };
                        common += 1;
                        let bits = |ray: CanonicalRay| {
                            let CanonicalRay { origin: o, direction: d, clock, .. } = ray;
                            let numbers = [o[0], o[1], o[2], d[0], d[1], d[2], ray.t_min, ray.t_max].map(f32::to_bits);
                            (numbers, clock.entry.to_bits(), clock.unit.to_bits())
                        };
                        assert_eq!(Some(bits(found)), frame.uncommon::<Standard>(&ray).map(bits), "{ray:?} {frame:?}");
                    }
                }
            }
        }
        assert!(common > 100 && uncommon > 100, "{common} common rays, {uncommon} others");
    }
}
