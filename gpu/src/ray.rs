//! Rays and hits as shaders see them.

use bytemuck::{Pod, Zeroable};
use leafwalk_core::{CanonicalRay, Clock, Hit};

/// Limits of t' beyond this are brought here, since shaders know no infinity.
///
/// A hit's t' is an average of three distances along the main axis (at most 2, as origins are within a root edge of the
/// root) over a direction component of at least 1, so its magnitude stays under 4: no hit is lost or won, no walk
/// differs. In lattice steps it is 2^36, far from the largest f32.
const FARTHEST: f32 = (1 << 20) as f32;

/// A canonical ray without its clock, 32 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct DeviceRay {
    /// In lattice units.
    pub origin: [f32; 3],
    /// Hits count for t' strictly above it.
    pub t_min: f32,
    /// Its largest component lies in 1..2.
    pub direction: [f32; 3],
    /// Hits count for t' strictly below it.
    pub t_max: f32,
}

impl DeviceRay {
    /// Ends where it starts, and so misses: stands for invalid rays and those that pass the root by.
    pub const NEVER: Self = Self { origin: [0.0; 3], t_min: 0.0, direction: [1.0; 3], t_max: 0.0 };

    /// Of a canonical ray, with finite limits.
    pub fn new(ray: &CanonicalRay) -> Self {
        let limit = |t: f32| t.clamp(-FARTHEST, FARTHEST);
        Self { origin: ray.origin, t_min: limit(ray.t_min), direction: ray.direction, t_max: limit(ray.t_max) }
    }
}

/// A hit in units of t', 16 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct DeviceHit {
    /// Distance t'; of a miss, the ray's limit.
    pub t: f32,
    /// Weight of vertex 1.
    pub u: f32,
    /// Weight of vertex 2.
    pub v: f32,
    /// The triangle, or `u32::MAX`.
    pub primitive: u32,
}

/// A hit and what it took, 32 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct DeviceAnswer {
    /// As a plain closest hit.
    pub hit: DeviceHit,
    /// Leaves visited, empty ones included.
    pub cells: u32,
    /// Blocks tested.
    pub blocks: u32,
    /// Zero.
    pub unused_0: u32,
    /// Zero.
    pub unused_1: u32,
}

impl DeviceHit {
    /// The hit in the caller's units.
    pub fn reported(&self, clock: &Clock) -> Hit {
        if self.primitive == Hit::MISS.primitive {
            Hit::MISS
        } else {
            Hit { t: clock.reported(self.t), u: self.u, v: self.v, primitive: self.primitive }
        }
    }
}
