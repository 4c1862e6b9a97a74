//! `Clock`: between the distances t' along a canonical ray and the caller's t.

use crate::contract::SMALLEST;
use crate::layout::LATTICE;

/// No hit has a t' of a magnitude above this, nor a moved ray one below the negative of [`BEHIND_MOVED`].
///
/// A hit's t' is an average of three distances along the main axis (of two root edges at most, as origins are within one of
/// the root) over a direction component of at least 1. Four edges leave room for all rounding.
pub(crate) const FARTHEST: f32 = 4.0 * LATTICE as f32;
/// Rays that were moved start on the root's surface, and all triangles lie inside: what they hit behind themselves, they hit
/// by rounding alone, which is under a lattice step.
const BEHIND_MOVED: f32 = 16.0;

/// How t' of a canonical ray becomes the caller's t. Of two distances it never puts the nearer one behind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// t' of the canonical origin, counted from the caller's: not 0 when a far origin was moved.
    pub entry: f64,
    /// One unit of t' in the caller's t: a power of two.
    pub unit: f64,
}

impl Clock {
    /// The caller's t of a canonical distance.
    #[inline]
    pub fn reported(&self, t: f32) -> f32 {
        // Finite stays finite, since only a miss reports infinity.
        (self.reported_f64(t) as f32).clamp(f32::MIN, f32::MAX)
    }

    /// The caller's t of a canonical distance, in f64.
    #[inline]
    pub fn reported_f64(&self, t: f32) -> f64 {
        (self.entry + f64::from(t)) * self.unit
    }

    /// The limits of t' between which exactly those hits lie whose reported t lies strictly between `t_min` and `t_max`.
    ///
    /// ```text
    /// t_min' = the largest  t' that is reported at t_min or before
    /// t_max' = the smallest t' that is reported at t_max or after
    /// ```
    /// Both are found by bisection over the numbers of f32: what is reported never falls as t' grows. No limit is
    /// subnormal.
    pub(crate) fn limits(&self, t_min: f32, t_max: f32) -> (f32, f32) {
        self.limits_of(|t| self.reported(t), t_min, t_max)
    }

    /// As [`Clock::limits`], for t reported in f64.
    pub(crate) fn limits_f64(&self, t_min: f64, t_max: f64) -> (f32, f32) {
        self.limits_of(|t| self.reported_f64(t), t_min, t_max)
    }

    fn limits_of<T: PartialOrd>(&self, reported: impl Fn(f32) -> T, t_min: T, t_max: T) -> (f32, f32) {
        let least = if self.entry == 0.0 { -FARTHEST } else { -BEHIND_MOVED };
        // The first t' of the range that is reported beyond a limit, or infinity.
        let first = |is_beyond: &dyn Fn(f32) -> bool| {
            if is_beyond(least) {
                return least;
            }
            if !is_beyond(FARTHEST) {
                return f32::INFINITY;
            }
            let (mut before, mut beyond) = (ordinal(least), ordinal(FARTHEST));
            while beyond - before > 1 {
                let middle = (before + beyond).div_euclid(2);
                *(if is_beyond(from_ordinal(middle)) { &mut beyond } else { &mut before }) = middle;
            }
            from_ordinal(beyond)
        };
        let after_min = first(&|t| reported(t) > t_min);
        let at_max = first(&|t| reported(t) >= t_max);
        // The number before the first that counts.
        let before = if after_min.is_finite() { from_ordinal(ordinal(after_min) - 1) } else { after_min };
        (to_exceed(before), to_stay_below(at_max))
    }

    /// Limits as if t' were not rounded: wrong, for tests.
    pub(crate) fn rounded_limits(&self, t_min: f32, t_max: f32) -> (f32, f32) {
        let limit = |t: f32| (f64::from(t) / self.unit - self.entry) as f32;
        (limit(t_min), limit(t_max))
    }
}

/// A limit that t' must exceed, without subnormals. As t' is 0 or at least [`SMALLEST`], many limits part the same t'.
fn to_exceed(limit: f32) -> f32 {
    match limit {
        0.0..SMALLEST => 0.0,
        _ if limit < 0.0 && limit > -SMALLEST => -0.5 * SMALLEST,
        _ => limit,
    }
}

/// A limit that t' must stay below, likewise: t' stays below it where its negative exceeds the limit's.
fn to_stay_below(limit: f32) -> f32 {
    -to_exceed(-limit)
}

/// The place of a finite number among all, with -0 beside 0.
fn ordinal(x: f32) -> i64 {
    let magnitude = i64::from(x.abs().to_bits());
    if x.is_sign_negative() { -1 - magnitude } else { magnitude }
}

/// The number at a place.
fn from_ordinal(ordinal: i64) -> f32 {
    if ordinal < 0 { -f32::from_bits((-1 - ordinal) as u32) } else { f32::from_bits(ordinal as u32) }
}
