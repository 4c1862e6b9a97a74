//! `EarliestEntry`: when the first ray of a tile enters a box, and how far along their main axis its rays look.

use leafwalk_core::contract::BOX_MARGIN;
use leafwalk_core::layout::BvhNode;
use leafwalk_core::unroll;

use super::beam::STEPS;
use super::range::Range;
use crate::lanes::Eight;
use crate::trace::packet::{PACKETS, Packet};

/// Where along axis 2 rays may hit anything: inside the root, between their ends. Never empty.
#[inline(always)]
pub(crate) fn along<L: Eight>(packets: &[Packet; PACKETS]) -> Range<f32> {
    let starts = Range::of_rows(unroll!(packet in 0..8 => at::<L>(&packets[packet], &packets[packet].t_min)));
    let ends = Range::of_rows(unroll!(packet in 0..8 => at::<L>(&packets[packet], &packets[packet].t_max)));
    let Range { least, greatest } = starts.and(ends.least).and(ends.greatest).whole();
    // A lattice step more, which covers the rounding, too.
    Range { least: least - 1.0 / STEPS, greatest: greatest + 1.0 / STEPS }
}

/// Where along axis 2 rays are at t', as far as it is inside the root.
#[inline(always)]
fn at<L: Eight>(rays: &Packet, t: &[f32; 8]) -> L {
    (L::load(&rays.origin[2]) + L::load(&rays.speed) * L::load(t)).max(L::splat(0.0)).min(L::splat(1.0))
}

/// The earliest t' at which a tile's rays enter boxes: where the first of them meets their near sides along axis 2.
pub(crate) struct EarliestEntry<L> {
    axis: usize,
    /// Whether rays meet the upper sides first.
    is_upper: bool,
    /// The origin closest to what lies ahead, and the box margin, in lattice steps.
    origin: L,
    /// t' of a lattice step.
    inverse: Range<L>,
    /// The least of the rays' limits.
    t_min: L,
}

impl<L: Eight> EarliestEntry<L> {
    #[inline(always)]
    pub(crate) fn new(packets: &[Packet; PACKETS], axis: usize, is_upper: bool) -> Self {
        let origin = Range::of_rows(unroll!(packet in 0..8 => L::load(&packets[packet].origin[2]))).whole();
        let inverse = Range::of_rows(unroll!(packet in 0..8 => L::load(&packets[packet].inverse[axis]))).whole();
        let margin = BOX_MARGIN * STEPS;
        let origin = if is_upper { origin.least * STEPS - (1.0 + margin) } else { origin.greatest * STEPS + margin };
        Self {
            axis,
            is_upper,
            origin: L::splat(origin),
            inverse: Range::splat(inverse),
            t_min: L::splat(Range::of_rows(unroll!(packet in 0..8 => L::load(&packets[packet].t_min))).whole().least),
        }
    }

    /// The earliest t' at the eight boxes of a node.
    #[inline(always)]
    pub(crate) fn of(&self, node: &BvhNode, order: L::Order) -> L {
        let distance = L::from_steps(&node.sides[self.axis][usize::from(self.is_upper)], order) - self.origin;
        self.t_min.max((distance * self.inverse.least).min(distance * self.inverse.greatest))
    }
}
