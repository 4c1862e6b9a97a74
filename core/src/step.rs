//! The branchless step: from a cell through its exit face into the neighbouring cell, for any lanes.
//!
//! Two ways to find the exit share the cell and link code: by the signs of Plücker products, as in the paper, and by
//! slab distances. Both only ever move forward along the ray's octant, so the Morton key XOR the octant grows with every
//! step and a walk ends whatever the rounding (docs/contract.md, "Step").

use crate::lanes::{Bits, Lanes};
use crate::layout::{Key, LINK_COARSER, LINK_FINER, LINK_SHIFT, Record};
use crate::tables::EXIT_AXIS;
use crate::unroll;

/// Stands for 1 / 0: any coordinate difference above 2^-40 becomes a distance beyond the root.
pub const STEEP: f32 = (1u64 << 60) as f32;
/// Where the exit planes of an axis without direction are seen from: farther than any other exit.
pub const FAR_BEHIND: f32 = -((1u64 << 56) as f32);

/// What a step needs to know of a ray, as seen from the root's corner: so the corners of cells serve as they are.
#[derive(Clone, Copy, Debug)]
pub struct Line<L: Lanes> {
    /// Where t' is 0.
    pub origin: [L; 3],
    /// Per unit of t'.
    pub direction: [L; 3],
    /// 1 / direction, or 2^60 where that is zero: good for conservative box tests as it stands.
    pub inverse: [L; 3],
    /// The origin, or far behind it where the direction is zero: such planes are never the first exit.
    exit_origin: [L; 3],
    /// 1 along axes on which the ray moves up, else -1.
    forward: [L; 3],
    /// Bit k: direction k is negative.
    pub neg: L::Bits,
    /// All ones on the axes along which the ray moves up.
    upward: [L::Bits; 3],
    /// Bit k decides a tie of the two products of Plücker component k.
    tie: L::Bits,
}

impl<L: Lanes> Line<L> {
    /// The lines of canonical rays, given where t' is 0 as seen from the root's corner.
    #[inline(always)]
    pub fn new(origin: [L; 3], direction: [L; 3]) -> Self {
        Self::with_inverse(origin, direction, inverse(direction))
    }

    /// As [`Line::new`], of rays whose [`inverse`] is known.
    #[inline(always)]
    pub fn with_inverse(origin: [L; 3], direction: [L; 3], inverse: [L; 3]) -> Self {
        let zero = L::splat(0.0);
        let down: [L::Bits; 3] = unroll!(k in 0..3 => L::indicator(direction[k].less(zero)));
        let one = L::Bits::splat(1);
        Self {
            origin,
            direction,
            inverse,
            exit_origin: unroll!(k in 0..3 => L::splat(FAR_BEHIND).or_else(direction[k].equal(zero), origin[k])),
            forward: unroll!(k in 0..3 => L::splat(-1.0).or_else(direction[k].less(zero), L::splat(1.0))),
            neg: down[0] | (down[1] | down[2] << one) << one,
            upward: unroll!(k in 0..3 => !down[k].spread()),
            tie: tie_bits::<L>(direction, down),
        }
    }
}

/// 1 / direction, or 2^60 where that is zero.
#[inline(always)]
pub fn inverse<L: Lanes>(direction: [L; 3]) -> [L; 3] {
    unroll!(k in 0..3 => L::splat(STEEP).or_else(direction[k].equal(L::splat(0.0)), L::splat(1.0) / direction[k]))
}

/// How ties between exit distances break: x before y before z, axes with direction 0 last (simulation of simplicity).
#[inline(always)]
fn tie_bits<L: Lanes>(direction: [L; 3], down: [L::Bits; 3]) -> L::Bits {
    let one = L::Bits::splat(1);
    let [x, y, z]: [L::Bits; 3] = unroll!(k in 0..3 => L::indicator(direction[k].equal(L::splat(0.0))));
    // In a tie the lower axis comes first, unless the ray does not move along it, but does along the other.
    let (z_before_y, z_before_x, y_before_x) = (y & (z ^ one), x & (z ^ one), x & (y ^ one));
    let preferred = (z_before_y ^ one) | z_before_x << one | (y_before_x ^ one) << L::Bits::splat(2);
    preferred ^ flips::<L>(down)
}

/// [`tables::mask`], given a bit an axis that the ray moves down along.
#[inline(always)]
fn flips<L: Lanes>([x, y, z]: [L::Bits; 3]) -> L::Bits {
    let one = L::Bits::splat(1);
    (y ^ z) | (z ^ x) << one | (x ^ y) << L::Bits::splat(2)
}

/// A cell, in lattice steps.
#[derive(Clone, Copy, Debug)]
pub struct Cell<L: Lanes> {
    /// Lower corner.
    pub corner: [L::Bits; 3],
    /// Edge.
    pub size: L::Bits,
}

