//! How far an answer is from the truth, beside how far docs/contract.md says that rounding may take it.
//!
//! The contract's errors come from the distances between the ray's origin and the triangle's corners. So they are a
//! share of M, the largest component of any of these distances, whatever the size of the scene: *e2* across the ray, and *ez*
//! along its main axis.

use glam::{DVec2, DVec3};
use leafwalk_core::RayF64;
use leafwalk_core::contract::ROUNDOFF;

use super::Oracle;
use super::line::Line;

/// e2 over M: how far beside a ray a triangle may lie that is hit, on each axis across the main axis ("The lateral
/// error e2").
pub const LATERAL_ERROR: f64 = 6.0 * ROUNDOFF as f64;
/// ez, of which one part grows with M, and one with the depth of the triangle itself, since weights multiply differences of
/// the corners' depths ("The depth error ez").
const DEPTH_ERROR: [f64; 2] = [4.0 * ROUNDOFF as f64, 11.0 * ROUNDOFF as f64];

/// Lengths below this share of a scene's extent are nothing to the contract ("The flush of sheared coordinates").
const LEAST_LENGTH: f64 = 1.0 / (1u64 << 54) as f64;

/// The t that a tracer reports.
pub trait Distance: Copy + Into<f64> {
    /// Half the distance from 1 to the next number.
    const ROUNDOFF: f64;
    /// Half the smallest number: so far rounding may move a t, however small it is.
    const LEAST_ROUNDING: f64;
    /// The largest number.
    const MAX: f64;

    /// How far rounding may move a t.
    fn rounding(t: f64) -> f64 {
        Self::ROUNDOFF * t.abs() + Self::LEAST_ROUNDING
    }
}

impl Distance for f32 {
    const ROUNDOFF: f64 = ROUNDOFF as f64;
    const LEAST_ROUNDING: f64 = 1.0 / (1u128 << 75) as f64 / (1u128 << 75) as f64;
    const MAX: f64 = f32::MAX as f64;
}

impl Distance for f64 {
    const ROUNDOFF: f64 = 1.0 / (1u64 << 53) as f64;
    // Under all numbers.
    const LEAST_ROUNDING: f64 = 0.0;
    const MAX: f64 = f64::MAX;
}

/// What is allowed beside the contract's errors of a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Slack {
    /// What every length may be off by.
    pub least: f64,
    /// The frame's anchor, for meshes and rays that are rounded: corners and origins by a roundoff of their distances from
    /// it, and directions ("Frame").
    pub anchor: Option<[f64; 3]>,
}

impl Slack {
    /// Of a triangle whose corners are within `reach` of a line's origin.
    fn of(&self, line: &Line, corners: &[DVec3; 3], reach: f64) -> f64 {
        let Some(anchor) = self.anchor.map(DVec3::from_array) else { return self.least };
        let away = |point: DVec3| (point - anchor).abs().max_element();
        let corners = corners.iter().map(|corner| away(*corner)).fold(0.0, f64::max);
        self.least + f64::from(ROUNDOFF) * (corners + away(line.origin) + reach)
    }
}

/// How far an answer is from the truth, in what is allowed: above 1 it is at fault.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Excess {
    /// How far the ray passes beside the triangle that was answered, or inside one that was lost.
    pub lateral: f64,
    /// How far the answered t is from that of the triangle's plane, or from those of its corners.
    pub depth: f64,
}

impl Excess {
    /// The larger of each.
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        Self { lateral: self.lateral.max(other.lateral), depth: self.depth.max(other.depth) }
    }

    /// Whether it is more than allowed.
    pub fn is_fault(&self) -> bool {
        self.lateral.max(self.depth) > 1.0
    }
}

/// A line beside a triangle.
struct Passing {
    /// How far inside the nearest edge the line passes, on the axis on which that is nearest; negative: outside.
    inside: f64,
    /// How far beside the triangle a line may pass that hits it: e2.
    lateral: f64,
    /// The t of its plane.
    t: f64,
    /// How far t may be off; infinite, or no number, where the line runs in the plane.
    error: f64,
    /// The t of its first and last corners.
    range: [f64; 2],
    /// How far t may be outside of them.
    range_error: f64,
}

