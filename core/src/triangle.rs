//! The watertight ray/triangle test of Woop, Benthin & Wald (JCGT 2(1), 2013), with an exact finish, for any lanes.
//!
//! Corners come permuted: axis 2 is the one along which the ray's direction is largest. A loader picks arrays in that
//! order for nothing, so the test itself never moves data.

use crate::contract::{SMALLEST, SMALLEST_SHEARED};
use crate::lanes::Lanes;
use crate::layout::LATTICE;
use crate::plane::{self, BEHIND, ByWeights, CANCELLATION, PLANE_SLACK};
use crate::ray::CanonicalRay;
use crate::unroll;

/// How far below 0 a difference of products may lie whose exact value, with small coordinates taken for 0, is not
/// negative. Sheared coordinates are at most 4 root edges (2 from the origin, and as much again by the shear), so that a
/// product with one below [`SMALLEST_SHEARED`] is below 4 edges times that, and of two such products the difference below
/// 8.
pub const CANDIDATE_SLACK: f32 = 8.0 * LATTICE as f32 * SMALLEST_SHEARED;

/// The ray's part of the test: everything that does not depend on the triangle.
#[derive(Clone, Copy, Debug)]
pub struct Shear<L> {
    /// Permuted.
    pub origin: [L; 3],
    /// `d_x / d_z`, `d_y / d_z` and `1 / d_z` in permuted axes.
    pub slope: [L; 3],
}

/// The axes in the order of a ray's permutation: the one of its largest direction component last.
#[inline(always)]
pub fn permutation(direction: [f32; 3]) -> [usize; 3] {
    let [is_x, is_y, _] = main_axis(direction);
    PERMUTATIONS[if is_x {
        0
    } else if is_y {
        1
    } else {
        2
    }]
}

/// The permutation by its last axis.
pub const PERMUTATIONS: [[usize; 3]; 3] = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];

/// Which axis has the largest direction component: one of three, the first of equals.
#[inline(always)]
pub fn main_axis<L: Lanes>(direction: [L; 3]) -> [L::Mask; 3] {
    let [x, y, z]: [L; 3] = unroll!(k in 0..3 => direction[k].abs());
    let is_x = y.at_most(x) & z.at_most(x);
    let is_y = z.at_most(y) & !is_x;
    [is_x, is_y, !is_x & !is_y]
}

impl<L: Lanes> Shear<L> {
    /// One ray in every lane, with its permutation.
    #[inline(always)]
    pub fn new(ray: &CanonicalRay) -> (Self, [usize; 3]) {
        let axes = permutation(ray.direction);
        let permuted = |p: [f32; 3]| unroll!(k in 0..3 => p[axes[k]]);
        (Self::splat(&Shear::of_permuted(permuted(ray.origin), permuted(ray.direction))), axes)
    }

    /// A ray a lane, permuted.
    #[inline(always)]
    pub fn of_permuted(origin: [L; 3], [x, y, z]: [L; 3]) -> Self {
        Self { origin, slope: [x / z, y / z, L::splat(1.0) / z] }
    }
}

impl<L: Lanes> Shear<L> {
    /// A shear that holds one ray in every lane.
    #[inline(always)]
    pub fn splat(shear: &Shear<f32>) -> Self {
        Self {
            origin: unroll!(k in 0..3 => L::splat(shear.origin[k])),
            slope: unroll!(k in 0..3 => L::splat(shear.slope[k])),
        }
    }

    /// A point's distance from the ray along an axis across it.
    #[inline(always)]
    fn lateral(&self, from_origin: [L; 3], axis: usize) -> L {
        from_origin[axis] - self.slope[axis] * from_origin[2]
    }
}

/// Sheared corners: the ray is the z axis.
#[derive(Clone, Copy, Debug)]
pub struct Sheared<L> {
    x: [L; 3],
    y: [L; 3],
    z: [L; 3],
}

/// What a ray finds on a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Candidate<L: Lanes> {
    /// Distance t' along the canonical ray.
    pub t: L,
    /// Weight of vertex 1.
    pub u: L,
    /// Weight of vertex 2.
    pub v: L,
    /// Whether the hit is short, so that the `t` of [`Sheared::hit`] counts.
    pub is_short: L::Mask,
    /// How far that may lie from `t`: twice [`PLANE_SLACK`], for rounding.
    slack: L,
}

impl<L: Lanes> Sheared<L> {
    /// Shears permuted corners.
    #[inline(always)]
    pub fn new(shear: &Shear<L>, corners: [[L; 3]; 3]) -> Self {
        let from_origin: [[L; 3]; 3] = unroll!(c in 0..3 => unroll!(k in 0..3 => corners[c][k] - shear.origin[k]));
        Self {
            x: unroll!(c in 0..3 => shear.lateral(from_origin[c], 0)),
            y: unroll!(c in 0..3 => shear.lateral(from_origin[c], 1)),
            z: unroll!(c in 0..3 => from_origin[c][2]),
        }
    }

