//! Rays as callers give them, hits as they get them back, and the canonical ray that every backend traces.

use bytemuck::{Pod, Zeroable};

use crate::clock::Clock;

/// A ray in the caller's units: the points `origin + t * direction` with `t_min < t < t_max`.
///
/// The direction needs no unit length; `t` counts in multiples of it. A ray is *invalid*, and misses, when any
/// component is NaN, when `origin`, `direction` or `t_min` holds an infinity, or when the direction is zero.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(C)]
pub struct Ray {
    /// Where `t` is 0.
    #[cfg_attr(feature = "serde", serde(with = "crate::numbers::triple"))]
    pub origin: [f32; 3],
    /// Hits count strictly beyond it; it may be negative.
    #[cfg_attr(feature = "serde", serde(with = "crate::numbers::number"))]
    pub t_min: f32,
    /// Any length but zero.
    #[cfg_attr(feature = "serde", serde(with = "crate::numbers::triple"))]
    pub direction: [f32; 3],
    /// Hits count strictly before it; infinity means no limit.
    #[cfg_attr(feature = "serde", serde(with = "crate::numbers::number"))]
    pub t_max: f32,
}

impl Ray {
    /// A ray from `origin` on, without a limit: `0 < t`.
    pub fn new(origin: impl Into<[f32; 3]>, direction: impl Into<[f32; 3]>) -> Self {
        Self::between(origin, direction, 0.0, f32::INFINITY)
    }

    /// A ray limited to `t_min < t < t_max`.
    pub fn between(origin: impl Into<[f32; 3]>, direction: impl Into<[f32; 3]>, t_min: f32, t_max: f32) -> Self {
        Self { origin: origin.into(), t_min, direction: direction.into(), t_max }
    }

    /// The point `origin + t * direction`, computed in f64 and rounded once.
    ///
    /// Far from the origin it may lie off the triangle that was hit there; [`Hit::position`] lies on it.
    pub fn at(&self, t: f32) -> [f32; 3] {
        core::array::from_fn(|k| (f64::from(self.origin[k]) + f64::from(t) * f64::from(self.direction[k])) as f32)
    }

    /// Whether the ray can be traced at all; an invalid ray misses.
    pub fn is_valid(&self) -> bool {
        let finite = self.origin.iter().chain(&self.direction).all(|c| c.is_finite());
        finite && self.t_min.is_finite() && !self.t_max.is_nan() && self.direction != [0.0; 3]
    }
}

/// Where a ray meets a triangle, or [`Hit::MISS`].
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(C)]
pub struct Hit {
    /// Distance along the ray in multiples of its direction; infinity for a miss.
    #[cfg_attr(feature = "serde", serde(with = "crate::numbers::number"))]
    pub t: f32,
    /// Barycentric weight of the triangle's vertex 1, in 0..=1.
    #[cfg_attr(feature = "serde", serde(with = "crate::numbers::number"))]
    pub u: f32,
    /// Barycentric weight of the triangle's vertex 2, in 0..=1.
    #[cfg_attr(feature = "serde", serde(with = "crate::numbers::number"))]
    pub v: f32,
    /// The triangle's index in the mesh; `u32::MAX` for a miss.
    pub primitive: u32,
}

impl Hit {
    /// No triangle was met.
    pub const MISS: Self = Self { t: f32::INFINITY, u: 0.0, v: 0.0, primitive: u32::MAX };

    /// Whether this is [`Hit::MISS`].
    pub fn is_miss(&self) -> bool {
        self.primitive == u32::MAX
    }

    /// The hit, or `None` for a miss.
    pub fn ok(self) -> Option<Self> {
        (!self.is_miss()).then_some(self)
    }
}

impl From<Option<Hit>> for Hit {
    /// [`Hit::MISS`] for `None`.
    fn from(hit: Option<Hit>) -> Self {
        hit.unwrap_or(Self::MISS)
    }
}

/// FNV-1a (64 bits) over the 16 bytes of each hit, in order: one number to compare two backends by.
pub fn hit_hash(hits: &[Hit]) -> u64 {
    const OFFSET_BASIS: u64 = 0xcbf2_9ce4_8422_2325;
    const PRIME: u64 = 0x100_0000_01b3;
    let words = hits.iter().flat_map(|hit| [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.primitive]);
    words.flat_map(u32::to_le_bytes).fold(OFFSET_BASIS, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(PRIME))
}

/// A ray on the lattice, rescaled so that every backend sees the same numbers; made by [`crate::Frame::canonical`].
///
/// The largest direction component lies in 1..2 and those under 2^-40 are 0. Distances along it are written t'.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CanonicalRay {
    /// In lattice coordinates, within one root edge of the root cube: what triangles are tested from.
    pub origin: [f32; 3],
    /// The origin as seen from the root's corner, rounded once: what cells and boxes are met from.
    pub within: [f32; 3],
    /// Hits count for t' strictly above it.
    pub t_min: f32,
    /// Scaled by a power of two.
    pub direction: [f32; 3],
    /// Hits count for t' strictly below it; may be infinite.
    pub t_max: f32,
    /// From t' to the caller's t.
    pub clock: Clock,
}
