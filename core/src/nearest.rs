//! The hit that counts among all that a tracer finds, in whatever order.

use crate::ray::{CanonicalRay, Clock, Hit};

/// The nearest hit so far: smallest t', then smallest primitive; or the ray's own limit.
#[derive(Clone, Copy, Debug)]
pub struct Nearest {
    /// Hits count for t' strictly above it.
    pub t_min: f32,
    /// t' of the hit, or of the ray's end.
    pub t: f32,
    /// Weight of vertex 1.
    pub u: f32,
    /// Weight of vertex 2.
    pub v: f32,
    /// The triangle, or `u32::MAX`.
    pub primitive: u32,
}

impl Nearest {
    /// Nothing yet.
    #[inline(always)]
    pub fn new(ray: &CanonicalRay) -> Self {
        Self { t_min: ray.t_min, t: ray.t_max, u: 0.0, v: 0.0, primitive: u32::MAX }
    }

    /// Whether anything was hit.
    #[inline(always)]
    pub fn is_hit(&self) -> bool {
        self.primitive != u32::MAX
    }

    /// Takes a hit that is nearer. At the ray's own limit none is.
    #[inline(always)]
    pub fn offer(&mut self, t: f32, u: f32, v: f32, primitive: u32) {
        let is_tie_won = t == self.t && primitive < self.primitive && self.is_hit();
        if t > self.t_min && (t < self.t || is_tie_won) {
            *self = Self { t, u, v, primitive, ..*self };
        }
    }

    /// The hit in the caller's units, or [`Hit::MISS`].
    #[inline]
    pub fn hit(&self, clock: &Clock) -> Hit {
        if self.is_hit() {
            Hit { t: clock.reported(self.t), u: self.u, v: self.v, primitive: self.primitive }
        } else {
            Hit::MISS
        }
    }
}
