//! The watertight ray/triangle test of Woop, Benthin & Wald (JCGT 2(1), 2013), with an exact finish, for any lanes.
//!
//! Corners come permuted: axis 2 is the one along which the ray's direction is largest. A loader picks arrays in that
//! order for nothing, so the test itself never moves data.

use crate::lanes::{Lanes, Mask};
use crate::layout::{SMALLEST, SMALLEST_SHEARED};
use crate::ray::CanonicalRay;

/// The ray's part of the test: everything that does not depend on the triangle.
#[derive(Clone, Copy, Debug)]
pub struct Shear<L> {
    /// Permuted.
    pub origin: [L; 3],
    /// `d_x / d_z`, `d_y / d_z` and `1 / d_z` in permuted axes.
    pub slope: [L; 3],
}

/// The axes in the order of a ray's permutation: the one of its largest direction component last.
pub fn permutation(direction: [f32; 3]) -> [usize; 3] {
    let [x, y, z] = direction.map(f32::abs);
    if x >= y && x >= z {
        [1, 2, 0]
    } else if y >= z {
        [2, 0, 1]
    } else {
        [0, 1, 2]
    }
}

impl<L: Lanes> Shear<L> {
    /// One ray in every lane, with its permutation.
    pub fn new(ray: &CanonicalRay) -> (Self, [usize; 3]) {
        let axes = permutation(ray.direction);
        let [x, y, z] = axes.map(|k| ray.direction[k]);
        let slope = [x / z, y / z, 1.0 / z].map(L::splat);
        (Self { origin: axes.map(|k| L::splat(ray.origin[k])), slope }, axes)
    }
}

/// Sheared corners: the ray is the z axis.
#[derive(Clone, Copy, Debug)]
pub struct Sheared<L> {
    x: [L; 3],
    y: [L; 3],
    z: [L; 3],
}

/// Distance t' and the weights of vertices 1 and 2.
#[derive(Clone, Copy, Debug)]
pub struct Candidate<L> {
    /// Distance along the canonical ray.
    pub t: L,
    /// Weight of vertex 1.
    pub u: L,
    /// Weight of vertex 2.
    pub v: L,
}

impl<L: Lanes> Sheared<L> {
    /// Shears permuted corners.
    #[inline(always)]
    pub fn new(shear: &Shear<L>, corners: [[L; 3]; 3]) -> Self {
        let from_origin = corners.map(|c| [c[0] - shear.origin[0], c[1] - shear.origin[1], c[2] - shear.origin[2]]);
        Self {
            x: from_origin.map(|c| (c[0] - shear.slope[0] * c[2]).flush(SMALLEST_SHEARED)),
            y: from_origin.map(|c| (c[1] - shear.slope[1] * c[2]).flush(SMALLEST_SHEARED)),
            z: from_origin.map(|c| c[2]),
        }
    }

    /// Which lanes may hold a hit: rounding is monotone, so a comparison of two products is right or a tie, and no
    /// triangle that the exact signs accept is lost.
    #[inline(always)]
    pub fn is_candidate(&self) -> L::Mask {
        let ([ax, bx, cx], [ay, by, cy]) = (self.x, self.y);
        let (u1, u2, v1, v2, w1, w2) = (cx * by, cy * bx, ax * cy, ay * cx, bx * ay, by * ax);
        let not_negative = u2.at_most(u1) & v2.at_most(v1) & w2.at_most(w1);
        let not_positive = u1.at_most(u2) & v1.at_most(v2) & w1.at_most(w2);
        not_negative | not_positive
    }

    /// Decides the candidates exactly, for the corners as rounded by the shear, and gives their distance and weights.
    ///
    /// Without the exact finish a needle or a ray in the plane is hit far from the triangle
    /// (ARCHITECTURE.md, "Triangle test").
    #[inline(always)]
    pub fn finish(&self, shear: &Shear<L>) -> (L::Mask, Candidate<L>) {
        let ([ax, bx, cx], [ay, by, cy]) = (self.x, self.y);
        let u = difference_of_products(cx, by, cy, bx);
        let v = difference_of_products(ax, cy, ay, cx);
        let w = difference_of_products(bx, ay, by, ax);
        let zero = L::splat(0.0);
        let negative = u.less(zero) | v.less(zero) | w.less(zero);
        let positive = zero.less(u) | zero.less(v) | zero.less(w);
        let accepted = (negative | positive) & !(negative & positive);

        let sum = (u + v) + w;
        let (v, w) = (v / sum, w / sum);
        let [az, bz, cz] = self.z.map(|z| shear.slope[2] * z);
        let t = az + (v * (bz - az) + w * (cz - az));
        (accepted, Candidate { t: t.flush(SMALLEST), u: v.flush(SMALLEST), v: w.flush(SMALLEST) })
    }
}

/// `a * b - c * d` with a sign that is exact and an error of at most 2 roundoffs (Cornea, Harrison & Tang 2002).
#[inline(always)]
fn difference_of_products<L: Lanes>(a: L, b: L, c: L, d: L) -> L {
    let (p, q) = (a * b, c * d);
    (p - q) + (a.product_error(b, p) - c.product_error(d, q))
}

/// Permuted corners in, a hit out: the whole test, for callers without a candidate stage of their own.
#[inline(always)]
pub fn intersect<L: Lanes>(shear: &Shear<L>, corners: [[L; 3]; 3]) -> (L::Mask, Candidate<L>) {
    let sheared = Sheared::new(shear, corners);
    let candidates = sheared.is_candidate();
    if !candidates.any() {
        let zero = L::splat(0.0);
        return (candidates, Candidate { t: zero, u: zero, v: zero });
    }
    let (accepted, found) = sheared.finish(shear);
    (accepted & candidates, found)
}
