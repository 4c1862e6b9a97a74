//! The plane first, then the triangle's shadow on two axes.

use glam::{Vec2, Vec3};
use leafwalk_core::CanonicalRay;

use super::{InCallersUnits, Meeting, TriangleTest, Unprepared, edges, inside, longest_axis};

/// Meets the plane, drops the axis along which its normal is longest, and weighs the point in the two that are left
/// (D. Badouel, "An Efficient Ray-Polygon Intersection", Graphics Gems, 1990). What courses teach.
///
/// ```text
/// t      = (n . a - n . o) / (n . d)
/// p      = (o + t d) - a, without the dropped axis
/// (u, v) = p in the base of the two edges, by Cramer's rule
/// ```
///
/// The point carries the rounding of t, and each triangle computes one of its own.
#[derive(Clone, Copy, Debug)]
pub struct Projected;

/// A plane, and what the triangle is on it.
#[derive(Clone, Copy, Debug)]
pub struct Shadow {
    normal: Vec3,
    /// normal . corner 0
    offset: f32,
    /// The axes that are kept.
    axes: [usize; 2],
    /// Corner 0.
    corner: Vec2,
    /// The edges from there to corners 1 and 2.
    edges: [Vec2; 2],
}

impl TriangleTest for Projected {
    type Triangle = Shadow;
    type Ray = Unprepared;

    fn triangle(corners: &[[f32; 3]; 3]) -> Shadow {
        let corners = corners.map(Vec3::from);
        let [to_b, to_c] = edges(corners);
        let normal = to_b.cross(to_c);
        let dropped = longest_axis(normal);
        let axes = [(dropped + 1) % 3, (dropped + 2) % 3];
        let shadow = |point: Vec3| Vec2::new(point[axes[0]], point[axes[1]]);
        let offset = normal.dot(corners[0]);
        Shadow { normal, offset, axes, corner: shadow(corners[0]), edges: [shadow(to_b), shadow(to_c)] }
    }

    fn ray(ray: &CanonicalRay) -> Unprepared {
        ray.into()
    }

    #[inline]
    fn meet(ray: &Unprepared, triangle: &Shadow) -> Option<Meeting> {
        let Shadow { normal, offset, axes: [i, j], corner, edges: [to_b, to_c] } = *triangle;
        let t = (offset - normal.dot(ray.origin)) / normal.dot(ray.direction);
        let point = ray.origin + t * ray.direction;
        let from_corner = Vec2::new(point[i], point[j]) - corner;
        let area = to_b.perp_dot(to_c);
        inside(t, from_corner.perp_dot(to_c) / area, to_b.perp_dot(from_corner) / area)
    }
}

impl InCallersUnits for Projected {}
