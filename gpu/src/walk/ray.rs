//! Rays, hits and answers as the shaders have them in their buffers.

use bytemuck::{Pod, Zeroable};
use leafwalk_core::{CanonicalRay, Clock, Frame, Hit, Ray, weight_of_vertex_2};

/// Limits of t' beyond this are brought here, since shaders know no infinity.
///
/// A hit's t' is an average of three distances along the main axis (at most two root edges, as origins are within one of
/// the root) over a direction component of at least 1, so its magnitude stays under four edges, 2^18: no hit is lost or
/// won, no walk differs.
const FARTHEST: f32 = (1u64 << 36) as f32;

/// A ray as the shaders have it, on the lattice: the struct `CanonicalRay` of the WGSL text, 32 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct DeviceRay {
    /// Where t' is 0, in lattice coordinates.
    pub origin: [f32; 3],
    /// Hits count for t' strictly above it. Finite.
    pub t_min: f32,
    /// The direction; its largest component lies in 1..2.
    pub direction: [f32; 3],
    /// Hits count for t' strictly below it. Finite.
    pub t_max: f32,
}

impl DeviceRay {
    /// A ray that ends where it starts, and so misses: it stands for rays that are invalid or miss the root cube.
    pub const NEVER: Self = Self { origin: [0.0; 3], t_min: 0.0, direction: [1.0; 3], t_max: 0.0 };

    /// A ray in the caller's units, as the shaders trace it in an octree of this frame.
    pub fn new(frame: &Frame, ray: &Ray) -> Self {
        frame.canonical(ray).map_or(Self::NEVER, |ray| Self::of_canonical(&ray))
    }

    fn of_canonical(ray: &CanonicalRay) -> Self {
        let limit = |t: f32| t.clamp(-FARTHEST, FARTHEST);
        Self { origin: ray.origin, t_min: limit(ray.t_min), direction: ray.direction, t_max: limit(ray.t_max) }
    }
}

/// The clock of rays that miss, which nobody reads.
pub(crate) const NO_CLOCK: Clock = Clock { entry: 0.0, unit: 1.0 };

/// Rays as the device traces them, and the clocks that turn their t' into the caller's t.
pub(crate) fn canonical(frame: &Frame, rays: &[Ray]) -> (Vec<DeviceRay>, Vec<Clock>) {
    let canonical = rays.iter().map(|ray| frame.canonical(ray));
    canonical
        .map(|ray| ray.map_or((DeviceRay::NEVER, NO_CLOCK), |ray| (DeviceRay::of_canonical(&ray), ray.clock)))
        .unzip()
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
    /// The triangle, or `u32::MAX` for a miss.
    pub primitive: u32,
}

impl DeviceHit {
    /// The hit in the caller's units.
    pub(crate) fn reported(&self, clock: &Clock) -> Hit {
        if self.primitive == Hit::MISS.primitive {
            Hit::MISS
        } else {
            let v = weight_of_vertex_2(self.u, self.v);
            Hit { t: clock.reported(self.t), u: self.u, v, primitive: self.primitive }
        }
    }
}

/// A hit and the work of its walk, 32 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct DeviceAnswer {
    /// The closest hit.
    pub hit: DeviceHit,
    /// Leaves visited, empty ones included.
    pub cells: u32,
    /// Blocks tested.
    pub blocks: u32,
    /// Always 0.
    pub unused_0: u32,
    /// Always 0.
    pub unused_1: u32,
}
