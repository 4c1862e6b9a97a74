//! `Plane`: what divides the triangles of a node.

use glam::{DVec3, Vec3};

use crate::structures::bounds::Bounds;
use crate::structures::line::Line;

/// Half the thickness of a plane, as a share of the largest coordinate: triangles within it count as lying in the plane.
///
/// The triangle that a plane was made of must: its corners are off by the rounding of the normal, a roundoff of each
/// component, which makes up to √3 roundoffs of the distance between corners, or 3 of the coordinates; and of the offset, 2
/// more. Neighbours in one plane round their normals on their own, which is a few times that where they are not needles.
const THICKNESS: f32 = 16.0 * leafwalk_core::contract::ROUNDOFF;

/// How far a line may seem off a plane that it is not, as a share of the margin, which is 120 roundoffs of the root's edge E.
///
/// A line reaches the root from within E of it, so that its origin is within 2 √3 E of the root's corner, and also of every
/// point of the root. In roundoffs of E: the product of normal and origin is off by 3 · 2 √3 = 10.4, the difference to the
/// offset by 2 √3 + √3 = 5.2; the product of normal and direction by 3 of what it is at most, and so its multiple by 3 · 2 √3 =
/// 10.4; and the subtraction and the division that give t by 2 · 2 √3 = 7. That is 33 of 120.
const PLANE_TEST: f32 = 0.5;

/// The points p for which `normal · p` is `offset`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    normal: Vec3,
    offset: f32,
}

/// Where a triangle lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Behind,
    Before,
    Within,
    Both,
}

impl Plane {
    /// The plane through a point, if there is a normal.
    pub(super) fn through(point: Vec3, normal: DVec3) -> Option<Self> {
        let normal = normal.try_normalize()?.as_vec3();
        let offset = normal.as_dvec3().dot(point.as_dvec3()) as f32;
        (normal.is_finite() && offset.is_finite()).then_some(Self { normal, offset })
    }

    /// On which side a triangle lies, if planes have a thickness.
    pub(super) fn side_of(&self, corners: &[Vec3; 3], thickness: f32) -> Side {
        let thickness = f64::from(thickness);
        let heights = corners.map(|corner| self.height(corner.as_dvec3()));
        match (heights.iter().any(|h| *h < -thickness), heights.iter().any(|h| *h > thickness)) {
            (true, true) => Side::Both,
            (true, false) => Side::Behind,
            (false, true) => Side::Before,
            (false, false) => Side::Within,
        }
    }

    /// How far before the plane a point lies, or behind it if it is negative.
    pub(super) fn height(&self, point: DVec3) -> f64 {
        self.normal.as_dvec3().dot(point) - f64::from(self.offset)
    }

    /// Brings the corners of a convex polygon in the plane in turn, anticlockwise as seen from before the plane.
    pub(super) fn sort_around(&self, points: &mut [DVec3]) {
        let middle = points.iter().sum::<DVec3>() / points.len() as f64;
        let (x, y) = self.normal.as_dvec3().any_orthonormal_pair();
        let turn = |point: &DVec3| f64::atan2((*point - middle).dot(y), (*point - middle).dot(x));
        points.sort_by(|a, b| turn(a).total_cmp(&turn(b)));
    }

    /// Cuts a line where it comes within `reach` of the plane, and where it leaves that: whether it goes backwards, so that
    /// what is before the plane is near; where the far side begins; and where the near side ends.
    ///
    /// Along the plane the numbers are infinite, with the signs that keep both parts or leave the right one out; what is no
    /// number is left to `min` and `max`, which pass over it, so that both parts are kept.
    #[inline]
    pub(super) fn cut(&self, line: &Line, reach: f32) -> (bool, f32, f32) {
        let height = self.normal.dot(line.origin) - self.offset;
        let slope = self.normal.dot(line.direction);
        let is_backwards = slope.is_sign_negative();
        let [below, above] = [(-reach - height) / slope, (reach - height) / slope];
        if is_backwards { (true, above, below) } else { (false, below, above) }
    }
}

/// Half the thickness of the planes of a scene, and how far beyond a plane lines are followed: its thickness, the margin, and
/// the error of the cut. The thickness is there without a margin as well: what lies in it is in the node's own list, and is as
/// much a part of the structure.
pub(super) fn thickness_and_reach(bounds: &Bounds, margin: f32) -> (f32, f32) {
    let largest = bounds.lower.abs().max(bounds.upper.abs()).max_element();
    let thickness = THICKNESS * largest;
    (thickness, thickness + margin * (1.0 + PLANE_TEST))
}
