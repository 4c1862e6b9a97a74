//! `Beam`: four planes that hold all rays of a tile, in axes permuted so that axis 2 is their main one.
//!
//! Across axis 2 a ray is a line. Over a range of axis 2, the least of several lines lies above the line between the
//! least at both ends, and the greatest below; so two such lines an axis bound rays whatever their origins: rays that
//! spread from a point, that close in on one, and that do neither.
//!
//! Source: A. Reshetov, A. Soupikov and J. Hurley, "Multi-Level Ray Tracing Algorithm", ACM Transactions on Graphics 24(3),
//! 2005, <https://doi.org/10.1145/1073204.1073329>. Departures from it:
//! 1. The planes need no common origin: they are made from where the rays are at both ends of the range.
//! 2. The beam goes down the tree with its rays, instead of looking for a place to enter it; triangles are tested
//!    against the planes, too.

use leafwalk_core::contract::{BOX_MARGIN, ROUNDOFF};
use leafwalk_core::lanes::Lanes;
use leafwalk_core::layout::{BvhNode, LATTICE};
use leafwalk_core::unroll;

use super::range::Range;
use crate::lanes::Eight;
use crate::trace::packet::{PACKETS, Packet};

/// The root's edge.
pub(crate) const EDGE: f32 = LATTICE as f32;
/// How far outside its planes a beam still looks.
///
/// Coordinates are below four root edges, so each of the ten roundings on the way to a plane and through its test is at most
/// two roundoffs of the edge, 20 in all, and the three that bring a plane to the root's corner are 6; triangles that count
/// are up to 10 beside their rays (docs/contract.md, "Beams").
pub(crate) const BEAM_MARGIN: f32 = 64.0 * ROUNDOFF * EDGE;
/// Sum of a beam's widths at both ends above which its rays share too little.
const WIDEST: f32 = 0.2 * EDGE;

/// A line across axis 2: `at + per_z * z`.
#[derive(Clone, Copy, Debug)]
struct Side<L> {
    at: L,
    per_z: L,
}

impl<L: Lanes> Side<L> {
    /// Through two points, moved outward.
    #[inline(always)]
    fn through(range: Range<L>, a: L, b: L, outward: f32) -> Self {
        let per_z = (b - a) / (range.greatest - range.least);
        Self { at: a - per_z * range.least + L::splat(outward), per_z }
    }

    /// How far a point is beyond the line.
    #[inline(always)]
    fn beyond(&self, x: L, z: L) -> L {
        x - self.per_z.about_mul_add(z, self.at)
    }
}

/// Bounds along one axis across.
#[derive(Clone, Copy, Debug)]
struct Sides<L> {
    low: Side<L>,
    high: Side<L>,
}

impl<L: Lanes> Sides<L> {
    /// Given where rays are at both ends of a range of axis 2.
    #[inline(always)]
    fn new(z: Range<L>, near: Range<L>, far: Range<L>, margin: f32) -> Self {
        Self {
            low: Side::through(z, near.least, far.least, -margin),
            high: Side::through(z, near.greatest, far.greatest, margin),
        }
    }
}

/// Bounds along the two axes across.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beam<L> {
    sides: [Sides<L>; 2],
}

impl<L: Eight> Beam<L> {
    /// The beam of each packet, a packet a lane, over a range of axis 2 that is not empty; and that of all packets.
    ///
    /// `None`: they share too little.
    #[inline(always)]
    pub(crate) fn around(packets: &[Packet; PACKETS], z: Range<f32>, margin: f32) -> Option<(Self, Self)> {
        let range = Range::splat(z);
        let [x, all_x] = sides::<L>(packets, 0, range, margin)?;
        let [y, all_y] = sides::<L>(packets, 1, range, margin)?;
        Some((Self { sides: [x, y] }, Self { sides: [all_x, all_y] }))
    }

    /// Lanes whose triangle may be hit by a ray of the beam; either may be the same in all lanes.
    #[inline(always)]
    pub(crate) fn may_hit(&self, corners: &[[L; 3]; 3]) -> L::Mask {
        self.straddled(corners, 0) & self.straddled(corners, 1)
    }

    /// Lanes whose corners do not all lie beyond one side.
    #[inline(always)]
    fn straddled(&self, corners: &[[L; 3]; 3], axis: usize) -> L::Mask {
        let [a, b, c]: [L; 3] = unroll!(c in 0..3 => self.sides[axis].low.beyond(corners[c][axis], corners[c][2]));
        let [d, e, f]: [L; 3] = unroll!(c in 0..3 => self.sides[axis].high.beyond(corners[c][axis], corners[c][2]));
        let zero = L::splat(0.0);
        zero.at_most(a.max(b).max(c)) & d.min(e).min(f).at_most(zero)
    }
}