impl Passing {
    fn new<T: Distance>(line: &Line, corners: &[DVec3; 3], slack: &Slack) -> Self {
        let axis = line.direction.abs().max_position();
        let permuted = |v: DVec3| DVec3::new(v[(axis + 1) % 3], v[(axis + 2) % 3], v[axis]);
        let direction = permuted(line.direction);
        let slope = direction.truncate() / direction.z;
        let seen = corners.map(|corner| permuted(corner - line.origin));
        let reach = seen.iter().map(|corner| corner.abs().max_element()).fold(0.0, f64::max);
        let sheared = seen.map(|corner| corner.truncate() - slope * corner.z);
        let depths = DVec3::from_array(seen.map(|corner| corner.z));
        let depth = depths.max_element() - depths.min_element();
        let ends = depths / direction.z;

        let [a, b, c] = seen;
        let normal = (b - a).cross(c - a);
        let along = normal.dot(slope.extend(1.0));
        let slack = slack.of(line, corners, reach);
        let lateral = LATERAL_ERROR * reach + slack;
        // How steeply the plane rises along the ray, per step across it.
        let steepness = (normal.x.abs() + normal.y.abs()) / along.abs();
        let t = normal.dot(a) / along / direction.z;
        let along_main_axis = DEPTH_ERROR[0] * reach + DEPTH_ERROR[1] * depth + slack;
        let error = |along_main_axis: f64, t: f64| along_main_axis / direction.z.abs() + T::rounding(t);
        Self {
            inside: inside(&sheared),
            lateral,
            t,
            error: error(along_main_axis + lateral * steepness, t),
            range: [ends.min_element(), ends.max_element()],
            range_error: error(along_main_axis, ends.abs().max_element()),
        }
    }
}

/// How far the origin is inside a triangle, by the larger of two coordinates; negative: outside.
///
/// The points that are within some distance of a convex polygon, by the larger coordinate, are bounded by its own
/// edges and by its box, both moved by that distance: moved along its larger component's axis, an edge with the components x
/// and y comes nearer by the distance times |x| + |y|.
fn inside(corners: &[DVec2; 3]) -> f64 {
    let [a, b, c] = *corners;
    let turn = (b - a).perp_dot(c - a).signum();
    let edges = [(a, b), (b, c), (c, a)].into_iter().filter(|(p, q)| p != q);
    let inside_edges = edges.map(|(p, q)| turn * p.perp_dot(q) / (q - p).abs().element_sum()).fold(f64::MAX, f64::min);
    let (lower, upper) = (a.min(b).min(c), a.max(b).max(c));
    inside_edges.min((-lower).min_element()).min(upper.min_element())
}

impl Oracle {
    /// What the contract allows over this mesh, for vertices and rays that are not rounded.
    pub fn slack(&self) -> Slack {
        let corners = || self.triangles.as_flattened().iter();
        let lower = corners().fold(DVec3::INFINITY, |lower, corner| lower.min(*corner));
        let upper = corners().fold(DVec3::NEG_INFINITY, |upper, corner| upper.max(*corner));
        let extent = (upper - lower).max_element().max(0.0);
        Slack { least: LEAST_LENGTH * extent, anchor: None }
    }

    /// How far the answer that a ray has its closest hit at `t` on a triangle, or none, is from the truth.
    pub fn excess<R, T>(&self, ray: &R, answer: Option<(T, u32)>, slack: &Slack) -> Excess
    where
        R: Copy + Into<RayF64>,
        T: Distance,
    {
        let Some(line) = Line::of(&(*ray).into()) else { return Excess::default() };
        let mut excess = Excess::default();
        let mut before = f64::INFINITY;
        if let Some((t, primitive)) = answer {
            let passing = Passing::new::<T>(&line, &self.triangles[primitive as usize], slack);
            excess.lateral = (-passing.inside / passing.lateral).max(0.0);
            let t = t.into();
            // A t beyond all numbers is not reported as it is.
            if t.abs() < T::MAX {
                let outside = (passing.range[0] - t).max(t - passing.range[1]).max(0.0);
                // Without the NaN of a line in the plane.
                excess.depth = ((t - passing.t).abs() / passing.error).max(outside / passing.range_error);
            }
            // What was found is as reported, but for its last rounding.
            before = t - T::rounding(t);
        }
        let to = line.to.min(before);
        self.hierarchy.visit(&Line { to, ..line }, |corners, _, _| {
            if line.crossing(corners).is_none() {
                return;
            }
            let lost = Passing::new::<T>(&line, corners, slack);
            if line.from < lost.t - lost.error && lost.t + lost.error < to {
                excess.lateral = excess.lateral.max(lost.inside / lost.lateral);
            }
        });
        excess
    }
}
