//! Where a ray meets the plane of a triangle, for short hits of large triangles.
//!
//! ```text
//! q    = (1 - v - w) a + v b + w c - origin: in the plane, whatever v and w
//! x, y = how far q is beside the ray
//! z    = q.z + (n.x x + n.y y) / n . ray: from q along the plane to the ray
//! ```
//! The first line takes twice the digits of f32. What is left of the error, and why no number is subnormal, is derived in
//! docs/contract.md, "Short hits", with the sources.
//!
//! It is scalar code that is not inlined: few hits are short, and the kernels stay small.

use crate::contract::{ROUNDOFF, SMALLEST_SHEARED};
use crate::lanes::Lanes;
use crate::triangle::Shear;
use crate::unroll;

/// A hit is short where one of two terms of which its depth is the sum is more than this many times as large as its t'.
pub const CANCELLATION: f32 = 8.0;
/// How far the depth where the ray meets the plane may lie from the one that the corners' weights give, in largest depths
/// of a corner.
pub const PLANE_SLACK: f32 = 6.0 * ROUNDOFF;
/// A t', times this, is less than the larger of the two terms unless the hit lies more than [`PLANE_SLACK`] of that term behind
/// the origin. Such hits are not computed anew.
pub const BEHIND: f32 = -1.0 / PLANE_SLACK;
/// Weights below this become 0.
pub const SMALLEST_WEIGHT: f32 = 1.0 / (1 << 20) as f32;
/// Normals below this become 0, and of triangles whose sheared area is below it the weights' depth stands.
pub const SMALLEST_AREA: f32 = SMALLEST_SHEARED * SMALLEST_SHEARED;

/// What weights say of a hit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ByWeights<L> {
    /// The weights of the triangle's vertices 1 and 2 at the hit.
    pub(crate) weights: [L; 2],
    /// Minus the normal's product with the ray, twice the sheared triangle's area.
    pub(crate) area: L,
    /// How far along the main axis.
    pub(crate) depth: L,
    /// The larger of the first two terms that the depth is the sum of.
    pub(crate) largest: L,
    /// The largest depth of a corner, to either side.
    pub(crate) farthest: L,
}

/// The depth of the point where a ray meets the plane of a triangle, but no farther than [`PLANE_SLACK`] from the one that the
/// weights give.
#[cold]
#[inline(never)]
pub(crate) fn met<L: Lanes<Mask = bool>>(shear: &Shear<L>, corners: &[[L; 3]; 3], hit: &ByWeights<L>) -> L {
    if hit.area.abs().less(L::splat(SMALLEST_AREA)) | hit.largest.less(L::splat(SMALLEST_SHEARED)) {
        return hit.depth;
    }
    let weights = hit.weights.map(|weight| weight.flush(SMALLEST_WEIGHT));
    let [x, y, z]: [_; 3] = unroll!(k in 0..3 => Interpolated::new(shear.origin[k], corners, k, weights));
    let depth = z.at.map(|part| part.flush(SMALLEST_SHEARED));
    let (beside_x, beside_y) = (x.beside(depth, shear.slope[0]), y.beside(depth, shear.slope[1]));
    let normal_x = (y.ac * z.ab - z.ac * y.ab).flush(SMALLEST_AREA);
    let normal_y = (z.ac * x.ab - x.ac * z.ab).flush(SMALLEST_AREA);
    let to_ray = ((normal_x * beside_x + normal_y * beside_y) / hit.area).flush(SMALLEST_SHEARED);
    let met = depth[0] + (depth[1] + to_ray);
    let slack = hit.farthest * L::splat(PLANE_SLACK);
    met.min(hit.depth + slack).max(hit.depth - slack)
}

/// A point of the plane on one axis, as seen from the origin.
struct Interpolated<L> {
    /// A number, and the rest of it that f32 cannot hold.
    at: [L; 2],
    /// From corner 0 to corner 1.
    ab: L,
    /// From corner 0 to corner 2.
    ac: L,
}

