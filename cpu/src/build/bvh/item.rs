//! What the hierarchy is made of: triangles with their boxes, and parts of them.

use leafwalk_core::layout::Triangle;
use wide::f32x4;

use crate::build::span::{Span, lanes};

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
        // As seen from the anchor, which moves nothing.
        let Span { lower, upper } = Span::around(&triangle.corners, lanes([0.0; 3]));
        let beside = |sides: f32x4, half: u32| {
            let [x, y, z, _] = sides.to_array();
            f32x4::new([x, y, z, half as f32])
        };
        Self { lower: beside(lower, number & 0xffff), upper: beside(upper, number >> 16) }
    }

    #[inline]
    pub(super) fn bounds(&self) -> Span {
        Span { lower: self.lower, upper: self.upper }
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
    pub(super) bounds: Span,
    pub(super) items: &'a mut [Item],
}

impl<'a> Part<'a> {
    pub(super) fn new(items: &'a mut [Item]) -> Self {
        let bounds = items.iter().fold(Span::EMPTY, |bounds, item| bounds.join(item.bounds()));
        Self { bounds, items }
    }
}
