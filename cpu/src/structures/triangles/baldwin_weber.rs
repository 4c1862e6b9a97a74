//! A transform a triangle.

use glam::Vec3;
use leafwalk_core::CanonicalRay;

use super::{InCallersUnits, Meeting, TriangleTest, Unprepared, edges, inside, longest_axis};

/// Brings the ray into coordinates in which the triangle is (0, 0), (1, 0), (0, 1) (D. Baldwin and M. Weber, "Fast
/// Ray-Triangle Intersections by Coordinate Transformation", Journal of Computer Graphics Techniques 5(3), 2016).
///
/// ```text
/// f        = the axis along which the normal n is longest
/// p        = u (b - a) + v (c - a) + w f + a      solved for (u, v, w) once a triangle
/// t        = -w(o) / w(d)
/// (u, v)   of o + t d
/// ```
///
/// With an axis for f, a third of the transform is 0 or 1. It is kept whole: 48 bytes, and the same steps for every
/// triangle. Its numbers are rounded for each triangle by itself, so that a ray may pass between two.
#[derive(Clone, Copy, Debug)]
pub struct BaldwinWeber;

/// How u, v and w are had from a point: `row . point + constant`.
#[derive(Clone, Copy, Debug)]
pub struct Transform {
    rows: [Vec3; 3],
    constants: [f32; 3],
}

impl TriangleTest for BaldwinWeber {
    type Triangle = Transform;
    type Ray = Unprepared;

    fn triangle(corners: &[[f32; 3]; 3]) -> Transform {
        let corners = corners.map(Vec3::from);
        let [to_b, to_c] = edges(corners);
        let normal = to_b.cross(to_c);
        let axis = longest_axis(normal);
        let free = Vec3::AXES[axis];
        // The determinant of the matrix that is inverted; that of a triangle without a normal leaves rows of NaN.
        let determinant = normal[axis];
        let rows = [to_c.cross(free), free.cross(to_b), normal].map(|row| row / determinant);
        Transform { rows, constants: rows.map(|row| -row.dot(corners[0])) }
    }

    fn ray(ray: &CanonicalRay) -> Unprepared {
        ray.into()
    }

    #[inline]
    fn meet(ray: &Unprepared, triangle: &Transform) -> Option<Meeting> {
        let Transform { rows: [to_u, to_v, to_w], constants: [at_u, at_v, at_w] } = *triangle;
        let t = -(to_w.dot(ray.origin) + at_w) / to_w.dot(ray.direction);
        let point = ray.origin + t * ray.direction;
        inside(t, to_u.dot(point) + at_u, to_v.dot(point) + at_v)
    }
}

impl InCallersUnits for BaldwinWeber {}
