//! f32 with its arithmetic broken in one place, to run the triangle test on.
//!
//! The triangle test is generic over [`Lanes`], so it runs on a [`Number`] as it runs on `f32`. An [`Arithmetic`] says
//! what is broken. To break a product and the sum after it as a compiler does that fuses them, a number remembers the two
//! factors it is the product of; the sum then takes them instead of the rounded product.

use core::marker::PhantomData;
use core::ops::{Add, Div, Mul, Sub};

use leafwalk_core::lanes::Lanes;

/// Says what is broken; by default nothing is.
pub trait Arithmetic: Copy + Sync + Send {
    /// Products have error terms.
    const KEEPS_ERRORS: bool = true;
    /// `a < b` does not hold for equal numbers.
    const KEEPS_STRICT: bool = true;
    /// A sum or difference of which one term is a product rounds once, as compilers for GPUs make it, and so does the
    /// comparison of two products, which such a compiler makes a difference.
    const CONTRACTS: bool = false;
    /// Numbers whose products have no exact error terms are taken for 0.
    const FLUSHES: bool = true;
}

/// Arithmetic in which nothing is broken.
#[derive(Clone, Copy)]
pub struct Sound;
impl Arithmetic for Sound {}

/// Products have no error terms, so the differences of products in the exact finish are plain ones.
#[derive(Clone, Copy)]
pub struct Plain;
impl Arithmetic for Plain {
    const KEEPS_ERRORS: bool = false;
}

/// `<=` for `<`: where a weight must not be negative, 0 is out.
#[derive(Clone, Copy)]
pub struct Lax;
impl Arithmetic for Lax {
    const KEEPS_STRICT: bool = false;
}

/// A product and the sum it goes into round once, as a fused multiply-add.
#[derive(Clone, Copy)]
pub struct Fused;
impl Arithmetic for Fused {
    const CONTRACTS: bool = true;
}

/// A number that remembers the factors it is the product of.
#[derive(Clone, Copy)]
pub struct Number<A> {
    value: f32,
    factors: Option<(f32, f32)>,
    kind: PhantomData<A>,
}

impl<A: Arithmetic> Number<A> {
    fn of(value: f32) -> Self {
        Self { value, factors: None, kind: PhantomData }
    }

    fn plus(self, other: Self, sign: f32) -> f32 {
        match (self.factors, other.factors) {
            (Some((a, b)), _) if A::CONTRACTS => a.mul_add(b, sign * other.value),
            (_, Some((a, b))) if A::CONTRACTS => (sign * a).mul_add(b, self.value),
            _ => self.value + sign * other.value,
        }
    }
}

impl<A: Arithmetic> Add for Number<A> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::of(self.plus(other, 1.0))
    }
}

impl<A: Arithmetic> Sub for Number<A> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::of(self.plus(other, -1.0))
    }
}

impl<A: Arithmetic> Mul for Number<A> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self { factors: Some((self.value, other.value)), ..Self::of(self.value * other.value) }
    }
}

impl<A: Arithmetic> Div for Number<A> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        Self::of(self.value / other.value)
    }
}

impl<A: Arithmetic> Lanes for Number<A> {
    type Mask = bool;
    type Bits = u32;
    const COUNT: usize = 1;

    fn splat(value: f32) -> Self {
        Self::of(value)
    }
    fn less(self, other: Self) -> bool {
        if A::KEEPS_STRICT { self.value < other.value } else { self.value <= other.value }
    }
    fn at_most(self, other: Self) -> bool {
        match A::CONTRACTS {
            true => other.plus(self, -1.0) >= 0.0,
            false => self.value <= other.value,
        }
    }
    fn equal(self, other: Self) -> bool {
        self.value == other.value
    }
    fn or_else(self, mask: bool, other: Self) -> Self {
        if mask { self } else { other }
    }
    fn abs(self) -> Self {
        Self::of(self.value.abs())
    }
    fn bits(self) -> u32 {
        self.value.to_bits()
    }
    fn from_bits(bits: u32) -> Self {
        Self::of(f32::from_bits(bits))
    }
    fn from_integers(integers: u32) -> Self {
        Self::of(integers as f32)
    }
    fn indicator(mask: bool) -> u32 {
        u32::from(mask)
    }
    fn below(a: u32, b: u32) -> bool {
        a < b
    }
    fn product_error(self, other: Self, product: Self) -> Self {
        let error = self.value.product_error(other.value, product.value);
        Self::of(if A::KEEPS_ERRORS { error } else { 0.0 })
    }
    fn flush(self, smallest: f32) -> Self {
        if A::FLUSHES { Self::of(self.value.flush(smallest)) } else { self }
    }
}