impl<L: Lanes> Cell<L> {
    /// One cell in every lane.
    #[inline(always)]
    pub fn new(key: Key) -> Self {
        Self { corner: unroll!(k in 0..3 => L::Bits::splat(key.corner[k])), size: L::Bits::splat(key.size()) }
    }

    #[inline(always)]
    fn exit_planes(&self, line: &Line<L>) -> [L; 3] {
        unroll!(k in 0..3 => L::from_integers(self.corner[k].plus(self.size & line.upward[k])))
    }

    #[inline(always)]
    fn centre(&self) -> [L; 3] {
        let half = self.size >> L::Bits::splat(1);
        unroll!(k in 0..3 => L::from_integers(self.corner[k].plus(half)))
    }
}

/// The face by which a ray leaves a cell.
#[derive(Clone, Copy, Debug)]
pub struct Exit<L: Lanes> {
    /// Which axis it is on: one of three.
    pub axis: [L::Mask; 3],
    /// 2 * axis + positive.
    pub face: L::Bits,
    /// Distance from the ray's origin to the exit plane along that axis, forward positive.
    pub distance: L,
    /// Magnitude of the direction along that axis.
    pub speed: L,
    /// t' of the exit plane where the step computes it, else 0.
    pub t: L,
}

impl<L: Lanes> Exit<L> {
    #[inline(always)]
    fn new(line: &Line<L>, planes: [L; 3], axis: [L::Mask; 3], t: L) -> Self {
        let one = L::Bits::splat(1);
        let number = L::indicator(axis[1]) | L::indicator(axis[2]) << one;
        let positive = (line.neg >> number & one) ^ one;
        let away = unroll!(k in 0..3 => planes[k] - line.origin[k]);
        Self {
            axis,
            face: number << one | positive,
            distance: pick(away, axis) * pick(line.forward, axis),
            speed: pick(line.direction, axis).abs(),
            t,
        }
    }
}

/// The value of one axis.
#[inline(always)]
fn pick<L: Lanes>(values: [L; 3], axis: [L::Mask; 3]) -> L {
    values[0].or_else(axis[0], values[1].or_else(axis[1], values[2]))
}

/// A way to find the exit face, and the quadrant of it where four neighbours share it.
pub trait Step: Copy {
    /// The exit face of a cell.
    fn exit<L: Lanes>(line: &Line<L>, cell: &Cell<L>) -> Exit<L>;
    /// Bit k: the exit point lies in the upper half of axis k; the exit axis's own bit means nothing.
    fn upper_halves<L: Lanes>(line: &Line<L>, cell: &Cell<L>, exit: &Exit<L>) -> L::Bits;
}

/// Exit by the smallest slab distance.
#[derive(Clone, Copy, Debug)]
pub struct Slab;

impl Step for Slab {
    #[inline(always)]
    fn exit<L: Lanes>(line: &Line<L>, cell: &Cell<L>) -> Exit<L> {
        let planes = cell.exit_planes(line);
        let [x, y, z] = unroll!(k in 0..3 => (planes[k] - line.exit_origin[k]) * line.inverse[k]);
        let is_x = x.at_most(y) & x.at_most(z);
        let is_y = y.at_most(z) & !is_x;
        let is_z = !is_x & !is_y;
        Exit::new(line, planes, [is_x, is_y, is_z], x.or_else(is_x, y.or_else(is_y, z)))
    }

    #[inline(always)]
    fn upper_halves<L: Lanes>(line: &Line<L>, cell: &Cell<L>, exit: &Exit<L>) -> L::Bits {
        let centre = cell.centre();
        let one = L::Bits::splat(1);
        let mut bits = L::Bits::splat(0);
        for k in 0..3 {
            let point = line.origin[k] + exit.t * line.direction[k];
            // A tie goes to the half that lies ahead.
            let upward = centre[k].at_most(point);
            let downward = centre[k].less(point);
            let upper = (L::indicator(upward) & line.upward[k]) | (L::indicator(downward) & !line.upward[k]);
            bits = bits | (upper & one) << L::Bits::splat(k as u32);
        }
        bits
    }
}

/// Exit by the signs of the Plücker products of the ray with the edges that meet in the exit corner P, in the form
/// (P - origin) x direction (Portalez & Duguet, eq. 4 and 5), each sign taken as a comparison of two products.
#[derive(Clone, Copy, Debug)]
pub struct Pluecker;

impl Pluecker {
    /// The two products whose difference is component k of (point - origin) x direction.
    #[inline(always)]
    fn products<L: Lanes>(line: &Line<L>, point: [L; 3]) -> [(L, L); 3] {
        let w: [L; 3] = unroll!(k in 0..3 => point[k] - line.origin[k]);
        let d = line.direction;
        [(w[1] * d[2], w[2] * d[1]), (w[2] * d[0], w[0] * d[2]), (w[0] * d[1], w[1] * d[0])]
    }
}