    /// Which lanes may hold a hit: no triangle that [`Sheared::finish`] accepts is left out.
    ///
    /// Rounding is monotone, so the sign of a difference of two rounded products is right, or the difference is 0; and
    /// where the finish takes a small coordinate for 0, its products are within the slack.
    #[inline(always)]
    pub fn is_candidate(&self) -> L::Mask {
        let ([ax, bx, cx], [ay, by, cy]) = (self.x, self.y);
        let (u, v, w) = (cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax);
        let not_negative = L::splat(-CANDIDATE_SLACK).at_most(u.min(v).min(w));
        let not_positive = u.max(v).max(w).at_most(L::splat(CANDIDATE_SLACK));
        not_negative | not_positive
    }

    /// Decides the candidates exactly, for the corners as rounded by the shear, and gives what their weights say; `inverse` is
    /// that of the ray's direction along the main axis.
    ///
    /// Without the exact finish a needle or a ray in the plane is hit far from the triangle
    /// (docs/contract.md, "Triangle test").
    #[inline(always)]
    pub fn finish(&self, inverse: L) -> (L::Mask, Candidate<L>) {
        let (accepted, hit) = self.weigh();
        (accepted, Candidate::new(&hit, inverse))
    }

    /// Which lanes hold a hit, and what its weights say.
    #[inline(always)]
    fn weigh(&self) -> (L::Mask, ByWeights<L>) {
        let [ax, bx, cx] = unroll!(c in 0..3 => self.x[c].flush(SMALLEST_SHEARED));
        let [ay, by, cy] = unroll!(c in 0..3 => self.y[c].flush(SMALLEST_SHEARED));
        let u = difference_of_products(cx, by, cy, bx);
        let v = difference_of_products(ax, cy, ay, cx);
        let w = difference_of_products(bx, ay, by, ax);
        let zero = L::splat(0.0);
        let (negative, positive) = (u.min(v).min(w).less(zero), zero.less(u.max(v).max(w)));
        let accepted = (negative | positive) & !(negative & positive);

        let area = (u + v) + w;
        let weights @ [v, w] = [v / area, w / area];
        let [az, bz, cz] = self.z;
        let towards_b = v * (bz - az);
        let depth = az + (towards_b + w * (cz - az));
        let largest = az.abs().max(towards_b.abs());
        let farthest = az.abs().max(bz.abs()).max(cz.abs());
        (accepted, ByWeights { weights, area, depth, largest, farthest })
    }
}

impl<L: Lanes<Mask = bool>> Sheared<L> {
    /// The hit of one ray on one triangle, a candidate, short hits included.
    #[inline(always)]
    pub fn hit(&self, shear: &Shear<L>, corners: &[[L; 3]; 3]) -> Option<Candidate<L>> {
        let (accepted, hit) = self.weigh();
        let mut found = Candidate::new(&hit, shear.slope[2]);
        if accepted & found.is_short {
            found.t = (plane::met(shear, corners, &hit) * shear.slope[2]).flush(SMALLEST);
        }
        accepted.then_some(found)
    }
}

impl<L: Lanes> Candidate<L> {
    #[inline(always)]
    fn new(hit: &ByWeights<L>, inverse: L) -> Self {
        let ([u, v], t) = (hit.weights, hit.depth * inverse);
        let is_short = (t * L::splat(CANCELLATION)).less(hit.largest) & (t * L::splat(BEHIND)).less(hit.largest);
        let slack = hit.farthest * L::splat(2.0 * PLANE_SLACK);
        Self { t: t.flush(SMALLEST), u: u.flush(SMALLEST), v: v.flush(SMALLEST), is_short, slack }
    }

    /// Whether a short hit may be between limits, so far as `t` tells.
    #[inline(always)]
    pub fn may_be_between(&self, t_min: L, t_max: L) -> L::Mask {
        t_min.less(self.t + self.slack) & (self.t - self.slack).at_most(t_max)
    }

    /// Whether a short hit is between limits, so far as `t` tells.
    #[inline(always)]
    pub fn is_surely_between(&self, t_min: L, t_max: L) -> L::Mask {
        t_min.less(self.t - self.slack) & (self.t + self.slack).less(t_max)
    }
}

/// `a * b - c * d` with a sign that is exact and an error of at most 2 roundoffs (Cornea, Harrison & Tang 2002).
#[inline(always)]
fn difference_of_products<L: Lanes>(a: L, b: L, c: L, d: L) -> L {
    let (p, q) = (a * b, c * d);
    (p - q) + (a.product_error(b, p) - c.product_error(d, q))
}

/// Permuted corners in, a hit out: the whole test of one ray and one triangle.
#[inline(always)]
pub fn intersect<L: Lanes<Mask = bool>>(shear: &Shear<L>, corners: &[[L; 3]; 3]) -> Option<Candidate<L>> {
    let sheared = Sheared::new(shear, *corners);
    if sheared.is_candidate() { sheared.hit(shear, corners) } else { None }
}
