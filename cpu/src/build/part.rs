//! The parts of triangles inside a leaf's cell.

use leafwalk_core::Frame;
use leafwalk_core::layout::{Key, LatticeBox};
use wide::i32x4;

use super::bounds::Bounds;
use super::clip::clipped_bounds;
use super::span::{Span, lanes, steps};

/// A leaf's cell.
pub(super) struct Cell {
    /// The root's corner.
    root: [f32; 3],
    dilated: Span,
    /// The sides that boxes inside it may have.
    least: Bounds,
    most: Bounds,
}

impl Cell {
    pub(super) fn new(frame: &Frame, key: Key, padding: f32) -> Self {
        let (lower, upper) = key.bounds();
        let (first, last) = (key.corner.map(|c| c as u16), key.corner.map(|c| (c + key.size() - 1) as u16));
        Self {
            root: frame.corner,
            dilated: Span::new(lower.map(|c| c - padding), upper.map(|c| c + padding)),
            least: Bounds::new(LatticeBox { lower: first, upper: last }),
            most: Bounds::new(LatticeBox { lower: last, upper: first }),
        }
    }

    /// The box of what of a triangle lies inside the dilated cell. Binning is more generous than clipping: of what only
    /// touches, the box of all of it counts.
    ///
    /// What the padding adds outside the cell is left to the box margin.
    #[inline]
    pub(super) fn part(&self, corners: &[[f32; 3]; 3]) -> Bounds {
        let whole = Span::around(corners, lanes(self.root));
        if self.dilated.holds(&whole) {
            return self.inside(steps(whole.lower), steps(whole.upper));
        }
        self.clipped(corners, &whole)
    }

    #[inline(never)]
    fn clipped(&self, corners: &[[f32; 3]; 3], whole: &Span) -> Bounds {
        let whole_steps = self.inside(steps(whole.lower), steps(whole.upper));
        let Some((lower, upper)) = clipped_bounds(corners, self.root, whole, &self.dilated) else { return whole_steps };
        // Exact, and what is above -1 becomes 0.
        let steps = |sides: [f64; 4]| i32x4::new(sides.map(|side| side as i32));
        // Corners that were cut off lie a rounding off the whole triangle's box.
        self.inside(steps(lower), steps(upper)).clamp_into(whole_steps)
    }

    fn inside(&self, first: i32x4, last: i32x4) -> Bounds {
        Bounds::of_steps(first, last).clamp(self.least, self.most)
    }
}

/// The lattice steps that a triangle's block box must cover.
pub(crate) fn box_inside(frame: &Frame, cell: Key, corners: &[[f32; 3]; 3], padding: f32) -> LatticeBox {
    Cell::new(frame, cell, padding).part(corners).boxed()
}
