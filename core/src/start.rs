//! Where a walk starts, and where it may end, for any lanes.

use crate::contract::START_MARGIN;
use crate::lanes::Lanes;
use crate::layout::{Key, LATTICE};
use crate::parts::Parts;
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
    /// point lies on a face: the number of its record, and its cell.
    #[inline]
    pub fn locate(&self, point: [f32; 3], neg: u32) -> (u32, Cell<f32>) {
        let corner: [u32; 3] = core::array::from_fn(|k| {
            let whole = (point[k] as u32).min(LATTICE - 1);
            let backs_off = neg >> k & 1 == 1 && whole as f32 == point[k] && whole > 0;
            whole - u32::from(backs_off)
        });
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
