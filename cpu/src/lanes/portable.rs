//! Lanes over `wide`, which picks registers when it is compiled: SSE2, AVX2, NEON, wasm.

use core::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Not, Shl, Shr, Sub};

use leafwalk_core::lanes::{Bits, Lanes, Mask};
use wide::{f32x8, u32x8};

use super::Eight;

/// Eight numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Portable(f32x8);

/// Eight truth values, all ones or zero.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PortableMask(f32x8);

/// Eight integers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PortableBits(u32x8);

/// 2^23: a float of this exponent holds an integer below it in its low bits.
const MAGIC: f32 = (1 << 23) as f32;

macro_rules! operators {
    ($kind:ident: $($trait:ident $method:ident),*) => {$(
        impl $trait for $kind {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self($trait::$method(self.0, other.0))
            }
        }
    )*};
}
operators!(Portable: Add add, Sub sub, Mul mul, Div div);
operators!(PortableMask: BitAnd bitand, BitOr bitor);
operators!(PortableBits: BitAnd bitand, BitOr bitor, BitXor bitxor, Shl shl, Shr shr);

impl Not for PortableMask {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl Not for PortableBits {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl Mask for PortableMask {
    #[inline(always)]
    fn any(self) -> bool {
        self.0.any()
    }
    #[inline(always)]
    fn to_bits(self) -> u32 {
        self.0.to_bitmask()
    }
}

impl Bits for PortableBits {
    #[inline(always)]
    fn splat(value: u32) -> Self {
        Self(u32x8::splat(value))
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.0 != u32x8::splat(0)
    }
}

impl Lanes for Portable {
    type Mask = PortableMask;
    type Bits = PortableBits;
    const COUNT: usize = 8;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self(f32x8::splat(value))
    }
    #[inline(always)]
    fn less(self, other: Self) -> PortableMask {
        PortableMask(self.0.simd_lt(other.0))
    }
    #[inline(always)]
    fn at_most(self, other: Self) -> PortableMask {
        PortableMask(self.0.simd_le(other.0))
    }
    #[inline(always)]
    fn equal(self, other: Self) -> PortableMask {
        PortableMask(self.0.simd_eq(other.0))
    }
    #[inline(always)]
    fn or_else(self, mask: PortableMask, other: Self) -> Self {
        Self(mask.0.select(self.0, other.0))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }
    #[inline(always)]
    fn bits(self) -> PortableBits {
        PortableBits(bytemuck::cast(self.0))
    }
    #[inline(always)]
    fn from_bits(bits: PortableBits) -> Self {
        Self(bytemuck::cast(bits.0))
    }
    #[inline(always)]
    fn from_integers(integers: PortableBits) -> Self {
        let shifted = integers | PortableBits::splat(MAGIC.to_bits());
        Self::from_bits(shifted) - Self::splat(MAGIC)
    }
    #[inline(always)]
    fn indicator(mask: PortableMask) -> PortableBits {
        Self(mask.0).bits() & PortableBits::splat(1)
    }
    #[inline(always)]
    fn below(a: PortableBits, b: PortableBits) -> PortableMask {
        PortableMask(bytemuck::cast(a.0.simd_lt(b.0)))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0.fast_min(other.0))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0.fast_max(other.0))
    }
}

impl Eight for Portable {
    const PREFETCHES: bool = false;
    const IS_BY_SLOT: bool = true;
    type Order = ();

    #[inline(always)]
    fn load(values: &[f32; 8]) -> Self {
        Self(f32x8::new(*values))
    }
    #[inline(always)]
    fn order(_: u32) {}
    #[inline(always)]
    fn from_steps(steps: &[u16; 8], (): ()) -> Self {
        Self::from_integers(PortableBits(u32x8::new(steps.map(u32::from))))
    }
    #[inline(always)]
    fn permute_lanes(self, lanes: &[u8; 8], flip: u32) -> Self {
        let from = self.to_array();
        let mut to = [0.0; 8];
        for (to, lane) in to.iter_mut().zip(lanes) {
            *to = from[(u32::from(*lane) ^ flip) as usize & 7];
        }
        Self::load(&to)
    }
    #[inline(always)]
    fn transpose(rows: [Self; 8]) -> [Self; 8] {
        f32x8::transpose(rows.map(|row| row.0)).map(Self)
    }
    #[inline(always)]
    fn prefetch<T>(_: &T) {}
    #[inline(always)]
    fn to_array(self) -> [f32; 8] {
        self.0.to_array()
    }
}
