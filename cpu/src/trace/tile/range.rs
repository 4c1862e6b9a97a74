//! `Range`: the least and the greatest of some numbers.

use leafwalk_core::lanes::Lanes;

use crate::lanes::Eight;
use crate::trace::packet::PACKETS;

/// The least and the greatest of some numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Range<L> {
    pub(crate) least: L,
    pub(crate) greatest: L,
}

impl<L: Lanes> Range<L> {
    /// The range of one number.
    #[inline(always)]
    pub(crate) fn of(x: L) -> Self {
        Self { least: x, greatest: x }
    }

    /// The smallest range that holds another number, too.
    #[inline(always)]
    pub(crate) fn and(self, other: L) -> Self {
        Self { least: self.least.min(other), greatest: self.greatest.max(other) }
    }
}

impl Range<f32> {
    /// Its ends, the one nearer to 0 in the place of the least.
    #[inline(always)]
    pub(crate) fn nearer_first(self) -> Self {
        let Self { least, greatest } = self;
        if least.abs() <= greatest.abs() { self } else { Self { least: greatest, greatest: least } }
    }
}

impl<L: Eight> Range<L> {
    /// One range in every lane.
    #[inline(always)]
    pub(crate) fn splat(range: Range<f32>) -> Self {
        Self { least: L::splat(range.least), greatest: L::splat(range.greatest) }
    }

    /// The range of each lane over all packets.
    #[inline(always)]
    pub(crate) fn of_rows(rows: [L; PACKETS]) -> Self {
        let [a, b, c, d, e, f, g, h] = rows;
        Self::of(a).and(b).and(c).and(d).and(e).and(f).and(g).and(h)
    }

    /// The range over all lanes.
    #[inline(always)]
    pub(crate) fn whole(self) -> Range<f32> {
        let (mut least, mut greatest) = (f32::INFINITY, f32::NEG_INFINITY);
        let (low, high) = (self.least.to_array(), self.greatest.to_array());
        for lane in 0..8 {
            least = if low[lane] < least { low[lane] } else { least };
            greatest = if high[lane] > greatest { high[lane] } else { greatest };
        }
        Range { least, greatest }
    }
}
