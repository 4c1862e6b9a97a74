//! What the hierarchy is made of: triangles with their boxes, and boxes four numbers at a time.

use leafwalk_core::layout::Triangle;
use wide::f32x4;

/// A box in lattice coordinates; the fourth lanes mean nothing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Box3 {
    pub(super) lower: f32x4,
    pub(super) upper: f32x4,
}

impl Box3 {
    pub(super) const EMPTY: Self =
        Self { lower: f32x4::new([f32::INFINITY; 4]), upper: f32x4::new([f32::NEG_INFINITY; 4]) };

    #[inline]
    pub(super) fn join(self, other: Self) -> Self {
        Self { lower: self.lower.fast_min(other.lower), upper: self.upper.fast_max(other.upper) }
    }

    /// Half of a box's surface in square lattice steps.
    #[inline]
    pub(super) fn area(self) -> f32 {
        let [x, y, z, _] = (self.upper - self.lower).to_array();
        x * y + y * z + z * x
    }
}

/// A triangle to be put somewhere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    /// The lower corner of its box, and the low half of the triangle's place in the list of all, as a number.
    lower: f32x4,
    /// The upper corner, and the high half.
    upper: f32x4,
}

impl Item {
    pub(super) fn new(number: u32, triangle: &Triangle) -> Self {
        let [a, b, c] = triangle.corners.map(|[x, y, z]| f32x4::new([x, y, z, 0.0]));
        let half = |half: u32| f32x4::new([0.0, 0.0, 0.0, half as f32]);
        Self {
            lower: a.fast_min(b).fast_min(c) + half(number & 0xffff),
            upper: a.fast_max(b).fast_max(c) + half(number >> 16),
        }
    }

    #[inline]
    pub(super) fn bounds(&self) -> Box3 {
        Box3 { lower: self.lower, upper: self.upper }
    }

    /// Twice the centre of the box; the fourth lane means nothing.
    #[inline]
    pub(super) fn centre(&self) -> f32x4 {
        self.lower + self.upper
    }

    #[inline]
    pub(super) fn triangle(&self) -> u32 {
        let half = |lanes: f32x4| lanes.to_array()[3] as u32;
        half(self.lower) | half(self.upper) << 16
    }
}

/// Some triangles and the box around them.
pub(super) struct Part<'a> {
    pub(super) bounds: Box3,
    pub(super) items: &'a mut [Item],
}

impl<'a> Part<'a> {
    pub(super) fn new(items: &'a mut [Item]) -> Self {
        let bounds = items.iter().fold(Box3::EMPTY, |bounds, item| bounds.join(item.bounds()));
        Self { bounds, items }
    }
}
