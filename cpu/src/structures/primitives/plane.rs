//! A ray and a plane.

use glam::Vec3;

/// Where a line meets the plane `normal . p + offset = 0`, as textbooks have it; nowhere if it runs along the plane.
///
/// Far from 0, `normal . origin` and the offset are large and nearly cancel, and the offset itself carries the rounding of
/// numbers as large: t is off by about a roundoff of the distance from 0, however near the plane is.
pub fn naive(origin: Vec3, direction: Vec3, normal: Vec3, offset: f32) -> Option<f32> {
    divided(-(normal.dot(origin) + offset), normal.dot(direction))
}

/// Where a line meets the plane through a point; nowhere if it runs along the plane.
///
/// The nearer the point is to where the line starts, the less is rounded: between numbers of like size a difference is
/// exact (P. H. Sterbenz, "Floating-Point Computation", 1974), and what is left is as large as t.
pub fn stable(origin: Vec3, direction: Vec3, normal: Vec3, point: Vec3) -> Option<f32> {
    divided(normal.dot(point - origin), normal.dot(direction))
}

fn divided(height: f32, descent: f32) -> Option<f32> {
    let t = height / descent;
    t.is_finite().then_some(t)
}
