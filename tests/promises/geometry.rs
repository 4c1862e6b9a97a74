//! Triangles in f64: what f32 is judged by.

use glam::DVec3;
use leafwalk::Mesh;

pub(crate) fn point(p: [f32; 3]) -> DVec3 {
    DVec3::from_array(p.map(f64::from))
}

pub(crate) fn corners(mesh: &Mesh, primitive: usize) -> [DVec3; 3] {
    mesh.corners(primitive).map(point)
}

/// The angle, over 4 pi, under which a triangle is seen from a point: signed (Van Oosterom & Strackee 1983). Summed
/// over a closed mesh it is the number of times that the mesh goes around the point.
pub(crate) fn winding(corners: &[DVec3; 3], from: DVec3) -> f64 {
    let [a, b, c] = corners.map(|corner| corner - from);
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let numerator = a.dot(b.cross(c));
    let denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    numerator.atan2(denominator) / (2.0 * core::f64::consts::PI)
}

/// Distance of a point to a segment.
pub(crate) fn distance_to_segment([a, b]: [DVec3; 2], p: DVec3) -> f64 {
    let along = b - a;
    let w = if along == DVec3::ZERO { 0.0 } else { ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0) };
    p.distance(a + w * along)
}

/// Distance of a point to a triangle, which may be a segment or a point.
pub(crate) fn distance_to_triangle(corners: &[DVec3; 3], p: DVec3) -> f64 {
    let [a, b, c] = *corners;
    let edges = [[a, b], [b, c], [c, a]];
    let normal = (b - a).cross(c - a);
    let is_over = normal != DVec3::ZERO && edges.iter().all(|[a, b]| normal.cross(*b - *a).dot(p - *a) >= 0.0);
    if is_over {
        return normal.normalize().dot(p - a).abs();
    }
    edges.iter().map(|edge| distance_to_segment(*edge, p)).fold(f64::INFINITY, f64::min)
}
