//! Rays and hits in f64, for scenes whose places f32 cannot tell apart.

use bytemuck::{Pod, Zeroable};

use crate::ray::{Hit, Ray};

/// A [`Ray`] in f64. Where a scene lies far from 0, as in UTM coordinates, an origin of f32 would itself be off by more
/// than the scene's details.
///
/// Its numbers have the precision of f64 and the range of f32: the ray is *invalid*, and misses, where a [`Ray`] is, and
/// also when a component of `origin` or `direction` exceeds [`f32::MAX`], or none of the direction's reaches the smallest
/// number of f32.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(C)]
pub struct RayF64 {
    /// Where `t` is 0.
    #[cfg_attr(feature = "serde", serde(with = "crate::numbers::triple"))]
    pub origin: [f64; 3],
    /// Hits count strictly beyond it; it may be negative.
    #[cfg_attr(feature = "serde", serde(with = "crate::numbers::number"))]
    pub t_min: f64,
    /// Any length but zero.
    #[cfg_attr(feature = "serde", serde(with = "crate::numbers::triple"))]
    pub direction: [f64; 3],
    /// Hits count strictly before it; infinity means no limit.
    #[cfg_attr(feature = "serde", serde(with = "crate::numbers::number"))]
    pub t_max: f64,
}

impl RayF64 {
    /// A ray from `origin` on, without a limit: `0 < t`.
    pub fn new(origin: impl Into<[f64; 3]>, direction: impl Into<[f64; 3]>) -> Self {
        Self::between(origin, direction, 0.0, f64::INFINITY)
    }

    /// A ray limited to `t_min < t < t_max`.
    pub fn between(origin: impl Into<[f64; 3]>, direction: impl Into<[f64; 3]>, t_min: f64, t_max: f64) -> Self {
        Self { origin: origin.into(), t_min, direction: direction.into(), t_max }
    }

    /// The point `origin + t * direction`.
    pub fn at(&self, t: f64) -> [f64; 3] {
        core::array::from_fn(|k| self.origin[k] + t * self.direction[k])
    }

    /// Whether the ray can be traced at all; an invalid ray misses.
    pub fn is_valid(&self) -> bool {
        let in_range = self.origin.iter().chain(&self.direction).all(|c| c.abs() <= f64::from(f32::MAX));
        let has_direction = self.direction.iter().any(|c| c.abs() >= f64::from(f32::from_bits(1)));
        in_range && has_direction && self.t_min.is_finite() && !self.t_max.is_nan()
    }
}

impl From<Ray> for RayF64 {
    /// The same ray: every number of f32 is also one of f64.
    fn from(ray: Ray) -> Self {
        let Ray { origin, t_min, direction, t_max } = ray;
        Self::between(origin.map(f64::from), direction.map(f64::from), t_min.into(), t_max.into())
    }
}

impl From<RayF64> for Ray {
    /// Each number is rounded to f32.
    fn from(ray: RayF64) -> Self {
        let RayF64 { origin, t_min, direction, t_max } = ray;
        Self::between(origin.map(|c| c as f32), direction.map(|c| c as f32), t_min as f32, t_max as f32)
    }
}

/// A [`Hit`] whose distance is not rounded to f32; or [`HitF64::MISS`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct HitF64 {
    /// Distance along the ray in multiples of its direction; infinity for a miss.
    #[cfg_attr(feature = "serde", serde(with = "crate::numbers::number"))]
    pub t: f64,
    /// Barycentric weight of the triangle's vertex 1, in 0..=1.
    #[cfg_attr(feature = "serde", serde(with = "crate::numbers::number"))]
    pub u: f32,
    /// Barycentric weight of the triangle's vertex 2, in 0..=1.
    #[cfg_attr(feature = "serde", serde(with = "crate::numbers::number"))]
    pub v: f32,
    /// The triangle's index in the mesh; `u32::MAX` for a miss.
    pub primitive: u32,
}

impl HitF64 {
    /// No triangle was met.
    pub const MISS: Self = Self { t: f64::INFINITY, u: 0.0, v: 0.0, primitive: u32::MAX };

    /// Whether this is [`HitF64::MISS`].
    pub fn is_miss(&self) -> bool {
        self.primitive == u32::MAX
    }

    /// The hit, or `None` for a miss.
    pub fn ok(self) -> Option<Self> {
        (!self.is_miss()).then_some(self)
    }
}

impl From<Option<HitF64>> for HitF64 {
    /// [`HitF64::MISS`] for `None`.
    fn from(hit: Option<HitF64>) -> Self {
        hit.unwrap_or(Self::MISS)
    }
}

impl From<HitF64> for Hit {
    /// The distance is rounded to f32, that of a hit to a finite number.
    fn from(hit: HitF64) -> Self {
        let HitF64 { t, u, v, primitive } = hit;
        if hit.is_miss() { Self::MISS } else { Self { t: (t as f32).clamp(f32::MIN, f32::MAX), u, v, primitive } }
    }
}
