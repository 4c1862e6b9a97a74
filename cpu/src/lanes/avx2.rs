//! Lanes over AVX2 and FMA, found at run time: who adds this crate without a compiler flag gets them too.
#![allow(unsafe_code, reason = "instructions of a register set that the compiler may not assume")]
// SAFETY of every block here: the intrinsics need AVX2 and FMA and nothing else, bar loads and stores, whose pointers
// come from references to eight elements. `Avx2` is private to this file, and only `Available::run` names it; an
// `Available` comes from its detection alone. The figure that justifies the file: see docs/choices.md, "Registers".
#![allow(clippy::undocumented_unsafe_blocks, reason = "one argument covers all, above")]

use core::arch::x86_64::*;
use core::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Not, Shl, Shr, Sub};

use leafwalk_core::lanes::{Bits, Lanes, Mask};

use super::{Eight, Kernel};

/// Proof that this machine has what [`Avx2`] needs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Available(());

impl Available {
    pub(super) fn detect() -> Option<Self> {
        let is_available = std::arch::is_x86_feature_detected!("avx2")
            && std::arch::is_x86_feature_detected!("fma")
            && std::arch::is_x86_feature_detected!("bmi1")
            && std::arch::is_x86_feature_detected!("bmi2")
            && std::arch::is_x86_feature_detected!("lzcnt")
            && std::arch::is_x86_feature_detected!("popcnt");
        is_available.then_some(Self(()))
    }

    /// Runs a kernel compiled for AVX2.
    #[inline]
    pub(super) fn run<K: Kernel>(self, kernel: K) -> K::Output {
        #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
        fn with_avx2<K: Kernel>(kernel: K) -> K::Output {
            kernel.run::<Avx2>()
        }
        unsafe { with_avx2(kernel) }
    }
}

/// Eight numbers.
#[derive(Clone, Copy, Debug)]
struct Avx2(__m256);

/// Eight truth values, all ones or zero.
#[derive(Clone, Copy, Debug)]
struct Avx2Mask(__m256);

/// Eight integers.
#[derive(Clone, Copy, Debug)]
struct Avx2Bits(__m256i);

macro_rules! operators {
    ($kind:ident: $($trait:ident $method:ident $intrinsic:ident),*) => {$(
        impl $trait for $kind {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    )*};
}
operators!(Avx2: Add add _mm256_add_ps, Sub sub _mm256_sub_ps, Mul mul _mm256_mul_ps, Div div _mm256_div_ps);
operators!(Avx2Mask: BitAnd bitand _mm256_and_ps, BitOr bitor _mm256_or_ps);
operators!(Avx2Bits: BitAnd bitand _mm256_and_si256, BitOr bitor _mm256_or_si256, BitXor bitxor _mm256_xor_si256,
    Shl shl _mm256_sllv_epi32, Shr shr _mm256_srlv_epi32);

impl Not for Avx2Mask {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(unsafe { _mm256_xor_ps(self.0, _mm256_castsi256_ps(_mm256_set1_epi32(-1))) })
    }
}

impl Not for Avx2Bits {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(unsafe { _mm256_xor_si256(self.0, _mm256_set1_epi32(-1)) })
    }
}

impl Mask for Avx2Mask {
    #[inline(always)]
    fn any(self) -> bool {
        self.to_bits() != 0
    }
    #[inline(always)]
    fn to_bits(self) -> u32 {
        unsafe { _mm256_movemask_ps(self.0) as u32 }
    }
}

impl Bits for Avx2Bits {
    #[inline(always)]
    fn splat(value: u32) -> Self {
        Self(unsafe { _mm256_set1_epi32(value as i32) })
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self(unsafe { _mm256_add_epi32(self.0, other.0) })
    }
    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        Self(unsafe { _mm256_sub_epi32(self.0, other.0) })
    }
    #[inline(always)]
    fn any(self) -> bool {
        unsafe { _mm256_testz_si256(self.0, self.0) == 0 }
    }
}

