//! Where a ray meets the plane of a triangle, for short hits of large triangles.
//!
//! ```text
//! q    = (1 - v - w) a + v b + w c - origin: in the plane, whatever v and w
//! x, y = how far q is beside the ray
//! z    = q.z + (n.x x + n.y y) / n . ray: from q along the plane to the ray
//! ```
//! The weights of a hit put q next to the ray, so x and y are small, and a few digits of the second line are enough. The
//! first line takes twice the digits of f32: the rounding error of each operation is added back (O. Møller, "Quasi
//! Double-Precision in Floating Point Addition", 1965; D. Knuth, "The Art of Computer Programming", volume 2, 4.2.2,
//! theorem B; for products, Dekker 1971).
//!
//! It is scalar code that is not inlined: few hits are short, and the kernels stay small.

use crate::contract::{ROUNDOFF, SMALLEST_SHEARED};
use crate::lanes::Lanes;
use crate::triangle::Shear;
use crate::unroll;

/// A hit is short where one of two terms of which its depth is the sum is more than this many times as large. Terms carry
/// the rounding of corners and weights, and what is left of them carries it undiminished.
///
/// 8 leaves longer hits eight times the error of a term, and is so large that few hits are short.
pub const CANCELLATION: f32 = 8.0;
/// How far the depth where the ray meets the plane may lie from the one that the corners' weights give, in largest depths
/// of a corner: weights are hardly ever wrong by more.
pub const PLANE_SLACK: f32 = 6.0 * ROUNDOFF;
/// Weights below this become 0, which leaves q in the plane.
///
/// So weights are whole multiples of 2^-43. Differences of lattice coordinates are multiples of 2^-83. Products of the two
/// are multiples of 2^-126, and so are their errors and all sums: none is subnormal.
pub const SMALLEST_WEIGHT: f32 = 1.0 / (1 << 20) as f32;
/// Normals below this become 0, and of triangles whose sheared area is below it the weights' depth stands.
///
/// So the product of a normal and a distance beside the ray is 0 or normal, no quotient exceeds f32's range, and one of a
/// subnormal number is below [`SMALLEST_SHEARED`] and becomes 0.
pub const SMALLEST_AREA: f32 = SMALLEST_SHEARED * SMALLEST_SHEARED;

/// The depth of the point where a ray meets the plane of a triangle, but no farther than [`PLANE_SLACK`] from `by_weights`,
/// the sum of which `largest` is a term.
///
/// `area` is minus the normal's product with the ray, twice the sheared triangle's area.
#[cold]
#[inline(never)]
pub(crate) fn met(
    shear: &Shear<f32>,
    corners: &[[f32; 3]; 3],
    weights: [f32; 2],
    area: f32,
    by_weights: f32,
    largest: f32,
) -> f32 {
    if area.abs() < SMALLEST_AREA || largest < SMALLEST_SHEARED {
        return by_weights;
    }
    let weights = weights.map(|weight| weight.flush(SMALLEST_WEIGHT));
    let [x, y, z]: [Interpolated; 3] = unroll!(k in 0..3 => Interpolated::new(shear.origin[k], corners, k, weights));
    let depth = z.at.map(|part| part.flush(SMALLEST_SHEARED));
    let (beside_x, beside_y) = (x.beside(depth, shear.slope[0]), y.beside(depth, shear.slope[1]));
    let normal_x = (y.ac * z.ab - z.ac * y.ab).flush(SMALLEST_AREA);
    let normal_y = (z.ac * x.ab - x.ac * z.ab).flush(SMALLEST_AREA);
    let to_ray = ((normal_x * beside_x + normal_y * beside_y) / area).flush(SMALLEST_SHEARED);
    let met = depth[0] + (depth[1] + to_ray);
    let [a, b, c]: [f32; 3] = unroll!(corner in 0..3 => (corners[corner][2] - shear.origin[2]).abs());
    let slack = a.max(b).max(c) * PLANE_SLACK;
    met.min(by_weights + slack).max(by_weights - slack)
}

/// A point of the plane on one axis, as seen from the origin.
struct Interpolated {
    /// A number, and the rest of it that f32 cannot hold.
    at: [f32; 2],
    /// From corner 0 to corner 1.
    ab: f32,
    /// From corner 0 to corner 2.
    ac: f32,
}

impl Interpolated {
    fn new(origin: f32, corners: &[[f32; 3]; 3], axis: usize, [v, w]: [f32; 2]) -> Self {
        let [a, b, c]: [f32; 3] = unroll!(corner in 0..3 => corners[corner][axis]);
        let [from_origin, rest] = sum(a, -origin);
        let ([ab, ab_rest], [ac, ac_rest]) = (sum(b, -a), sum(c, -a));
        let (p, q) = (v * ab, w * ac);
        let [moved, moved_rest] = sum(p, q);
        let [at, at_rest] = sum(from_origin, moved);
        let products = v.product_error(ab, p) + w.product_error(ac, q);
        let rests = rest + (v * ab_rest + w * ac_rest);
        Self { at: [at, ((moved_rest + at_rest) + products) + rests], ab, ac }
    }

    /// How far the point is beside the ray, given how far along it.
    fn beside(&self, [depth, rest]: [f32; 2], slope: f32) -> f32 {
        let product = slope * depth;
        let rest = (self.at[1] - slope.product_error(depth, product)) - slope * rest;
        ((self.at[0] - product) + rest).flush(SMALLEST_SHEARED)
    }
}

/// The sum, and its rounding error.
fn sum(a: f32, b: f32) -> [f32; 2] {
    let sum = a + b;
    let other = sum - a;
    [sum, (a - (sum - other)) + (b - other)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::LATTICE;
    use crate::triangle::Sheared;

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
            let sheared = Sheared::<f32>::new(&shear, corners);
            let (is_hit, found) = sheared.finish(&shear, &corners);
            // A thousandth of the corners' distance.
            if !is_hit || !(1.0..f64::from(EDGE) / 1000.0).contains(&truth) {
                continue;
            }
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