impl Step for Pluecker {
    #[inline(always)]
    fn exit<L: Lanes>(line: &Line<L>, cell: &Cell<L>) -> Exit<L> {
        let planes = cell.exit_planes(line);
        let one = L::Bits::splat(1);
        let mut pattern = L::Bits::splat(0);
        let products = Self::products(line, planes);
        for k in 0..3 {
            let (a, b) = products[k];
            let bit = L::Bits::splat(k as u32);
            let tie = L::indicator(a.equal(b)) & (line.tie >> bit & one);
            pattern = pattern | (L::indicator(a.less(b)) | tie) << bit;
        }
        let mask = flips::<L>(unroll!(k in 0..3 => line.neg >> L::Bits::splat(k) & one));
        let axis = L::Bits::splat(EXIT_AXIS) >> ((pattern ^ mask) << one) & L::Bits::splat(3);
        // Axis numbers are 0, 1, 2: exact as numbers, so that lanes need no integer comparison.
        let number = L::from_integers(axis);
        Exit::new(line, planes, unroll!(k in 0..3 => number.equal(L::splat(k as f32))), L::splat(0.0))
    }

    #[inline(always)]
    fn upper_halves<L: Lanes>(line: &Line<L>, cell: &Cell<L>, exit: &Exit<L>) -> L::Bits {
        let planes = cell.exit_planes(line);
        let middle = cell.centre();
        let centre = unroll!(k in 0..3 => planes[k].or_else(exit.axis[k], middle[k]));
        let negative = Self::products(line, centre);
        let negative: [L::Bits; 3] = unroll!(k in 0..3 => L::indicator(negative[k].0.less(negative[k].1)));
        let one = L::Bits::splat(1);
        let positive = exit.face & one;
        // tables::sub_face, with bits where it has u and v: axis + 1 reads component axis + 2 and the other way round.
        let mut bits = L::Bits::splat(0);
        for a in 0..3 {
            let (next, after) = ((a + 1) % 3, (a + 2) % 3);
            let high_next = (negative[after] ^ positive) << L::Bits::splat(next as u32);
            let high_after = (negative[next] ^ positive ^ one) << L::Bits::splat(after as u32);
            let on_axis = L::indicator(exit.axis[a]).spread();
            bits = bits | (high_next | high_after) & on_axis;
        }
        bits
    }
}

/// Across the exit face: the neighbour's record number and cell. Means nothing where the face has no neighbour.
#[inline(always)]
pub fn cross<L: Lanes, S: Step>(
    line: &Line<L>,
    cell: &Cell<L>,
    exit: &Exit<L>,
    head: L::Bits,
    neighbour: L::Bits,
) -> (L::Bits, Cell<L>) {
    let one = L::Bits::splat(1);
    let kind = link_kind::<L>(head, exit.face);
    // Kinds are 0 to 3: 2 is binary 10, 3 is 11.
    let (low, high) = (kind & one, kind >> one);
    let is_finer = low & high;
    let is_coarser = high & (low ^ one);
    const { assert!(LINK_COARSER == 2 && LINK_FINER == 3) };
    let size = cell.size << is_coarser >> is_finer;

    // Up by the old cell's edge, or down by the new one's; lateral axes fall to the new cell's grid.
    let upward = (exit.face & one).spread();
    let along = (cell.size & upward) | L::Bits::splat(0).minus(size) & !upward;
    let aligned = !size.minus(one);
    let mut corner = unroll!(k in 0..3 => cell.corner[k].plus(along & L::indicator(exit.axis[k]).spread()) & aligned);
    let mut record = neighbour;
    if is_finer.any() {
        // The child that the ray enters: by the side that faces the ray, in the quadrant of the exit point.
        let exit_bit = one << (exit.face >> one);
        let quadrant = S::upper_halves(line, cell, exit) & !exit_bit & is_finer.spread();
        record = record.plus(quadrant | line.neg & exit_bit & is_finer.spread());
        corner = unroll!(k in 0..3 => corner[k].plus(size & (quadrant >> L::Bits::splat(k as u32) & one).spread()));
    }
    (record, Cell { corner, size })
}

/// The link kind of a face, from word 0 of a record.
#[inline(always)]
pub fn link_kind<L: Lanes>(head: L::Bits, face: L::Bits) -> L::Bits {
    head >> L::Bits::splat(LINK_SHIFT).plus(face << L::Bits::splat(1)) & L::Bits::splat(3)
}

/// The neighbour word of a face, for one lane.
#[inline(always)]
pub fn neighbour(record: &Record, face: u32) -> u32 {
    // Face numbers are 0 to 5 by construction; the mask lets the compiler see that the index is in range.
    record.neighbours[(face as usize).min(5)]
}
