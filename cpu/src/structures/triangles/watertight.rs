//! The watertight test as it was published.

use leafwalk_core::CanonicalRay;
use leafwalk_core::triangle::permutation;

use super::{InCallersUnits, Meeting, TriangleTest};

/// Shears space so that the ray is an axis, and compares the corners in two dimensions (S. Woop, C. Benthin and I. Wald,
/// "Watertight Ray/Triangle Intersection", Journal of Computer Graphics Techniques 2(1), 2013).
///
/// ```text
/// z       = the axis along which d is longest
/// a, b, c = corners - o, each sheared by (x - d_x / d_z * z, y - d_y / d_z * z, z / d_z)
/// U       = c_x b_y - c_y b_x, and so on round            in f64 if one of the three is 0
/// hit:      U, V, W have one sign                         their shares of the sum are the weights
/// ```
///
/// A corner is sheared alike for all triangles that share it, and a difference of two rounded products never has the
/// wrong sign, so that no ray passes between triangles. What [`super::Exact`] adds: weights that do not cancel, on
/// needles, and rays in a triangle's plane.
#[derive(Clone, Copy, Debug)]
pub struct Watertight;

/// A ray's shear.
#[derive(Clone, Copy, Debug)]
pub struct Shear {
    origin: [f32; 3],
    /// The longest last. It is not reversed for rays that go down it: both signs count as a hit.
    axes: [usize; 3],
    /// `d_x / d_z`, `d_y / d_z` and `1 / d_z`.
    slope: [f32; 3],
}

impl TriangleTest for Watertight {
    type Triangle = [[f32; 3]; 3];
    type Ray = Shear;

    fn triangle(corners: &[[f32; 3]; 3]) -> Self::Triangle {
        *corners
    }

    fn ray(ray: &CanonicalRay) -> Shear {
        let axes @ [x, y, z] = permutation(ray.direction);
        let d = ray.direction;
        Shear { origin: ray.origin, axes, slope: [d[x] / d[z], d[y] / d[z], 1.0 / d[z]] }
    }

    #[inline]
    fn meet(ray: &Shear, corners: &Self::Triangle) -> Option<Meeting> {
        let [a, b, c] = corners.each_ref().map(|corner| {
            let [x, y, z] = ray.axes.map(|k| corner[k] - ray.origin[k]);
            [x - ray.slope[0] * z, y - ray.slope[1] * z, ray.slope[2] * z]
        });
        let mut weights = [cross(c, b), cross(a, c), cross(b, a)];
        if weights.contains(&0.0) {
            weights = [exact_cross(c, b), exact_cross(a, c), exact_cross(b, a)];
        }
        let sum = (weights[0] + weights[1]) + weights[2];
        let is_outside = weights.iter().any(|w| *w < 0.0) && weights.iter().any(|w| *w > 0.0);
        if is_outside || sum == 0.0 {
            return None;
        }
        let inverse = 1.0 / sum;
        let t = ((weights[0] * a[2] + weights[1] * b[2]) + weights[2] * c[2]) * inverse;
        Some(Meeting { t, u: weights[1] * inverse, v: weights[2] * inverse })
    }
}

/// Twice the area that two sheared corners span with the ray.
#[inline]
fn cross(p: [f32; 3], q: [f32; 3]) -> f32 {
    p[0] * q[1] - p[1] * q[0]
}

/// The same without an error but that of the last rounding: in f64, products of numbers of f32 are exact.
#[inline]
fn exact_cross(p: [f32; 3], q: [f32; 3]) -> f32 {
    let [px, py, qx, qy] = [p[0], p[1], q[0], q[1]].map(f64::from);
    (px * qy - py * qx) as f32
}

impl InCallersUnits for Watertight {}
