//! On which side the ray passes each edge.

use glam::Vec3;
use leafwalk_core::CanonicalRay;

use super::{InCallersUnits, Meeting, TriangleTest, edges};

/// Compares the ray with each edge by their Plücker coordinates (J. Erickson, "Plücker Coordinates", Ray Tracing News
/// 10(3), 1997; J. Amanatides and K. Choi, "Ray Tracing Triangular Meshes", Western Computer Graphics Symposium, 1997).
///
/// ```text
/// line through p and q:   (q - p, p x q)
/// two lines:              side = d1 . m2 + d2 . m1       6 times the volume between them; its sign says how they turn
/// hit:                    the sides of all three edges have one sign; they are the weights of the corners opposite
/// ```
///
/// Two triangles see an edge with all signs changed and nothing else, so that no ray passes between them at an edge. At a
/// corner, the edges' sides round apart, and a ray may pass by all. Moments count from 0: far from there they cancel.
#[derive(Clone, Copy, Debug)]
pub struct Plucker;

/// A line by its Plücker coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Coordinates {
    direction: Vec3,
    moment: Vec3,
}

impl Coordinates {
    fn through(p: Vec3, q: Vec3) -> Self {
        Self { direction: q - p, moment: p.cross(q) }
    }

    /// How this line passes another; 0 where they meet.
    #[inline]
    fn side(&self, other: &Self) -> f32 {
        self.direction.dot(other.moment) + other.direction.dot(self.moment)
    }
}

/// The edges by the corners that lie opposite, and the plane.
#[derive(Clone, Copy, Debug)]
pub struct Sides {
    opposite: [Coordinates; 3],
    corner: Vec3,
    normal: Vec3,
}

impl TriangleTest for Plucker {
    type Triangle = Sides;
    /// The ray's coordinates, and its origin.
    type Ray = (Coordinates, Vec3);

    fn triangle(corners: &[[f32; 3]; 3]) -> Sides {
        let [a, b, c] = corners.map(Vec3::from);
        let opposite = [(b, c), (c, a), (a, b)].map(|(p, q)| Coordinates::through(p, q));
        let [to_b, to_c] = edges([a, b, c]);
        Sides { opposite, corner: a, normal: to_b.cross(to_c) }
    }

    fn ray(ray: &CanonicalRay) -> Self::Ray {
        let (origin, direction) = (Vec3::from(ray.origin), Vec3::from(ray.direction));
        (Coordinates { direction, moment: origin.cross(direction) }, origin)
    }

    #[inline]
    fn meet((line, origin): &Self::Ray, triangle: &Sides) -> Option<Meeting> {
        let [a, b, c] = triangle.opposite.each_ref().map(|edge| line.side(edge));
        let is_hit = (a >= 0.0 && b >= 0.0 && c >= 0.0) || (a <= 0.0 && b <= 0.0 && c <= 0.0);
        let volume = (a + b) + c;
        // Of nothing, and of what is too large for a number, there are no shares.
        if !is_hit || volume == 0.0 || volume.is_infinite() {
            return None;
        }
        let t = triangle.normal.dot(triangle.corner - *origin) / triangle.normal.dot(line.direction);
        Some(Meeting { t, u: b / volume, v: c / volume })
    }
}

impl InCallersUnits for Plucker {}
