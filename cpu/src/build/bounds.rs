//! `Bounds`: boxes in lattice steps, eight sides at a time.

use leafwalk_core::layout::LatticeBox;
use wide::{i16x8, i32x4, i32x8};

/// A box such that the smallest around two of them is the least of each number: lower sides, nothing, upper sides
/// negated, nothing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds(i16x8);

impl Bounds {
    pub(super) const EMPTY: Self = Self(i16x8::new([i16::MAX; 8]));

    pub(super) fn new(LatticeBox { lower, upper }: LatticeBox) -> Self {
        let [a, b, c] = lower.map(|side| (side ^ 0x8000) as i16);
        let [d, e, f] = upper.map(|side| (!side ^ 0x8000) as i16);
        Self(i16x8::new([a, b, c, 0, d, e, f, 0]))
    }

    /// From the first and the last step along each axis; those above 65535 count as that.
    #[inline]
    pub(super) fn of_steps(first: i32x4, last: i32x4) -> Self {
        let sides: i32x8 = bytemuck::cast([first - i32x4::splat(0x8000), i32x4::splat(0x7fff) - last]);
        Self(i16x8::from_i32x8_saturate(sides))
    }

    pub(super) fn boxed(self) -> LatticeBox {
        let [a, b, c, _, d, e, f, _] = self.0.to_array();
        LatticeBox {
            lower: [a, b, c].map(|side| side as u16 ^ 0x8000),
            upper: [d, e, f].map(|side| !(side as u16 ^ 0x8000)),
        }
    }

    #[inline]
    pub(super) fn join(self, other: Self) -> Self {
        Self(self.0.min(other.0))
    }

    /// Each side moved into another box, which is not empty.
    pub(super) fn clamp_into(self, outer: Self) -> Self {
        let [a, b, c, _, d, e, f, _] = outer.0.to_array();
        // A side negated is the side with its bits inverted.
        let most = Self(i16x8::new([!d, !e, !f, 0, !a, !b, !c, 0]));
        self.clamp(outer, most)
    }

    /// Each side between those of two other boxes.
    #[inline]
    pub(super) fn clamp(self, least: Self, most: Self) -> Self {
        Self(self.0.max(least.0).min(most.0))
    }

    /// Half of a box's surface in square lattice steps.
    #[inline]
    pub(super) fn area(self) -> f32 {
        let [a, b, c, _, d, e, f, _] = self.0.to_array().map(i32::from);
        let [x, y, z] = [a + d, b + e, c + f].map(|extent| -extent as f32);
        x * y + y * z + z * x
    }

    /// Twice the middle, along each axis, but for a constant.
    #[inline]
    pub(super) fn centre(self) -> [i32; 3] {
        let [a, b, c, _, d, e, f, _] = self.0.to_array().map(i32::from);
        [a - d, b - e, c - f]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice_box(lower: [u16; 3], upper: [u16; 3]) -> LatticeBox {
        LatticeBox { lower, upper }
    }

    #[test]
    fn boxes_survive() {
        for (lower, upper) in [([0; 3], [u16::MAX; 3]), ([1, 2, 3], [4, 5, 6]), ([32767, 32768, 9], [32768, 65534, 9])]
        {
            let boxed = lattice_box(lower, upper);
            assert_eq!(Bounds::new(boxed).boxed(), boxed);
            let steps = |[x, y, z]: [u16; 3]| i32x4::new([x.into(), y.into(), z.into(), 0]);
            assert_eq!(Bounds::of_steps(steps(lower), steps(upper)).boxed(), boxed);
        }
        let beyond = Bounds::of_steps(i32x4::splat(7), i32x4::splat(65536));
        assert_eq!(beyond.boxed(), lattice_box([7; 3], [u16::MAX; 3]));
    }

    #[test]
    fn clamped_boxes_lie_inside() {
        let (first, last) = ([16; 3], [31; 3]);
        let (least, most) = (Bounds::new(lattice_box(first, last)), Bounds::new(lattice_box(last, first)));
        let clamp = |lower, upper| Bounds::new(lattice_box(lower, upper)).clamp(least, most).boxed();
        assert_eq!(clamp([0; 3], [40; 3]), lattice_box(first, last));
        assert_eq!(clamp([20; 3], [21; 3]), lattice_box([20; 3], [21; 3]));
        assert_eq!(clamp([0; 3], [3; 3]), lattice_box(first, first));
        let into = |lower, upper| {
            let outer = Bounds::new(lattice_box([16; 3], [31; 3]));
            Bounds::new(lattice_box(lower, upper)).clamp_into(outer).boxed()
        };
        assert_eq!(into([0; 3], [40; 3]), lattice_box([16; 3], [31; 3]));
        assert_eq!(into([15; 3], [15; 3]), lattice_box([16; 3], [16; 3]));
        assert_eq!(into([20; 3], [32; 3]), lattice_box([20; 3], [31; 3]));
    }
}