/// The sides of each packet and of all along one axis across.
#[inline(always)]
fn sides<L: Eight>(packets: &[Packet; PACKETS], axis: usize, z: Range<L>, margin: f32) -> Option<[Sides<L>; 2]> {
    let (near, far) = (
        unroll!(packet in 0..8 => across(&packets[packet], axis, z.least)),
        unroll!(packet in 0..8 => across(&packets[packet], axis, z.greatest)),
    );
    // From a packet a row to a packet a lane.
    let (near, far) = (Range::of_rows(L::transpose(near)), Range::of_rows(L::transpose(far)));
    let (all_near, all_far) = (near.whole(), far.whole());
    let width = (all_near.greatest - all_near.least) + (all_far.greatest - all_far.least);
    if width > WIDEST || width.is_nan() {
        return None;
    }
    let all = Sides::new(z, Range::splat(all_near), Range::splat(all_far), margin);
    Some([Sides::new(z, near, far, margin), all])
}

/// Where rays are along an axis across, given where along axis 2.
#[inline(always)]
fn across<L: Eight>(rays: &Packet, axis: usize, z: L) -> L {
    L::load(&rays.origin[axis]) + L::load(&rays.slope[axis]) * (z - L::load(&rays.origin[2]))
}

/// Four planes against the boxes of a node, as seen from the root's corner.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoxTest<L> {
    low: [Plane<L>; 2],
    high: [Plane<L>; 2],
    /// Rows of the lower and the upper sides along axis 2, and between which steps they are to lie.
    ends: [usize; 2],
    first_step: L,
    last_step: L,
}

/// A box is beyond the plane where its side less `per_z` times its end along axis 2 is beyond `at`.
#[derive(Clone, Copy, Debug)]
struct Plane<L> {
    at: L,
    minus_per_z: L,
    /// The row of the boxes' sides that come farthest inward, and of the ends where the plane lies farthest outward.
    side: usize,
    end: usize,
}

/// A box in step n reaches from `BELOW` it to `ABOVE` it.
const BELOW: f32 = -BOX_MARGIN;
const ABOVE: f32 = 1.0 + BOX_MARGIN;

impl<L: Eight> Plane<L> {
    /// The plane of a low or a high side across `axis`, given where the root's corner is.
    #[inline(always)]
    fn new(line: &Side<L>, axis: usize, along: usize, is_low: bool, corner: [f32; 3]) -> Self {
        let (at, per_z) = (line.at.to_array()[0], line.per_z.to_array()[0]);
        let at = at + per_z * corner[along] - corner[axis];
        let is_upper_end = (per_z < 0.0) == is_low;
        let at = at + per_z * if is_upper_end { ABOVE } else { BELOW } - if is_low { ABOVE } else { BELOW };
        Self {
            at: L::splat(at),
            minus_per_z: L::splat(-per_z),
            side: 2 * axis + usize::from(is_low),
            end: 2 * along + usize::from(is_upper_end),
        }
    }

    #[inline(always)]
    fn inward(&self, rows: &[[u16; 8]; 6], order: L::Order) -> L {
        self.minus_per_z.about_mul_add(L::from_steps(&rows[self.end], order), L::from_steps(&rows[self.side], order))
    }
}

impl<L: Eight> BoxTest<L> {
    /// For a beam that is the same in all lanes, and its range of axis 2, given where the root's corner is.
    #[inline(always)]
    pub(crate) fn new(beam: &Beam<L>, axes: [usize; 3], z: Range<f32>, corner: [f32; 3]) -> Self {
        let [x, y, end] = axes;
        let [across, up] = &beam.sides;
        Self {
            low: [Plane::new(&across.low, x, end, true, corner), Plane::new(&up.low, y, end, true, corner)],
            high: [Plane::new(&across.high, x, end, false, corner), Plane::new(&up.high, y, end, false, corner)],
            ends: [2 * end, 2 * end + 1],
            first_step: L::splat(z.least - corner[end] - ABOVE),
            last_step: L::splat(z.greatest - corner[end] - BELOW),
        }
    }

    /// Lanes whose box some ray may meet.
    #[inline(always)]
    pub(crate) fn may_hit(&self, node: &BvhNode, order: L::Order) -> L::Mask {
        let rows: &[[u16; 8]; 6] = bytemuck::cast_ref(&node.sides);
        let [[a, b], [c, d]] = [&self.low, &self.high];
        a.at.at_most(a.inward(rows, order))
            & b.at.at_most(b.inward(rows, order))
            & c.inward(rows, order).at_most(c.at)
            & d.inward(rows, order).at_most(d.at)
            & self.first_step.at_most(L::from_steps(&rows[self.ends[1]], order))
            & L::from_steps(&rows[self.ends[0]], order).at_most(self.last_step)
    }
}
