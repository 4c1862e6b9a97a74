//! `Departure`: the ways in which a driver may depart from arithmetic that rounds every operation once, to nearest, and
//! the cases that show each.
//!
//! WGSL allows all of them: see "Floating Point Evaluation" in *WebGPU Shading Language*, W3C,
//! <https://www.w3.org/TR/WGSL/#floating-point-evaluation>.

use leafwalk_core::lanes::Lanes;

/// Cases that are tried of each departure.
pub(super) const CASES: u32 = 1024;

/// A way in which a driver may depart from arithmetic that rounds every operation once, to nearest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Departure {
    /// `a * b + c` is rounded once instead of twice.
    Contraction,
    /// `(a + b) - b` is taken for `a`.
    Reassociation,
    /// A quotient is not the nearest number.
    Division,
    /// The error term of a product, `a * b` less its rounded value, is not exact.
    ErrorTerm,
    /// A subnormal result is taken for 0. No hit depends on such a result.
    Subnormals,
}

impl Departure {
    pub(super) const ALL: [Self; 5] =
        [Self::Contraction, Self::Reassociation, Self::Division, Self::ErrorTerm, Self::Subnormals];

    /// What it is, in a few words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Contraction => "fused products",
            Self::Reassociation => "regrouped sums",
            Self::Division => "rough quotients",
            Self::ErrorTerm => "error terms of products",
            Self::Subnormals => "flushed subnormals",
        }
    }

    /// Whether hits change with it.
    pub(super) const fn matters(self) -> bool {
        !matches!(self, Self::Subnormals)
    }

    /// Where among a case's results the kernel `self_test` puts the plain expression, and where the flavour's.
    pub(super) const fn results(self) -> [usize; 2] {
        match self {
            Self::Contraction | Self::Subnormals => [0, 3],
            Self::Reassociation => [1, 4],
            Self::Division => [2, 5],
            Self::ErrorTerm => [6, 6],
        }
    }

    /// The numbers a, b and c of case `at`, chosen so that a driver that departs in this way shows it.
    pub(super) fn case(self, at: u32) -> [f32; 3] {
        let [a, b] = [mixed(2 * at), mixed(2 * at + 1)];
        match self {
            // c takes the product away, but for what its rounding left.
            Self::Contraction | Self::ErrorTerm => [a, b, -(a * b)],
            Self::Reassociation => [a, b * 1000.0, 0.0],
            // Quotients of all sizes and signs.
            Self::Division => [a * 2f32.powi(at as i32 % 90 - 45), if at & 1 == 0 { b } else { -b }, 0.0],
            Self::Subnormals => [a * f32::MIN_POSITIVE, 0.125 * b, 0.0],
        }
    }

    /// What the CPU computes for a case.
    pub(super) fn expected(self, [a, b, c]: [f32; 3]) -> f32 {
        match self {
            Self::Contraction | Self::Subnormals => a * b + c,
            Self::Reassociation => (a + b) - b,
            Self::Division => a / b,
            Self::ErrorTerm => a.product_error(b, a * b),
        }
    }
}

/// A number in 1..2 with a mantissa that looks random, made of a number by the finalizer of MurmurHash3 (A. Appleby,
/// *MurmurHash3*, <https://github.com/aappleby/smhasher/blob/master/src/MurmurHash3.cpp>).
fn mixed(seed: u32) -> f32 {
    let mut x = seed.wrapping_add(1).wrapping_mul(0x9e37_79b9);
    x = (x ^ x >> 16).wrapping_mul(0x85eb_ca6b);
    x = (x ^ x >> 13).wrapping_mul(0xc2b2_ae35);
    f32::from_bits(0x3f80_0000 | (x ^ x >> 16) >> 9)
}
