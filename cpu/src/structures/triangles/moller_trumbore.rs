//! The test that most tracers have.

use glam::Vec3;
use leafwalk_core::CanonicalRay;

use super::{InCallersUnits, Meeting, TriangleTest, Unprepared, edges, inside};

/// Solves `o + t d = a + u (b - a) + v (c - a)` by Cramer's rule (T. Möller and B. Trumbore, "Fast, Minimum Storage
/// Ray/Triangle Intersection", Journal of Graphics Tools 2(1), 1997), as it is, or with a tolerance of 1e-6.
///
/// ```text
/// p = d x (c - a)    det = (b - a) . p
/// q = (o - a) x (b - a)
/// (t, u, v) = ((c - a) . q, (o - a) . p, d . q) / det
/// ```
///
/// Two triangles round the same edge differently, so that a ray may pass between them.
#[derive(Clone, Copy, Debug)]
pub struct MollerTrumbore<const TOLERANT: bool>;

/// How far weights may lie outside of 0..=1, and what determinant counts as none.
///
/// A custom, not a bound: the article has it for the determinant, programs that use it for the weights too. The determinant
/// grows with the square of the triangle's size, so that whole small triangles go lost.
const TOLERANCE: f32 = 1e-6;

/// A corner, and the edges from there.
#[derive(Clone, Copy, Debug)]
pub struct Edges {
    corner: Vec3,
    edges: [Vec3; 2],
}

impl<const TOLERANT: bool> TriangleTest for MollerTrumbore<TOLERANT> {
    type Triangle = Edges;
    type Ray = Unprepared;

    fn triangle(corners: &[[f32; 3]; 3]) -> Edges {
        let corners = corners.map(Vec3::from);
        Edges { corner: corners[0], edges: edges(corners) }
    }

    fn ray(ray: &CanonicalRay) -> Unprepared {
        ray.into()
    }

    #[inline]
    fn meet(ray: &Unprepared, triangle: &Edges) -> Option<Meeting> {
        let Edges { corner, edges: [to_b, to_c] } = *triangle;
        let p = ray.direction.cross(to_c);
        let determinant = to_b.dot(p);
        let from_corner = ray.origin - corner;
        let q = from_corner.cross(to_b);
        let inverse = 1.0 / determinant;
        let (t, u, v) = (to_c.dot(q) * inverse, from_corner.dot(p) * inverse, ray.direction.dot(q) * inverse);
        match TOLERANT {
            // Where the determinant is 0, the weights are infinite or NaN.
            false => inside(t, u, v),
            true => {
                let is_inside = u >= -TOLERANCE && v >= -TOLERANCE && u + v <= 1.0 + TOLERANCE;
                (determinant.abs() >= TOLERANCE && is_inside).then_some(Meeting { t, u, v })
            }
        }
    }
}

impl<const TOLERANT: bool> InCallersUnits for MollerTrumbore<TOLERANT> {}
