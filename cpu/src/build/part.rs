//! The parts of triangles inside a leaf's cell.

use leafwalk_core::Frame;
use leafwalk_core::layout::{Key, LatticeBox};
use wide::{f32x4, i32x4};

use super::bounds::Bounds;
use super::clip::clipped_bounds;
use super::span::{Span, lanes};

/// The part of a triangle inside a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub(super) bounds: Bounds,
    /// Twice the middle, as seen from the root's corner.
    pub(super) centre: [f32; 4],
}

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

    /// What of a triangle lies inside the dilated cell. Binning is more generous than clipping: what only touches gets the
    /// box of the whole cell.
    ///
    /// What the padding adds outside the cell is left to the box margin.
    #[inline]
    pub(super) fn part(&self, corners: &[[f32; 3]; 3]) -> Part {
        let whole = Span::around(corners, lanes(self.root));
        if self.dilated.holds(&whole) {
            return self.inside((whole.lower + whole.upper).to_array(), steps(whole.lower), steps(whole.upper));
        }
        self.clipped(corners, &whole)
    }

    #[inline(never)]
    fn clipped(&self, corners: &[[f32; 3]; 3], whole: &Span) -> Part {
        let Some((lower, upper)) = clipped_bounds(corners, self.root, whole, &self.dilated) else {
            return Part { bounds: self.least, centre: (self.dilated.lower + self.dilated.upper).to_array() };
        };
        let centre = core::array::from_fn(|k| (lower[k] + upper[k]) as f32);
        // Exact, and what is above -1 becomes 0.
        let steps = |sides: [f64; 4]| i32x4::new(sides.map(|side| side as i32));
        self.inside(centre, steps(lower), steps(upper))
    }

    fn inside(&self, centre: [f32; 4], first: i32x4, last: i32x4) -> Part {
        Part { bounds: Bounds::of_steps(first, last).clamp(self.least, self.most), centre }
    }
}

/// The steps that hold coordinates of the root's cube, or less than one beside it.
#[inline]
fn steps(sides: f32x4) -> i32x4 {
    sides.fast_trunc_int()
}

/// The lattice steps that a triangle's block box must cover.
pub(crate) fn box_inside(frame: &Frame, cell: Key, corners: &[[f32; 3]; 3], padding: f32) -> LatticeBox {
    Cell::new(frame, cell, padding).part(corners).bounds.boxed()
}