impl Lanes for Avx2 {
    type Mask = Avx2Mask;
    type Bits = Avx2Bits;
    const COUNT: usize = 8;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self(unsafe { _mm256_set1_ps(value) })
    }
    #[inline(always)]
    fn less(self, other: Self) -> Avx2Mask {
        Avx2Mask(unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0) })
    }
    #[inline(always)]
    fn at_most(self, other: Self) -> Avx2Mask {
        Avx2Mask(unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0) })
    }
    #[inline(always)]
    fn equal(self, other: Self) -> Avx2Mask {
        Avx2Mask(unsafe { _mm256_cmp_ps::<_CMP_EQ_OQ>(self.0, other.0) })
    }
    #[inline(always)]
    fn or_else(self, mask: Avx2Mask, other: Self) -> Self {
        Self(unsafe { _mm256_blendv_ps(other.0, self.0, mask.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }
    #[inline(always)]
    fn bits(self) -> Avx2Bits {
        Avx2Bits(unsafe { _mm256_castps_si256(self.0) })
    }
    #[inline(always)]
    fn from_bits(bits: Avx2Bits) -> Self {
        Self(unsafe { _mm256_castsi256_ps(bits.0) })
    }
    #[inline(always)]
    fn from_integers(integers: Avx2Bits) -> Self {
        Self(unsafe { _mm256_cvtepi32_ps(integers.0) })
    }
    #[inline(always)]
    fn indicator(mask: Avx2Mask) -> Avx2Bits {
        Avx2Bits(unsafe { _mm256_srli_epi32::<31>(_mm256_castps_si256(mask.0)) })
    }
    #[inline(always)]
    fn below(a: Avx2Bits, b: Avx2Bits) -> Avx2Mask {
        // Numbers of 32 bits compare like signed ones whose order starts with the upper half.
        let upper = Avx2Bits::splat(1 << 31);
        Avx2Mask(unsafe { _mm256_castsi256_ps(_mm256_cmpgt_epi32((b ^ upper).0, (a ^ upper).0)) })
    }
    // Both give the second operand where neither is smaller, as the default does.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(unsafe { _mm256_min_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(unsafe { _mm256_max_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn about_mul_add(self, factor: Self, addend: Self) -> Self {
        Self(unsafe { _mm256_fmadd_ps(self.0, factor.0, addend.0) })
    }
    #[inline(always)]
    fn product_error(self, other: Self, product: Self) -> Self {
        Self(unsafe { _mm256_fmsub_ps(self.0, other.0, product.0) })
    }
    #[inline(always)]
    fn flush(self, smallest: f32) -> Self {
        let is_small = self.abs().less(Self::splat(smallest));
        Self(unsafe { _mm256_andnot_ps(is_small.0, self.0) })
    }
}

impl Eight for Avx2 {
    const PREFETCHES: bool = true;
    const IS_BY_SLOT: bool = false;
    type Order = Avx2Bits;

    #[inline(always)]
    fn load(values: &[f32; 8]) -> Self {
        Self(unsafe { _mm256_loadu_ps(values.as_ptr()) })
    }
    #[inline(always)]
    fn order(neg: u32) -> Avx2Bits {
        // Each lane takes the two bytes of its slot, then zeros, which stand where a byte's number is negative.
        let slots =
            unsafe { _mm256_xor_si256(_mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7), _mm256_set1_epi32(neg as i32)) };
        let low = unsafe { _mm256_add_epi32(slots, slots) };
        Avx2Bits(unsafe {
            _mm256_or_si256(
                _mm256_or_si256(low, _mm256_slli_epi32::<8>(low)),
                _mm256_set1_epi32(0x8080_0100_u32 as i32),
            )
        })
    }
    #[inline(always)]
    fn from_steps(steps: &[u16; 8], order: Avx2Bits) -> Self {
        Self(unsafe {
            let steps = _mm256_broadcastsi128_si256(_mm_loadu_si128(steps.as_ptr().cast()));
            _mm256_cvtepi32_ps(_mm256_shuffle_epi8(steps, order.0))
        })
    }
    #[inline(always)]
    fn permute_lanes(self, lanes: &[u8; 8], flip: u32) -> Self {
        let lanes = unsafe { _mm256_cvtepu8_epi32(_mm_loadl_epi64(lanes.as_ptr().cast())) };
        Self(unsafe { _mm256_permutevar8x32_ps(self.0, _mm256_xor_si256(lanes, _mm256_set1_epi32(flip as i32))) })
    }
    #[inline(always)]
    fn transpose(rows: [Self; 8]) -> [Self; 8] {
        let [a, b, c, d, e, f, g, h] = rows;
        // Two by two, four by four, then across the halves of the registers.
        macro_rules! pairs {
            ($low:ident $high:ident: $($x:ident $y:ident),*) => {
                unsafe { [$($low($x.0, $y.0), $high($x.0, $y.0)),*] }
            };
        }
        let [ab, ab2, cd, cd2, ef, ef2, gh, gh2] = pairs!(_mm256_unpacklo_ps _mm256_unpackhi_ps: a b, c d, e f, g h);
        let four = |x, y| unsafe { [_mm256_shuffle_ps::<0x44>(x, y), _mm256_shuffle_ps::<0xee>(x, y)] };
        let ([k, l], [m, n], [o, p], [q, r]) = (four(ab, cd), four(ab2, cd2), four(ef, gh), four(ef2, gh2));
        unsafe {
            [
                Self(_mm256_permute2f128_ps::<0x20>(k, o)),
                Self(_mm256_permute2f128_ps::<0x20>(l, p)),
                Self(_mm256_permute2f128_ps::<0x20>(m, q)),
                Self(_mm256_permute2f128_ps::<0x20>(n, r)),
                Self(_mm256_permute2f128_ps::<0x31>(k, o)),
                Self(_mm256_permute2f128_ps::<0x31>(l, p)),
                Self(_mm256_permute2f128_ps::<0x31>(m, q)),
                Self(_mm256_permute2f128_ps::<0x31>(n, r)),
            ]
        }
    }
    #[inline(always)]
    fn prefetch<T>(item: &T) {
        const LINE: usize = 64;
        let start: *const i8 = core::ptr::from_ref(item).cast();
        for offset in (0..size_of::<T>()).step_by(LINE) {
            unsafe { _mm_prefetch::<_MM_HINT_T0>(start.wrapping_add(offset)) };
        }
    }
    #[inline(always)]
    fn to_array(self) -> [f32; 8] {
        let mut values = [0.0; 8];
        unsafe { _mm256_storeu_ps(values.as_mut_ptr(), self.0) };
        values
    }
}
