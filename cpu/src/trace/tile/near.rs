//! `EarliestEntry`: when the first ray of a tile enters a box, and how far along their main axis its rays look.

use leafwalk_core::contract::BOX_MARGIN;
use leafwalk_core::layout::BvhNode;
use leafwalk_core::unroll;

use super::beam::{Base, EDGE};
use super::range::Range;
use crate::lanes::Eight;
use crate::trace::packet::{PACKETS, Packet};

/// [`along`] from a base, in wide octrees; `None` where it is empty.
#[inline(always)]
pub(crate) fn along_from<L: Eight>(packets: &[Packet; PACKETS], corner: f32, base: &Base<L>) -> Option<Range<f32>> {
    let corner = L::splat(corner) - base.at[2];
    let at = |rays: &Packet, t: &[f32; 8]| {
        let place = (L::load(&rays.origin[2]) - base.at[2]) + L::load(&rays.speed) * L::load(t);
        place.max(corner).min(corner + L::splat(EDGE))
    };
    let starts = Range::of_rows(unroll!(packet in 0..8 => at(&packets[packet], &packets[packet].t_min)));
    let ends = Range::of_rows(unroll!(packet in 0..8 => at(&packets[packet], &packets[packet].t_max)));
    let range = starts.and(ends.least).and(ends.greatest).whole();
    (range.least < range.greatest).then_some(range)
}

/// Where along axis 2 rays may hit anything: inside the root, whose lower side is at `corner`, between their ends. Never
/// empty.
#[inline(always)]
pub(crate) fn along<L: Eight>(packets: &[Packet; PACKETS], corner: f32) -> Range<f32> {
    let starts = Range::of_rows(unroll!(packet in 0..8 => at::<L>(&packets[packet], &packets[packet].t_min, corner)));
    let ends = Range::of_rows(unroll!(packet in 0..8 => at::<L>(&packets[packet], &packets[packet].t_max, corner)));
    let Range { least, greatest } = starts.and(ends.least).and(ends.greatest).whole();
    // A lattice step more, which covers the rounding, too.
    Range { least: least - 1.0, greatest: greatest + 1.0 }
}

/// Where along axis 2 rays are at t', as far as it is inside the root.
#[inline(always)]
fn at<L: Eight>(rays: &Packet, t: &[f32; 8], corner: f32) -> L {
    let place = L::load(&rays.origin[2]) + L::load(&rays.speed) * L::load(t);
    place.max(L::splat(corner)).min(L::splat(corner + EDGE))
}

/// The earliest t' at which a tile's rays enter boxes: where the first of them meets their near sides along axis 2.
#[derive(Clone, Copy)]
pub(crate) struct EarliestEntry<L> {
    axis: usize,
    /// Whether rays meet the upper sides first.
    is_upper: bool,
    /// The origin closest to what lies ahead, and the box margin, as seen from the root's corner.
    origin: L,
    /// t' of a lattice step.
    inverse: Range<L>,
    /// The least of the rays' limits.
    t_min: L,
}

impl<L: Eight> EarliestEntry<L> {
    /// `corner` is where the root's lower side is along the axis.
    #[inline(always)]
    pub(crate) fn new(packets: &[Packet; PACKETS], axis: usize, is_upper: bool, corner: f32) -> Self {
        let origin = Range::of_rows(unroll!(packet in 0..8 => L::load(&packets[packet].origin[2]))).whole();
        let inverse = Range::of_rows(unroll!(packet in 0..8 => L::load(&packets[packet].inverse[axis]))).whole();
        let origin =
            if is_upper { origin.least - corner - (1.0 + BOX_MARGIN) } else { origin.greatest - corner + BOX_MARGIN };
        Self {
            axis,
            is_upper,
            origin: L::splat(origin),
            inverse: Range::splat(inverse),
            t_min: L::splat(Range::of_rows(unroll!(packet in 0..8 => L::load(&packets[packet].t_min))).whole().least),
        }
    }

    /// In wide octrees, before the lattice of a node is known: origins count from a base.
    #[inline(always)]
    pub(crate) fn wide(packets: &[Packet; PACKETS], axis: usize, is_upper: bool, base: &Base<L>) -> Self {
        let origins = unroll!(packet in 0..8 => L::load(&packets[packet].origin[2]) - base.at[2]);
        let origin = Range::of_rows(origins).whole();
        let origin = L::splat(if is_upper { origin.least } else { origin.greatest });
        Self { origin, ..Self::new(packets, axis, is_upper, 0.0) }
    }

    /// The test for the boxes of a node with a lattice.
    #[inline(always)]
    pub(crate) fn in_lattice(&self, corner: [L; 3], step: L, margin: L) -> Self {
        let away = self.origin - corner[self.axis];
        Self {
            origin: (if self.is_upper { away - step - margin } else { away + margin }) / step,
            inverse: Range { least: self.inverse.least * step, greatest: self.inverse.greatest * step },
            ..*self
        }
    }

    /// The earliest t' at the eight boxes of a node.
    #[inline(always)]
    pub(crate) fn of(&self, node: &BvhNode, order: L::Order) -> L {
        let distance = L::from_steps(&node.sides[self.axis][usize::from(self.is_upper)], order) - self.origin;
        self.t_min.max((distance * self.inverse.least).min(distance * self.inverse.greatest))
    }
}
