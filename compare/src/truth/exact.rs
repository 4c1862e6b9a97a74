//! A line and a triangle in integers: every f64 is one, times a power of two that all lengths share.

use core::cmp::Ordering;

use glam::DVec3;
use num_bigint::BigInt;

type Vector = [BigInt; 3];

/// A triangle as seen from a line's origin.
pub(super) struct Exact {
    corners: [Vector; 3],
    direction: Vector,
    /// t in these units is t times 2 to this power.
    exponent: i64,
}

/// `over / under * 2^exponent`.
pub(super) struct Ratio {
    over: BigInt,
    /// Positive.
    under: BigInt,
    exponent: i64,
}

impl Exact {
    pub(super) fn new(origin: DVec3, direction: DVec3, corners: &[DVec3; 3]) -> Self {
        let (origin, direction) = (origin.to_array(), direction.to_array());
        let points = corners.map(|corner| corner.to_array());
        let length = points.as_flattened().iter().chain(&origin).map(|c| exponent(*c)).min().unwrap_or(0);
        let from_origin =
            |point: [f64; 3]| core::array::from_fn(|k| integer(point[k], length) - integer(origin[k], length));
        let unit = direction.iter().map(|c| exponent(*c)).min().unwrap_or(0);
        Self {
            corners: points.map(from_origin),
            direction: direction.map(|c| integer(c, unit)),
            exponent: i64::from(length - unit),
        }
    }

    /// On which side of its three edges the line passes.
    pub(super) fn sides(&self) -> [Ordering; 3] {
        let [a, b, c] = &self.corners;
        [(b, c), (c, a), (a, b)].map(|(p, q)| dot(&self.direction, &cross(p, q)).cmp(&BigInt::ZERO))
    }

    /// The t of the triangle's plane, which the line must not be parallel to.
    pub(super) fn distance(&self) -> Ratio {
        let [a, b, c] = &self.corners;
        let normal = cross(&difference(b, a), &difference(c, a));
        let (over, under) = (dot(a, &normal), dot(&self.direction, &normal));
        let (over, under) = if under < BigInt::ZERO { (-over, -under) } else { (over, under) };
        assert_ne!(under, BigInt::ZERO, "a line that runs in the plane");
        Ratio { over, under, exponent: self.exponent }
    }
}

impl Ratio {
    pub(super) fn order(&self, other: &Self) -> Ordering {
        let least = self.exponent.min(other.exponent);
        let side = |a: &Self, b: &Self| (&a.over * &b.under) << (a.exponent - least) as u64;
        side(self, other).cmp(&side(other, self))
    }

    /// Compares with a finite number.
    pub(super) fn order_to(&self, number: f64) -> Ordering {
        let exponent = exponent(number);
        self.order(&Self { over: integer(number, exponent), under: 1.into(), exponent: exponent.into() })
    }

    /// Off by less than 2^-51 of itself.
    pub(super) fn to_f64(&self) -> f64 {
        let ([over, under], [above, below]) = {
            let leading = [&self.over, &self.under].map(leading);
            (leading.map(|(digits, _)| digits), leading.map(|(_, shift)| shift))
        };
        over / under * 2f64.powi((self.exponent + above - below) as i32)
    }
}

/// The leading 64 binary digits, and how many follow.
fn leading(x: &BigInt) -> (f64, i64) {
    let shift = x.bits().saturating_sub(64);
    let digits = i128::try_from(x >> shift).expect("at most 64 digits and a sign");
    (digits as f64, shift as i64)
}

/// The largest power of two that a finite number is a multiple of; of 0 it is 2^0.
fn exponent(x: f64) -> i32 {
    if x == 0.0 {
        return 0;
    }
    let (mantissa, exponent) = parts(x);
    exponent + mantissa.trailing_zeros() as i32
}

/// A multiple of 2^exponent, in units of it.
fn integer(x: f64, exponent: i32) -> BigInt {
    if x == 0.0 {
        return BigInt::ZERO;
    }
    let (mantissa, own) = parts(x);
    let zeros = mantissa.trailing_zeros();
    BigInt::from(mantissa >> zeros) << (own + zeros as i32 - exponent) as u32
}

/// `mantissa * 2^exponent`.
fn parts(x: f64) -> (i64, i32) {
    let bits = x.abs().to_bits();
    let (fraction, biased) = ((bits & ((1 << 52) - 1)) as i64, (bits >> 52) as i32);
    let (mantissa, exponent) = if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
    (if x < 0.0 { -mantissa } else { mantissa }, exponent)
}

fn difference(a: &Vector, b: &Vector) -> Vector {
    core::array::from_fn(|k| &a[k] - &b[k])
}

fn cross(p: &Vector, q: &Vector) -> Vector {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &p[i] * &q[j] - &p[j] * &q[i])
}

fn dot(p: &Vector, q: &Vector) -> BigInt {
    (0..3).map(|k| &p[k] * &q[k]).sum()
}
