//! The lattice frame: the caller's units on one side, lattice coordinates on the other.
//!
//! Lattice coordinates count steps of the finest cells from an *anchor*. The anchor is chosen such that no vertex of f32
//! is rounded on the way (docs/contract.md, "Frame").

use crate::contract::{MESH_MARGIN, SMALLEST};
use crate::layout::{LATTICE, MAX_LEVEL};
use crate::unroll;

/// The root's edge in lattice steps.
const EDGE: f32 = LATTICE as f32;

/// `caller = anchor + 2^(scale_exponent - 16) * lattice`; the root cube begins at `corner` on the lattice, and its edge is
/// 2^16 steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Where lattice coordinates are 0, in the caller's units.
    pub anchor: [f64; 3],
    /// The root's lower corner: whole lattice steps.
    pub corner: [f32; 3],
    /// The root's edge is 2 to this power, in the caller's units.
    pub scale_exponent: i32,
}

impl Frame {
    /// Exponents that meshes of finite f32 positions can need.
    pub const SCALE_EXPONENTS: core::ops::RangeInclusive<i32> = -149..=131;

    /// The smallest frame that keeps the box `lower..=upper` (finite, in the caller's units) inside the root by the mesh
    /// margin of 2^-17 of its edge on every side.
    pub fn around(lower: [f64; 3], upper: [f64; 3]) -> Self {
        Self::focused([lower, upper], [lower, upper])
    }

    /// As [`Frame::around`] a box, lower corner first, with the anchor that a box inside it would have: meshes that must be
    /// rounded are rounded least there.
    pub fn focused(bounds: [[f64; 3]; 2], focus: [[f64; 3]; 2]) -> Self {
        Self::focused_with_margin(bounds, focus, MESH_MARGIN)
    }

    /// See [`crate::testing::frame_touching`].
    pub(crate) fn focused_with_margin([lower, upper]: [[f64; 3]; 2], focus: [[f64; 3]; 2], margin: f32) -> Self {
        let extent = (0..3).map(|k| upper[k] - lower[k]).fold(0.0, f64::max);
        let mut scale_exponent = if extent > 0.0 { exponent(extent) } else { 0 };
        scale_exponent = scale_exponent.max(*Self::SCALE_EXPONENTS.start());
        let anchor = core::array::from_fn(|k| anchor(focus[0][k], focus[1][k]));
        let mut frame = Self { anchor, corner: [0.0; 3], scale_exponent };
        loop {
            let (low, high) = (frame.to_lattice(lower), frame.to_lattice(upper));
            frame.corner = core::array::from_fn(|k| {
                let middle = 0.5 * (f64::from(low[k]) + f64::from(high[k]));
                nearest_whole(middle - 0.5 * f64::from(EDGE))
            });
            let (low, high) = (frame.to_root(low), frame.to_root(high));
            if low.iter().all(|c| *c >= margin) && high.iter().all(|c| *c <= EDGE - margin) {
                return frame;
            }
            frame.scale_exponent += 1;
        }
    }

    /// The root's edge in the caller's units.
    pub fn scale(&self) -> f64 {
        power_of_two(self.scale_exponent)
    }

    /// A lattice step in the caller's units: 2 to this power.
    pub(crate) fn step_exponent(&self) -> i32 {
        self.scale_exponent - MAX_LEVEL as i32
    }

    /// A point in lattice coordinates. They are exact for the vertices of a mesh of f32 that the frame was made around,
    /// but for magnitudes under 2^-60, which become 0; other points are rounded once.
    #[inline(always)]
    pub fn to_lattice(&self, point: [f64; 3]) -> [f32; 3] {
        let per_unit = power_of_two(-self.step_exponent());
        unroll!(k in 0..3 => flush(((point[k] - self.anchor[k]) * per_unit) as f32, SMALLEST))
    }

    /// Where a lattice point lies as seen from the root's corner, rounded once: 0 to 2^16 inside the root.
    #[inline(always)]
    pub fn to_root(&self, point: [f32; 3]) -> [f32; 3] {
        unroll!(k in 0..3 => point[k] - self.corner[k])
    }

    /// A lattice point in the caller's units.
    pub fn to_caller(&self, point: [f32; 3]) -> [f64; 3] {
        let step = power_of_two(self.step_exponent());
        core::array::from_fn(|k| self.anchor[k] + step * f64::from(point[k]))
    }
}

/// A number from which the distances to all numbers of f32 in an interval are numbers of f32, or of f64 for f64.
///
/// That is 0 where the interval holds 0, or ends at more than twice its beginning: then no distance is larger than twice
/// the interval is long. Else it is a number of the interval, since the difference of two numbers within a factor of two
/// of each other is exact (P. H. Sterbenz, "Floating-Point Computation", 1974): the roundest of them, so that distances
/// to most points outside are exact, too.
///
/// Where that is a power of two, and the interval begins just above the one before, points just below the interval lie
/// closer together than distances to them from so far away can tell. So the power of two before is taken: from there to the
/// end, less than three times as much, distances are whole in units of what numbers there are apart.
fn anchor(lower: f64, upper: f64) -> f64 {
    let (near, far) = if lower > 0.0 { (lower, upper) } else { (-upper, -lower) };
    if near <= 0.0 || far > 2.0 * near {
        return 0.0;
    }
    let before = power_of_two(exponent(near));
    if far >= 2.0 * before && near < 1.5 * before {
        return before.copysign(lower);
    }
    // The numbers of an interval begin with the bits that both ends have in common; the next bit is 1 at the far end. The
    // number with these bits and zeros behind them lies inside, and is as round as the interval allows, but for its near
    // end.
    let differing = near.to_bits() ^ far.to_bits();
    let kept = match differing {
        0 => u64::MAX,
        _ => u64::MAX << (u64::BITS - 1 - differing.leading_zeros()),
    };
    f64::from_bits(far.to_bits() & kept).copysign(lower)
}

