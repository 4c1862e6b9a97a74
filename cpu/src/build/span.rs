//! `Span`: boxes, all axes at a time.

use wide::{f32x4, i32x4};

/// A box; the fourth lane means nothing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub(super) lower: f32x4,
    pub(super) upper: f32x4,
}

impl Span {
    pub(super) const EMPTY: Self =
        Self { lower: f32x4::new([f32::INFINITY; 4]), upper: f32x4::new([f32::NEG_INFINITY; 4]) };

    pub(super) fn new(lower: [f32; 3], upper: [f32; 3]) -> Self {
        Self { lower: lanes(lower), upper: lanes(upper) }
    }

    /// Around corners in lattice coordinates, as seen from the root's corner or any other point.
    #[inline]
    pub(super) fn around(corners: &[[f32; 3]; 3], from: f32x4) -> Self {
        // Corners one behind the other are loaded at once, with the first number of the next.
        let &[a0, a1, a2, b0, b1, b2, c0, c1, c2] = corners.as_flattened() else { unreachable!("nine numbers") };
        let (a, b) = (f32x4::new([a0, a1, a2, b0]), f32x4::new([b0, b1, b2, c0]));
        let c = lanes([c0, c1, c2]);
        Self { lower: a.fast_min(b).fast_min(c) - from, upper: a.fast_max(b).fast_max(c) - from }
    }

    /// The smallest box around both.
    #[inline]
    pub(super) fn join(self, other: Self) -> Self {
        Self { lower: self.lower.fast_min(other.lower), upper: self.upper.fast_max(other.upper) }
    }

    /// Its lower and its upper corner.
    pub(super) fn corners(self) -> [[f32; 3]; 2] {
        [self.lower, self.upper].map(|corner| {
            let [x, y, z, _] = corner.to_array();
            [x, y, z]
        })
    }

    /// Half of the surface in square lattice steps.
    #[inline]
    pub(super) fn area(self) -> f32 {
        let [x, y, z, _] = (self.upper - self.lower).to_array();
        x * y + y * z + z * x
    }

    /// Whether another box reaches nowhere out of this one.
    #[inline]
    pub(super) fn holds(&self, other: &Self) -> bool {
        axes(other.lower.simd_ge(self.lower) & other.upper.simd_le(self.upper)) == 7
    }
}

#[inline]
pub(super) fn lanes([x, y, z]: [f32; 3]) -> f32x4 {
    f32x4::new([x, y, z, 0.0])
}

/// The steps that hold coordinates of the root's cube, or less than one beside it.
#[inline]
pub(super) fn steps(sides: f32x4) -> i32x4 {
    sides.fast_trunc_int()
}

/// The axes whose lanes are set, as bits.
#[inline]
pub(super) fn axes(set: f32x4) -> usize {
    set.to_bitmask() as usize & 7
}
