//! Rays that leave a hit, until the library makes them.

use glam::DVec3;
use leafwalk::{Frame, Hit, Ray};

/// How far off a triangle a ray starts, as a share of the root's edge and of the largest coordinate.
const LIFT: f64 = 64.0 / (1 << 24) as f64;

pub(crate) trait Spawn {
    /// A ray that leaves a hit on the side of its triangle to which `direction` points.
    fn spawn(&self, frame: &Frame, corners: &[[f32; 3]; 3], direction: [f32; 3]) -> Ray;
}

impl Spawn for Hit {
    fn spawn(&self, frame: &Frame, corners: &[[f32; 3]; 3], direction: [f32; 3]) -> Ray {
        let [a, b, c] = corners.map(|corner| DVec3::from(corner.map(f64::from)));
        let point = a + (b - a) * f64::from(self.u) + (c - a) * f64::from(self.v);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let side = normal.dot(DVec3::from(direction.map(f64::from))).signum();
        let lift = side * LIFT * (frame.scale() + point.abs().max_element());
        Ray::new((point + normal * lift).as_vec3(), direction)
    }
}
