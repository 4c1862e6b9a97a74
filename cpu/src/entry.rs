//! Where a tile's rays come from: how far along their main axis they look, and when the first of them enters a box.

use leafwalk_core::layout::{BOX_MARGIN, Branch};

use crate::beam::{Range, STEPS};
use crate::lanes::{Eight, eight_times};
use crate::prepare::{PACKETS, Prepared};

/// Where along axis 2 rays may hit anything: inside the root, between their ends. Never empty.
#[inline(always)]
pub(crate) fn along<L: Eight>(prepared: &[Prepared; PACKETS]) -> Range<f32> {
    let starts = Range::of_rows(eight_times!(packet => at::<L>(&prepared[packet], &prepared[packet].t_min)));
    let ends = Range::of_rows(eight_times!(packet => at::<L>(&prepared[packet], &prepared[packet].t_max)));
    let Range { least, greatest } = starts.and(ends.least).and(ends.greatest).whole();
    // A lattice step more, which covers the rounding, too.
    Range { least: least - 1.0 / STEPS, greatest: greatest + 1.0 / STEPS }
}

/// Where along axis 2 rays are at t', as far as it is inside the root.
#[inline(always)]
fn at<L: Eight>(rays: &Prepared, t: &[f32; 8]) -> L {
    (L::load(&rays.origin[2]) + L::load(&rays.speed) * L::load(t)).max(L::splat(0.0)).min(L::splat(1.0))
}

/// The earliest t' at which a tile's rays enter boxes: where the first of them meets their near sides along axis 2.
pub(crate) struct Entry<L> {
    axis: usize,
    /// Upper sides are near.
    is_upper: bool,
    /// In lattice steps, the origin closest to what lies ahead, and the box margin.
    origin: L,
    /// t' a lattice step.
    inverse: Range<L>,
    t_min: L,
}

impl<L: Eight> Entry<L> {
    #[inline(always)]
    pub(crate) fn new(prepared: &[Prepared; PACKETS], axis: usize, is_upper: bool) -> Self {
        let origin = Range::of_rows(eight_times!(packet => L::load(&prepared[packet].origin[2]))).whole();
        let inverse = Range::of_rows(eight_times!(packet => L::load(&prepared[packet].inverse[axis]))).whole();
        let margin = BOX_MARGIN * STEPS;
        let origin = if is_upper { origin.least * STEPS - (1.0 + margin) } else { origin.greatest * STEPS + margin };
        Self {
            axis,
            is_upper,
            origin: L::splat(origin),
            inverse: Range::splat(inverse),
            t_min: L::splat(Range::of_rows(eight_times!(packet => L::load(&prepared[packet].t_min))).whole().least),
        }
    }

    #[inline(always)]
    pub(crate) fn of(&self, branch: &Branch, order: L::Order) -> L {
        let distance = L::from_steps(&branch.sides[self.axis][usize::from(self.is_upper)], order) - self.origin;
        self.t_min.max((distance * self.inverse.least).min(distance * self.inverse.greatest))
    }
}
