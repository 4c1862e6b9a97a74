//! A second opinion on the truth, which shares nothing with the first: fractions instead of integers and f64, the quotients
//! of Möller and Trumbore instead of volumes, every triangle instead of a hierarchy.

use leafwalk_core::RayF64;
use num_rational::BigRational;
use num_traits::{One, Zero};

use super::{Hit, Oracle};

type Vector = [BigRational; 3];

fn exact(numbers: [f64; 3]) -> Vector {
    numbers.map(|c| BigRational::from_float(c).expect("a finite number"))
}

fn difference(a: &Vector, b: &Vector) -> Vector {
    core::array::from_fn(|k| &a[k] - &b[k])
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    core::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        &a[i] * &b[j] - &a[j] * &b[i]
    })
}

fn dot(a: &Vector, b: &Vector) -> BigRational {
    (0..3).map(|k| &a[k] * &b[k]).sum()
}

/// Where a line meets a triangle, its edges included; nowhere if it runs in the plane.
fn crossing(origin: &Vector, direction: &Vector, corners: &[Vector; 3]) -> Option<BigRational> {
    let [a, b, c] = corners;
    let (first, second) = (difference(b, a), difference(c, a));
    let p = cross(direction, &second);
    let determinant = dot(&first, &p);
    if determinant.is_zero() {
        return None;
    }
    let from_corner = difference(origin, a);
    let q = cross(&from_corner, &first);
    let (u, v) = (dot(&from_corner, &p) / &determinant, dot(direction, &q) / &determinant);
    let zero = BigRational::zero();
    let is_inside = u >= zero && v >= zero && &u + &v <= BigRational::one();
    is_inside.then(|| dot(&second, &q) / &determinant)
}

/// The closest hit among all triangles of an oracle, with those that have the same t, in order.
pub(super) fn closest(oracle: &Oracle, ray: &RayF64) -> Option<(BigRational, Vec<u32>)> {
    let (origin, direction) = (exact(ray.origin), exact(ray.direction));
    let from = BigRational::from_float(ray.t_min).expect("a finite number");
    // Infinity is no fraction, and no limit.
    let to = BigRational::from_float(ray.t_max);
    let mut best: Option<(BigRational, Vec<u32>)> = None;
    for (primitive, corners) in (0..).zip(&oracle.triangles) {
        let Some(t) = crossing(&origin, &direction, &corners.map(|corner| exact(corner.to_array()))) else { continue };
        if t <= from || to.as_ref().is_some_and(|to| t >= *to) {
            continue;
        }
        match &mut best {
            Some((least, _)) if t > *least => {}
            Some((least, primitives)) if t == *least => primitives.push(primitive),
            _ => best = Some((t, vec![primitive])),
        }
    }
    best
}

/// Whether a hit is what fractions say.
pub(super) fn agrees(found: Option<&Hit>, expected: Option<&(BigRational, Vec<u32>)>) -> bool {
    let (Some(found), Some((t, primitives))) = (found, expected) else { return found.is_none() && expected.is_none() };
    let mut same: Vec<u32> = found.others.iter().copied().chain([found.primitive]).collect();
    same.sort_unstable();
    let error = BigRational::from_float(found.t).expect("a finite number") - t;
    let bound = BigRational::from_float(2f64.powi(-39)).expect("a finite number") * t;
    same == *primitives && error.clone() * error <= bound.clone() * bound
}
