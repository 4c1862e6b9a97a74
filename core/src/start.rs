//! Where a walk starts, and where it may end, for any lanes.

use crate::contract::START_MARGIN;
use crate::lanes::Lanes;
use crate::layout::{Key, LATTICE};
use crate::leaf::Leaf;
use crate::parts::Parts;
use crate::policy::{Policy, Standard};
use crate::step::{Cell, Line};
use crate::unroll;

/// The part of a ray that a walk follows: from a little before it enters the hull, or comes to its own start, to where it
/// leaves the hull, or ends itself (docs/contract.md, "Hull").
#[derive(Clone, Copy, Debug)]
pub struct Span<L: Lanes> {
    /// The first point, as seen from the root's corner.
    pub start: [L; 3],
    /// t' of the last one.
    pub end: L,
    /// Whether the ray meets the hull at all.
    pub is_met: L::Mask,
}

impl<L: Lanes> Span<L> {
    /// The span of rays with these limits of t', given the dilated hull; see [`crate::layout::LatticeBox::dilated`].
    #[inline(always)]
    pub fn new(line: &Line<L>, t_min: L, t_max: L, [lower, upper]: &[[f32; 3]; 2]) -> Self {
        let a: [L; 3] = unroll!(k in 0..3 => (L::splat(lower[k]) - line.origin[k]) * line.inverse[k]);
        let b: [L; 3] = unroll!(k in 0..3 => (L::splat(upper[k]) - line.origin[k]) * line.inverse[k]);
        let [x, y, z] = unroll!(k in 0..3 => a[k].min(b[k]));
        let first = t_min.max(x).max(y.max(z));
        let [x, y, z] = unroll!(k in 0..3 => a[k].max(b[k]));
        let end = t_max.min(x).min(y.min(z));
        let t = first - L::splat(START_MARGIN);
        let (zero, edge) = (L::splat(0.0), L::splat(LATTICE as f32));
        let start = unroll!(k in 0..3 => (line.origin[k] + t * line.direction[k]).max(zero).min(edge));
        Self { start, end, is_met: first.at_most(end) & t_min.less(t_max) }
    }
}

impl Parts<'_> {
    /// The leaf that holds a point of the root (as seen from its corner), on the side of a ray of octant `neg` where the
    /// point lies on a face: the number of its record, and its cell. It is found sooner if it is the one that is `known`.
    #[inline]
    pub fn locate(&self, point: [f32; 3], neg: u32, known: Leaf) -> (u32, Cell<f32>) {
        self.locate_with::<Standard>(point, neg, known)
    }

    /// See [`crate::testing::walk`].
    #[inline]
    pub(crate) fn locate_with<P: Policy>(&self, point: [f32; 3], neg: u32, known: Leaf) -> (u32, Cell<f32>) {
        match known {
            Leaf::UNKNOWN => self.descend(point, neg),
            known => self.locate_known::<P>(point, neg, known),
        }
    }

    /// As [`Parts::locate`], of a leaf that the caller claims to know. It stands apart, so that walks that know none do not pay
    /// for those that do.
    #[inline(never)]
    fn locate_known<P: Policy>(&self, point: [f32; 3], neg: u32, known: Leaf) -> (u32, Cell<f32>) {
        let holds = |cell: &Cell<f32>| smallest_cell(point, neg).map(|c| c & !(cell.size - 1)) == cell.corner;
        match self.cell(known) {
            Some(cell) if P::TRUSTS_LEAVES || holds(&cell) => (known.0, cell),
            _ => self.descend(point, neg),
        }
    }

    /// The cell of a leaf, unless the number is none of a leaf's record.
    fn cell(&self, Leaf(number): Leaf) -> Option<Cell<f32>> {
        let record = self.records.get(number as usize).filter(|_| number == 0 || number > 7)?;
        (!record.head().is_inner()).then(|| Cell::new(self.key(number)))
    }

    /// As [`Parts::locate`], from the entry grid down.
    #[inline]
    fn descend(&self, point: [f32; 3], neg: u32) -> (u32, Cell<f32>) {
        let corner = smallest_cell(point, neg);
        let bits = self.header.grid_bits;
        let shift = LATTICE.ilog2() - bits;
        let entry = (0..3).fold(0, |entry, k| entry | (corner[k] >> shift) << (k as u32 * bits));
        let mut number = self.grid[entry as usize];
        loop {
            let record = &self.records[number as usize];
            let size = LATTICE >> record.head().level();
            if !record.head().is_inner() {
                return (number, Cell { corner: corner.map(|c| c & !(size - 1)), size });
            }
            number = record.offset + Key::octant_towards(size, corner);
        }
    }
}

/// The corner of the smallest cell that holds a point of the root: on the side of a ray of octant `neg`, see
/// [`Parts::locate`].
#[inline(always)]
fn smallest_cell(point: [f32; 3], neg: u32) -> [u32; 3] {
    core::array::from_fn(|k| {
        let whole = (point[k] as u32).min(LATTICE - 1);
        let backs_off = neg >> k & 1 == 1 && whole as f32 == point[k] && whole > 0;
        whole - u32::from(backs_off)
    })
}