/// The whole number nearest to a number within four root edges of 0.
fn nearest_whole(x: f64) -> f32 {
    // Casts round toward zero, so what they see is made positive.
    let bias = 4.0 * f64::from(EDGE);
    ((x + (bias + 0.5)) as u32 as f64 - bias) as f32
}

/// `x`, or 0 where its magnitude is under `smallest`: neither subnormals nor the sign of zero carry meaning.
#[inline(always)]
pub(crate) fn flush(x: f32, smallest: f32) -> f32 {
    if x.abs() < smallest { 0.0 } else { x }
}

/// 2 to a power within -1022..=1023.
#[inline(always)]
pub(crate) fn power_of_two(exponent: i32) -> f64 {
    debug_assert!((-1022..=1023).contains(&exponent));
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

/// The exponent of a positive normal number: `2^e <= x < 2^(e+1)`.
pub(crate) fn exponent(x: f64) -> i32 {
    (x.to_bits() >> 52) as i32 - 1023
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn anchors_are_round_and_inside() {
        for (lower, upper, expected) in [
            (-1.0, 3.0, 0.0),
            (0.0, 3.0, 0.0),
            (1.0, 2.5, 0.0),
            (1.0, 2.0, 1.0),
            (1.25, 2.0, 1.0),
            (1.75, 2.0, 2.0),
            (-2.5, -1.25, -1.0),
            (100.25, 101.0, 101.0),
            (100.25, 101.5, 101.0),
            (999_900.0, 1_000_100.0, 999_936.0),
            (-101.5, -100.25, -101.0),
            (0.1, 0.1, 0.1),
            (1e-42, 1.5e-42, 7.174_648e-43),
        ] {
            let found = anchor(f64::from(lower as f32), f64::from(upper as f32));
            assert!((found - expected).abs() <= 1e-6 * expected.abs(), "{found} for {lower} to {upper}");
            assert!(found.abs() <= f64::from(lower as f32).abs().max(f64::from(upper as f32).abs()));
            assert_eq!(f64::from(found as f32), found, "a number of f32");
        }
    }

    #[test]
    fn vertices_are_exact() {
        let ends: [[f32; 2]; 11] = [
            [-1.0, 1.0],
            [1e-3, 7.0],
            [1.0, 1.5],
            [1.0001, 2.0001],
            [1.4, 2.7],
            [999.1, 1000.3],
            [-2e30, -1.5e30],
            [1e-42, 1.5e-42],
            [5.0, 5.0],
            [2e38, 2.2e38],
            [-3.4e38, 3.4e38],
        ];
        for axis in ends {
            for other in ends {
                let [lower, upper] = [0, 1].map(|end: usize| [axis[end], other[end], -axis[1 - end]]);
                let frame = Frame::around(lower.map(f64::from), upper.map(f64::from));
                let between = |k: usize| 0.3 * lower[k] + 0.7 * upper[k];
                for point in [lower, upper, [0, 1, 2].map(between)] {
                    let lattice = frame.to_lattice(point.map(f64::from));
                    let back = frame.to_caller(lattice);
                    for k in 0..3 {
                        let is_tiny = lattice[k] == 0.0;
                        let slack = if is_tiny { f64::from(SMALLEST) * frame.scale() / f64::from(EDGE) } else { 0.0 };
                        assert!((back[k] - f64::from(point[k])).abs() <= slack, "{point:?} {frame:?}");
                    }
                    assert!(frame.to_root(lattice).iter().all(|c| (MESH_MARGIN..=EDGE - MESH_MARGIN).contains(c)));
                    assert!(lattice.iter().all(|c| c.abs() < 2.0 * EDGE));
                }
                assert!(frame.corner.iter().all(|c| c.abs() <= 2.0 * EDGE && *c as i32 as f32 == *c));
            }
        }
    }

    /// Wherever the focus is: all stays in the root, and the root near the anchor.
    #[test]
    fn focused_frames_hold_the_whole_box() {
        let points: [f64; 12] = [-3e6, -2.0, 0.0, 1.0, 1.000_000_1, 1.4, 1.9, 2.1, 2.9, 4.5e6, 4.500_001e6, 9e6];
        let count = points.len();
        let ends = (0..count).flat_map(|low| (low..count).map(move |high| (low, high)));
        let nested =
            ends.flat_map(|(low, high)| (low..=high).flat_map(move |a| (a..=high).map(move |b| [low, a, b, high])));
        for [lower, a, b, upper] in nested.map(|at| at.map(|i| points[i])) {
            let focus = [a, b];
            let frame = Frame::focused([[lower; 3], [upper; 3]], focus.map(|c| [c; 3]));
            for point in [lower, upper, focus[0], focus[1]] {
                let lattice = frame.to_lattice([point; 3]);
                assert!(lattice[0].abs() <= 2.0 * EDGE, "{lower} to {upper}, {focus:?}: {frame:?}");
                let seen = frame.to_root(lattice)[0];
                assert!((MESH_MARGIN..=EDGE - MESH_MARGIN).contains(&seen), "{lower} to {upper}, {focus:?}");
                let off = (frame.to_caller(lattice)[0] - point).abs();
                // Beside u of the distance from the anchor, a difference and a sum are rounded in f64.
                let away = (point - frame.anchor[0]).abs();
                assert!(off <= away * power_of_two(-24) + point.abs() * power_of_two(-52), "{point} of {frame:?}");
            }
            assert!(frame.corner[0].abs() <= 2.0 * EDGE);
        }
    }
}
