//! `Hit::spawn`: rays that leave a hit and cannot hit the triangle again that they leave.
//!
//! Their origin is lifted off the triangle along its normal. How far is derived in `docs/contract.md`, "Spawned rays";
//! the constants below say it in short.

use crate::contract::{ROUNDOFF, SMALLEST_SHEARED};
use crate::frame::Frame;
use crate::layout::LATTICE;
use crate::normal::{cross, difference, dot, from_first_corner, unit};
use crate::ray::{Hit, Ray};

/// How far, in extents of its triangle, an origin is lifted off it.
///
/// Where an origin lies on a triangle, all of the triangle is at most its extent E away, the largest along any axis. So it
/// is hit where the ray passes it within 6 roundoffs of E on two axes (`e2`), at a distance that is wrong by 21 on the
/// largest of three (`ez`). A ray that leads away from its plane, starting at least sqrt(2) 6 + sqrt(3) 21 = 45 above it,
/// has t' < 0 there. The others are for the normal (`SLENDER`) and for the second order.
const LIFT_IN_EXTENTS: f64 = 56.0 * ROUNDOFF as f64;
/// How far an origin is lifted besides, in magnitudes of its largest coordinate.
///
/// The origin is rounded to f32 in the caller's units: sqrt(3) roundoffs.
const LIFT_IN_COORDINATES: f64 = 2.0 * ROUNDOFF as f64;
/// How far an origin is lifted besides, in root edges: coordinates across the ray that are smaller than this count as 0.
/// Only triangles under 2^-34 of the root's edge are lifted more by it than by their extent.
const LIFT_IN_ROOT_EDGES: f64 = 4.0 * SMALLEST_SHEARED as f64 / LATTICE as f64;
/// How far an origin is lifted at least, in the caller's units: twice the smallest subnormal number of f32.
///
/// Where f32 has subnormal numbers only, rounding moves a coordinate by half the smallest of them.
const LEAST_LIFT: f64 = 2.0 * f32::from_bits(1) as f64;
/// A triangle whose height over its longest edge is at most this share of that edge counts as a segment.
///
/// In f64 the normal of a triangle of the longest edge L and the height h is off by 5 * 2^-53 L^2, so its direction by
/// 5 * 2^-53 L / h. With h above 2^-26 L, points of the triangle seem to leave its plane by 5 * 2^-27 L at most. Those of
/// a triangle that is less high leave the line of its longest edge by 2^-26 L at most. L is sqrt(3) extents at most, so
/// either is 1.1 roundoffs of the extent or less.
const SLENDER: f64 = 1.0 / (1 << 26) as f64;

impl Frame {
    /// How far off a triangle, along its normal, a ray has to start at this point of it, in the caller's units, so that it
    /// cannot hit that triangle while it leads away from it or along it.
    pub fn clearance(&self, corners: &[[f32; 3]; 3], point: [f64; 3]) -> f64 {
        let largest = |numbers: [f64; 3]| numbers.into_iter().fold(0.0, |largest: f64, c| largest.max(c.abs()));
        let [_, ab, ac] = from_first_corner(corners);
        let extent = largest(ab).max(largest(ac)).max(largest(difference(ac, ab)));
        LIFT_IN_EXTENTS * extent + LIFT_IN_COORDINATES * largest(point) + LIFT_IN_ROOT_EDGES * self.scale() + LEAST_LIFT
    }
}

impl Hit {
    /// A ray that leaves this hit without hitting its triangle again: shadow rays, bounces, reflections, and rays that go
    /// on behind a surface.
    ///
    /// It starts a little off the triangle, on the side to which `direction` points, with `t_min = 0` and no limit; how
    /// little is [`Frame::clearance`]. `frame` is that of the octree, and `corners` are those of the triangle that was
    /// hit, in the caller's units. Other triangles may be hit as soon as the ray meets them, however near they are.
    ///
    /// ```
    /// # use leafwalk_core::{Frame, Hit, Ray};
    /// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let frame = Frame::around([0.0; 3], [1.0, 1.0, 0.0]);
    /// let hit = Hit { t: 2.0, u: 0.25, v: 0.5, primitive: 0 };
    /// let up = hit.spawn(&frame, &corners, [0.0, 0.0, 1.0]);
    /// let down = hit.spawn(&frame, &corners, [1.0, 0.0, -1.0]);
    /// assert!(up.origin[2] > 0.0 && down.origin[2] < 0.0);
    /// ```
    pub fn spawn(&self, frame: &Frame, corners: &[[f32; 3]; 3], direction: [f32; 3]) -> Ray {
        let point = self.position(corners);
        self.spawn_lifted(corners, direction, frame.clearance(corners, point))
    }

    /// See [`crate::testing::spawn_lifted`].
    pub(crate) fn spawn_lifted(&self, corners: &[[f32; 3]; 3], direction: [f32; 3], lift: f64) -> Ray {
        let normal = leaving(corners, direction.map(f64::from));
        let point = self.position(corners);
        Ray::new(core::array::from_fn(|k| (point[k] + lift * normal[k]) as f32), direction)
    }
}

/// The unit normal of a triangle on the side to which a direction points.
///
/// A ray leaves a segment on any side that is at right angles to it, and a point on any side.
fn leaving(corners: &[[f32; 3]; 3], direction: [f64; 3]) -> [f64; 3] {
    let [_, ab, ac] = from_first_corner(corners);
    let edges = [ab, ac, difference(ac, ab)];
    let longest = edges.into_iter().fold([0.0; 3], |a, b| if dot(b, b) > dot(a, a) { b } else { a });
    let (normal, length) = (cross(ab, ac), dot(longest, longest));
    // |normal| is the longest edge times the height over it.
    let is_slender = dot(normal, normal) <= (SLENDER * length) * (SLENDER * length);
    let normal = if is_slender { cross(longest, axis_across(longest)) } else { normal };
    let normal = unit(normal).unwrap_or([1.0, 0.0, 0.0]);
    if dot(normal, direction) < 0.0 { normal.map(|c| -c) } else { normal }
}

/// The axis along which a vector is shortest: it is far from parallel to it.
fn axis_across(vector: [f64; 3]) -> [f64; 3] {
    let shortest = (1..3).fold(0, |axis, k| if vector[k].abs() < vector[axis].abs() { k } else { axis });
    core::array::from_fn(|k| if k == shortest { 1.0 } else { 0.0 })
}
