//! The plane of a triangle in the caller's units: its normal, its two sides, and the point of a hit on it.
//!
//! All of it is computed in f64, which is exact for differences of most f32 coordinates. The core has neither glam nor
//! a square root from the standard library.

use crate::ray::Hit;

/// The unit normal of a triangle, on the side from which its corners stand counter-clockwise: its *front*. It is zero
/// for a triangle without area.
///
/// ```
/// # use leafwalk_core::geometric_normal;
/// assert_eq!(geometric_normal(&[[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]]), [0.0, 0.0, 1.0]);
/// ```
pub fn geometric_normal<S: Copy + Into<f64>>(corners: &[[S; 3]; 3]) -> [f32; 3] {
    unit(normal(corners)).map_or([0.0; 3], |normal| normal.map(|c| c as f32))
}

impl Hit {
    /// The point that was hit, of the triangle with these corners.
    ///
    /// It is made of the weights, not of `t`, so that it lies in the triangle's plane however far away the ray began.
    pub fn position<S: Copy + Into<f64>>(&self, corners: &[[S; 3]; 3]) -> [f64; 3] {
        let [a, ab, ac] = from_first_corner(corners);
        core::array::from_fn(|k| a[k] + (ab[k] * f64::from(self.u) + ac[k] * f64::from(self.v)))
    }

    /// Whether a ray of this direction meets the triangle with these corners from its front, from which the corners
    /// stand counter-clockwise. Edge-on counts as the front.
    pub fn front<S: Copy + Into<f64>>(corners: &[[S; 3]; 3], direction: [f32; 3]) -> bool {
        dot(normal(corners), direction.map(f64::from)) <= 0.0
    }
}

/// The first corner, and the edges that lead from it to the second and to the third.
pub(crate) fn from_first_corner<S: Copy + Into<f64>>(corners: &[[S; 3]; 3]) -> [[f64; 3]; 3] {
    let [a, b, c] = corners.map(|corner| corner.map(Into::into));
    [a, difference(b, a), difference(c, a)]
}

/// The normal on the front, twice as long as the area is large.
pub(crate) fn normal<S: Copy + Into<f64>>(corners: &[[S; 3]; 3]) -> [f64; 3] {
    let [_, ab, ac] = from_first_corner(corners);
    cross(ab, ac)
}

pub(crate) fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    core::array::from_fn(|k| a[k] - b[k])
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The vector of length 1 in the same direction; `None` for zero.
///
/// Where a triangle's corners are numbers of f32, its edges are 0 or 2^-149 to 2^130 long, and its normal 0 or 2^-298 to
/// 2^260: their squares neither overflow nor vanish in f64. Where they are of f64, triangles under 2^-256 in size count as
/// having no area.
pub(crate) fn unit(vector: [f64; 3]) -> Option<[f64; 3]> {
    let squared = dot(vector, vector);
    (squared >= f64::MIN_POSITIVE).then(|| {
        let length = square_root(squared);
        vector.map(|c| c / length)
    })
}

/// The square root of a positive normal number, to a unit in the last place or two.
fn square_root(x: f64) -> f64 {
    // Half of the exponent, and a fraction that is off by 6.1 % at most: one half of 1.5 instead of the root of 2.
    let mut root = f64::from_bits((x.to_bits() >> 1) + (1023 << 51));
    // Newton's method turns a relative error e into e^2 / 2: after four steps only rounding is left.
    for _ in 0..4 {
        root = 0.5 * (root + x / root);
    }
    root
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn square_roots_are_right_to_two_units_in_the_last_place() {
        for exponent in -300..300 {
            for fraction in [1.0, 1.25, 1.5, 1.999_999, core::f64::consts::SQRT_2] {
                let root = fraction * f64::from_bits(((1023 + exponent) as u64) << 52);
                let found = square_root(root * root);
                assert!((found - root).abs() <= 2.0 * f64::EPSILON * root, "{found} for {root}");
            }
        }
    }

    #[test]
    fn normals_have_length_one_at_all_scales() {
        for size in [f32::MIN_POSITIVE * f32::EPSILON, 1e-30, 1.0, 1e30, f32::MAX] {
            let corners = [[0.0; 3], [size, 0.0, 0.0], [0.0, size, 0.0]];
            assert_eq!(geometric_normal(&corners), [0.0, 0.0, 1.0], "at the size {size}");
            let [a, b, c] = corners;
            assert_eq!(geometric_normal(&[a, c, b]), [0.0, 0.0, -1.0], "at the size {size}");
            assert!(Hit::front(&corners, [0.0, 0.0, -1.0]) && !Hit::front(&corners, [0.0, 0.0, 1.0]));
        }
        assert_eq!(geometric_normal(&[[0.0; 3], [1.0; 3], [2.0; 3]]), [0.0; 3]);
    }

    #[test]
    fn positions_weigh_the_corners() {
        let corners = [[1.0, 1.0, 1.0], [3.0, 1.0, 1.0], [1.0, 5.0, 2.0]];
        let hit = Hit { t: 1.0, u: 0.25, v: 0.5, primitive: 0 };
        assert_eq!(hit.position(&corners), [1.5, 3.0, 1.5]);
    }
}
