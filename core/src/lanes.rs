//! `Lanes`: n rays, or n triangles, in lockstep. The step and the triangle test are written once, for any width.

use core::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Not, Shl, Shr, Sub};

/// The bits of a number's sign, exponent and upper half: of such halves products are exact.
pub const HEAD: u32 = 0xffff_f000;

/// One truth value a lane.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// Whether any lane is true.
    fn any(self) -> bool;
    /// Lane k as bit k.
    fn to_bits(self) -> u32;
}

/// One `u32` a lane.
pub trait Bits:
    Copy
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + BitXor<Output = Self>
    + Not<Output = Self>
    + Shl<Output = Self>
    + Shr<Output = Self>
{
    /// Lanes that all hold one value.
    fn splat(value: u32) -> Self;
    /// The sum, modulo 2^32.
    fn plus(self, other: Self) -> Self;
    /// The difference, modulo 2^32.
    fn minus(self, other: Self) -> Self;
    /// Whether any lane is not zero.
    fn any(self) -> bool;

    /// All ones where the lane is 1, zero where it is 0.
    #[inline(always)]
    fn spread(self) -> Self {
        Self::splat(0).minus(self)
    }
}

/// One `f32` a lane, with IEEE 754 arithmetic: every operation rounds once, to nearest, and is never fused.
pub trait Lanes: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> {
    /// Truth values.
    type Mask: Mask;
    /// Integers.
    type Bits: Bits;
    /// How many lanes.
    const COUNT: usize;

    /// Lanes that all hold one value.
    fn splat(value: f32) -> Self;
    /// `self < other`.
    fn less(self, other: Self) -> Self::Mask;
    /// `self <= other`.
    fn at_most(self, other: Self) -> Self::Mask;
    /// `self == other`.
    fn equal(self, other: Self) -> Self::Mask;
    /// `self` where the mask is true, else `other`.
    fn or_else(self, mask: Self::Mask, other: Self) -> Self;
    /// The magnitude.
    fn abs(self) -> Self;
    /// The bit patterns.
    fn bits(self) -> Self::Bits;
    /// The numbers of bit patterns.
    fn from_bits(bits: Self::Bits) -> Self;
    /// Integers below 2^23 as numbers: exact.
    fn from_integers(integers: Self::Bits) -> Self;
    /// 1 where the mask is true, else 0.
    fn indicator(mask: Self::Mask) -> Self::Bits;
    /// `a < b`.
    fn below(a: Self::Bits, b: Self::Bits) -> Self::Mask;

    /// `self * factor + addend`, rounded once or twice as is faster: for conservative tests alone.
    #[inline(always)]
    fn about_mul_add(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }

    /// The smaller of two numbers.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.or_else(self.less(other), other)
    }

    /// The larger of two numbers.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.or_else(other.less(self), other)
    }

    /// `self * other - product` without error, given `product = fl(self * other)` (Dekker 1971).
    ///
    /// Halves of 12 bits have exact products. A fused multiply-add gives the same bits and may stand in.
    #[inline(always)]
    fn product_error(self, other: Self, product: Self) -> Self {
        let head = Self::Bits::splat(HEAD);
        let (a1, b1) = (Self::from_bits(self.bits() & head), Self::from_bits(other.bits() & head));
        let (a2, b2) = (self - a1, other - b1);
        a2 * b2 - (((product - a1 * b1) - a2 * b1) - a1 * b2)
    }

    /// 0 where the magnitude is under `smallest`.
    #[inline(always)]
    fn flush(self, smallest: f32) -> Self {
        Self::splat(0.0).or_else(self.abs().less(Self::splat(smallest)), self)
    }
}

impl Mask for bool {
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
    #[inline(always)]
    fn to_bits(self) -> u32 {
        u32::from(self)
    }
}

impl Bits for u32 {
    #[inline(always)]
    fn splat(value: u32) -> Self {
        value
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self.wrapping_add(other)
    }
    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        self.wrapping_sub(other)
    }
    #[inline(always)]
    fn any(self) -> bool {
        self != 0
    }
}

impl Lanes for f32 {
    type Mask = bool;
    type Bits = u32;
    const COUNT: usize = 1;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        value
    }
    #[inline(always)]
    fn less(self, other: Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn at_most(self, other: Self) -> bool {
        self <= other
    }
    #[inline(always)]
    fn equal(self, other: Self) -> bool {
        self == other
    }
    #[inline(always)]
    fn or_else(self, mask: bool, other: Self) -> Self {
        if mask { self } else { other }
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f32::abs(self)
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        self.to_bits()
    }
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        f32::from_bits(bits)
    }
    #[inline(always)]
    fn from_integers(integers: u32) -> Self {
        integers as f32
    }
    #[inline(always)]
    fn indicator(mask: bool) -> u32 {
        u32::from(mask)
    }
    #[inline(always)]
    fn below(a: u32, b: u32) -> bool {
        a < b
    }
}
