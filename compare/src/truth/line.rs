//! Where a line passes through a triangle: decided in f64, and exactly where f64 cannot decide.

use core::cmp::Ordering;

use glam::{DVec3, Vec3Swizzles};
use leafwalk_core::RayF64;

use super::exact::Exact;

/// Half the distance from 1 to the next f64.
const ROUNDOFF: f64 = 1.0 / (1u64 << 53) as f64;
/// How far the computed volume of three vectors, of which two are differences, may be off, in roundoffs of the sum of the
/// magnitudes of its terms: one for each difference, two for the products, one for the difference between them, two for the
/// sum; and one for all that is of second order.
const VOLUME_ERROR: f64 = 8.0 * ROUNDOFF;
/// The same for the volumes that give t: the normal has one rounding more than a difference, and so has the corner.
const DISTANCE_ERROR: f64 = 10.0 * ROUNDOFF;
/// A t that is less certain than this, relatively, is computed exactly: 2^-16 of an f32's roundoff.
const CERTAIN: f64 = 1.0 / (1u64 << 40) as f64;

/// The points `origin + t * direction` with `from < t < to`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    pub(super) origin: DVec3,
    pub(super) direction: DVec3,
    pub(super) from: f64,
    pub(super) to: f64,
}

/// A point of a triangle on a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    pub(super) t: f64,
    /// How far t may be off.
    pub(super) error: f64,
}

impl Line {
    /// The line of a ray, or `None` where the ray is invalid.
    pub(super) fn of(ray: &RayF64) -> Option<Self> {
        let RayF64 { origin, t_min: from, direction, t_max: to } = *ray;
        let [origin, direction] = [origin, direction].map(DVec3::from_array);
        ray.is_valid().then_some(Self { origin, direction, from, to })
    }

    /// Where it passes through a triangle, edges included, if between its limits. A triangle in a plane with the line is
    /// not met.
    pub(super) fn crossing(&self, corners: &[DVec3; 3]) -> Option<Crossing> {
        let [a, b, c] = corners.map(|corner| corner - self.origin);
        let sides = [(b, c), (c, a), (a, b)].map(|(p, q)| volume(self.direction, p, q));
        let is_left = sides.iter().any(|(side, error)| side > error);
        let is_right = sides.iter().any(|(side, error)| *side < -error);
        if is_left && is_right {
            return None;
        }
        let mut exact = None;
        if sides.iter().any(|(side, error)| side.abs() <= *error && *error > 0.0) {
            let signs = exact.get_or_insert_with(|| self.exact(corners)).sides();
            if signs.contains(&Ordering::Less) == signs.contains(&Ordering::Greater) {
                return None;
            }
        } else if !is_left && !is_right {
            return None;
        }
        let normal = Normal::of(corners);
        let (over, over_error) = normal.dot(a);
        let (under, under_error) = normal.dot(self.direction);
        let t = over / under;
        let error = (over_error + t.abs() * under_error) / (under.abs() - under_error).max(0.0);
        let mut found = Crossing { t, error };
        // No number, where the line all but runs in the plane, is no certain one.
        let is_certain = error <= CERTAIN * t.abs() || over_error == 0.0;
        if !is_certain {
            let t = exact.get_or_insert_with(|| self.exact(corners)).distance().to_f64();
            found = Crossing { t, error: 4.0 * ROUNDOFF * t.abs() };
        }
        let order = |limit: f64| {
            if (found.t - limit).abs() > found.error || limit.is_infinite() {
                return found.t.total_cmp(&limit);
            }
            self.exact(corners).distance().order_to(limit)
        };
        (order(self.from).is_gt() && order(self.to).is_lt()).then_some(found)
    }

    /// The line and a triangle in integers.
    pub(super) fn exact(&self, corners: &[DVec3; 3]) -> Exact {
        Exact::new(self.origin, self.direction, corners)
    }

    /// The order of two triangles that it passes through.
    pub(super) fn order(&self, [a, b]: [(&[DVec3; 3], Crossing); 2]) -> Ordering {
        if (a.1.t - b.1.t).abs() > a.1.error + b.1.error {
            return a.1.t.total_cmp(&b.1.t);
        }
        let [a, b] = [a, b].map(|(corners, _)| self.exact(corners).distance());
        a.order(&b)
    }
}

/// Six times the volume that three vectors span, and how far it may be off.
fn volume(d: DVec3, p: DVec3, q: DVec3) -> (f64, f64) {
    let (left, right) = (p.yzx() * q.zxy(), p.zxy() * q.yzx());
    (d.dot(left - right), VOLUME_ERROR * d.abs().dot(left.abs() + right.abs()))
}

/// A triangle's normal, and the magnitudes of the terms that it is the sum of.
struct Normal {
    sum: DVec3,
    terms: DVec3,
}

impl Normal {
    fn of([a, b, c]: &[DVec3; 3]) -> Self {
        let (p, q) = (*b - *a, *c - *a);
        let (left, right) = (p.yzx() * q.zxy(), p.zxy() * q.yzx());
        Self { sum: left - right, terms: left.abs() + right.abs() }
    }

    fn dot(&self, v: DVec3) -> (f64, f64) {
        (self.sum.dot(v), DISTANCE_ERROR * self.terms.dot(v.abs()))
    }
}