impl<L: Lanes> Interpolated<L> {
    fn new(origin: L, corners: &[[L; 3]; 3], axis: usize, [v, w]: [L; 2]) -> Self {
        let [a, b, c]: [L; 3] = unroll!(corner in 0..3 => corners[corner][axis]);
        let [from_origin, rest] = difference(a, origin);
        let ([ab, ab_rest], [ac, ac_rest]) = (difference(b, a), difference(c, a));
        let (p, q) = (v * ab, w * ac);
        let [moved, moved_rest] = sum(p, q);
        let [at, at_rest] = sum(from_origin, moved);
        let products = v.product_error(ab, p) + w.product_error(ac, q);
        let rests = rest + (v * ab_rest + w * ac_rest);
        Self { at: [at, ((moved_rest + at_rest) + products) + rests], ab, ac }
    }

    /// How far the point is beside the ray, given how far along it.
    fn beside(&self, [depth, rest]: [L; 2], slope: L) -> L {
        let product = slope * depth;
        let rest = (self.at[1] - slope.product_error(depth, product)) - slope * rest;
        ((self.at[0] - product) + rest).flush(SMALLEST_SHEARED)
    }
}

/// The sum, and its rounding error.
fn sum<L: Lanes>(a: L, b: L) -> [L; 2] {
    let sum = a + b;
    let other = sum - a;
    [sum, (a - (sum - other)) + (b - other)]
}

/// The difference, and its rounding error.
fn difference<L: Lanes>(a: L, b: L) -> [L; 2] {
    sum(a, L::splat(0.0) - b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::LATTICE;
    use crate::triangle::intersect;

    /// A number from -1 to 1.
    fn random(seed: &mut u32) -> f32 {
        *seed = seed.wrapping_mul(0x0019_660d).wrapping_add(0x3c6e_f35f);
        (*seed >> 8) as f32 / (1 << 23) as f32 - 1.0
    }

    /// Rays that start close to tilted triangles as large as a scene, such as bounces in a room. The truth is the plane in
    /// f64, whose rounding is thousands of times smaller. A few are needles, or reach the limit beside the weights' depth.
    #[test]
    fn short_hits_are_off_by_a_few_roundoffs() {
        const EDGE: f32 = LATTICE as f32;
        let seed = &mut 5;
        let (mut hits, mut off, mut off_by_weights) = (0, 0, 0);
        while hits < 2000 {
            // Roughly across the ray, which goes along axis 2.
            let height = [0.3 * random(seed), 0.3 * random(seed)];
            let corners: [[f32; 3]; 3] = core::array::from_fn(|_| {
                let (x, y) = (EDGE * random(seed), EDGE * random(seed));
                [x, y, height[0] * x + height[1] * y + EDGE * random(seed) * 0.1]
            });
            let origin = [random(seed), random(seed), random(seed)].map(|c| c * EDGE * 0.2);
            let shear = Shear { origin, slope: [0.4 * random(seed), 0.4 * random(seed), 1.0] };
            let [o, a, b, c] = [origin, corners[0], corners[1], corners[2]].map(|point| point.map(f64::from));
            let from = |p: [f64; 3], q: [f64; 3]| [q[0] - p[0], q[1] - p[1], q[2] - p[2]];
            let normal = crate::normal::cross(from(a, b), from(a, c));
            let along = [f64::from(shear.slope[0]), f64::from(shear.slope[1]), 1.0];
            let truth = crate::normal::dot(normal, from(o, a)) / crate::normal::dot(normal, along);
            // A thousandth of the corners' distance.
            let Some(found) = intersect(&shear, &corners).filter(|_| (1.0..f64::from(EDGE) / 1000.0).contains(&truth))
            else {
                continue;
            };
            hits += 1;
            let is_off = |t: f32| (f64::from(t) - truth).abs() > 8.0 * f64::from(ROUNDOFF) * truth;
            let [az, bz, cz] = corners.map(|corner| corner[2] - origin[2]);
            off += u32::from(is_off(found.t));
            off_by_weights += u32::from(is_off(az + (found.u * (bz - az) + found.v * (cz - az))));
        }
        assert!(off < hits / 100, "{off} of {hits} are off");
        assert!(off_by_weights > hits / 4, "by the weights alone many are to be off: {off_by_weights} of {hits}");
    }
}
