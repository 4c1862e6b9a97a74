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
use leafwalk_core::layout::{BvhNode, LATTICE, Lattice};
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

/// The margin of a beam in a wide octree, as a share of a distance: of that from the tile's [`Base`] to the box or triangle
/// that is tested, plus the base's reach (docs/contract.md, "Beams").
const BEAM_SHARE: f32 = BOX_MARGIN / EDGE;

/// Where the coordinates of a beam count from, axes permuted, and how far from there it begins.
///
/// In wide octrees that is where the first ray is at t' 0, such that what is near the rays has small coordinates; in others it
/// is the anchor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Base<L> {
    pub(crate) at: [L; 3],
    /// The largest coordinate, as seen from `at`, of the rays' origins and of the points where the beam begins.
    reach: L,
    /// [`BEAM_SHARE`], unless a test makes beams too narrow.
    share: f32,
}

impl<L: Eight> Base<L> {
    /// The anchor.
    #[inline(always)]
    pub(crate) fn anchor() -> Self {
        Self { at: [L::splat(0.0); 3], reach: L::splat(0.0), share: 0.0 }
    }

    /// The origin of the first ray. The margin is [`BEAM_MARGIN`], unless a test makes beams too narrow.
    #[inline(always)]
    pub(crate) fn first(packets: &[Packet; PACKETS], margin: f32) -> Self {
        let at = unroll!(k in 0..3 => L::splat(packets[0].origin[k][0]));
        Self { at, reach: L::splat(0.0), share: margin * (BEAM_SHARE / BEAM_MARGIN) }
    }

    /// This base, with its reach: the beam begins where the rays' coordinate on axis 2 is `begin`.
    #[inline(always)]
    pub(crate) fn reaching(self, packets: &[Packet; PACKETS], begin: f32) -> Self {
        let begin = L::splat(begin);
        let mut reach = begin.abs();
        for packet in packets {
            for k in 0..3 {
                reach = reach.max((L::load(&packet.origin[k]) - self.at[k]).abs());
            }
            for axis in 0..2 {
                reach = reach.max(across(packet, axis, begin, &self).abs());
            }
        }
        let Range { greatest, .. } = Range { least: reach, greatest: reach }.whole();
        Self { reach: L::splat(greatest), ..self }
    }

    /// How much farther the rays look, given how far from the base.
    #[inline(always)]
    pub(crate) fn margin(&self, distance: L) -> L {
        (distance + self.reach) * L::splat(self.share)
    }

    /// Corners from the base, and how much farther the rays look there.
    #[inline(always)]
    pub(crate) fn corners(&self, corners: &[[L; 3]; 3]) -> ([[L; 3]; 3], L) {
        let corners: [[L; 3]; 3] = unroll!(c in 0..3 => unroll!(k in 0..3 => corners[c][k] - self.at[k]));
        let farthest: [L; 3] = unroll!(c in 0..3 => {
            let [x, y, z] = corners[c];
            x.abs().max(y.abs()).max(z.abs())
        });
        (corners, self.margin(farthest[0].max(farthest[1]).max(farthest[2])))
    }

    /// The corner of a node's lattice from the base, axis by axis as boxes have them, its step, and how much farther the rays
    /// look at the node.
    #[inline(always)]
    pub(crate) fn lattice(&self, lattice: &Lattice, axes: [usize; 3]) -> ([L; 3], L, L) {
        let mut corner = [L::splat(0.0); 3];
        for k in 0..3 {
            corner[axes[k]] = L::splat(lattice.corner[axes[k]]) - self.at[k];
        }
        let [x, y, z] = corner;
        let farthest = x.abs().max(y.abs()).max(z.abs()) + L::splat(EDGE * lattice.step);
        (corner, L::splat(lattice.step), self.margin(farthest))
    }
}

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
    /// The beam of each packet, a packet a lane, over a range of axis 2 that is not empty, either end of which may come first:
    /// planes are best near that one. And the beam of all packets.
    ///
    /// `None`: they share too little.
    #[inline(always)]
    pub(crate) fn around(
        packets: &[Packet; PACKETS],
        z: Range<f32>,
        base: &Base<L>,
        margin: f32,
    ) -> Option<(Self, Self)> {
        let range = Range::splat(z);
        let [x, all_x] = sides::<L>(packets, 0, range, base, margin)?;
        let [y, all_y] = sides::<L>(packets, 1, range, base, margin)?;
        Some((Self { sides: [x, y] }, Self { sides: [all_x, all_y] }))
    }

    /// Lanes whose triangle may be hit by a ray of the beam; either may be the same in all lanes. The margin is what the planes
    /// have not been moved outward by.
    #[inline(always)]
    pub(crate) fn may_hit(&self, corners: &[[L; 3]; 3], margin: Option<L>) -> L::Mask {
        self.straddled(corners, margin, 0) & self.straddled(corners, margin, 1)
    }

    /// Lanes whose corners do not all lie beyond one side.
    #[inline(always)]
    fn straddled(&self, corners: &[[L; 3]; 3], margin: Option<L>, axis: usize) -> L::Mask {
        let [a, b, c]: [L; 3] = unroll!(c in 0..3 => self.sides[axis].low.beyond(corners[c][axis], corners[c][2]));
        let [d, e, f]: [L; 3] = unroll!(c in 0..3 => self.sides[axis].high.beyond(corners[c][axis], corners[c][2]));
        let zero = L::splat(0.0);
        match margin {
            None => zero.at_most(a.max(b).max(c)) & d.min(e).min(f).at_most(zero),
            Some(margin) => (zero - margin).at_most(a.max(b).max(c)) & d.min(e).min(f).at_most(margin),
        }
    }
}

/// The sides of each packet and of all along one axis across.
#[inline(always)]
fn sides<L: Eight>(
    packets: &[Packet; PACKETS],
    axis: usize,
    z: Range<L>,
    base: &Base<L>,
    margin: f32,
) -> Option<[Sides<L>; 2]> {
    let (near, far) = (
        unroll!(packet in 0..8 => across(&packets[packet], axis, z.least, base)),
        unroll!(packet in 0..8 => across(&packets[packet], axis, z.greatest, base)),
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
fn across<L: Eight>(rays: &Packet, axis: usize, z: L, base: &Base<L>) -> L {
    let across = L::load(&rays.origin[axis]) - base.at[axis];
    across + L::load(&rays.slope[axis]) * (z - (L::load(&rays.origin[2]) - base.at[2]))
}

/// Four planes against the boxes of a node.
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
    /// The plane of a low or a high side across `axis`.
    #[inline(always)]
    fn new(line: &Side<L>, axis: usize, along: usize, is_low: bool) -> Self {
        let is_upper_end = (line.per_z.to_array()[0] < 0.0) == is_low;
        Self {
            at: line.at,
            minus_per_z: L::splat(0.0) - line.per_z,
            side: 2 * axis + usize::from(is_low),
            end: 2 * along + usize::from(is_upper_end),
        }
    }

    /// The plane for boxes that count the root's steps, given where the root's corner is.
    #[inline(always)]
    fn in_root(&self, is_low: bool, corner: [f32; 3]) -> Self {
        let end = if self.end % 2 == 1 { ABOVE } else { BELOW };
        let side = if is_low { ABOVE } else { BELOW };
        let at = self.at - self.minus_per_z * L::splat(corner[self.end / 2]) - L::splat(corner[self.side / 2]);
        Self { at: at - self.minus_per_z * L::splat(end) - L::splat(side), ..*self }
    }

    /// The plane for the boxes of a node whose lattice has its corner here, from the base.
    #[inline(always)]
    fn in_lattice(&self, is_low: bool, corner: [L; 3], step: L, margin: L) -> Self {
        // A box covers its steps whole. A low plane looks at the upper end of the step that the box's upper side is in, a high
        // plane at the lower end of that of its lower side; along axis 2 likewise, at the end where the plane lies farther out.
        let zero = L::splat(0.0);
        let side = corner[self.side / 2] + if is_low { step } else { zero };
        let end = corner[self.end / 2] + if self.end % 2 == 1 { step } else { zero };
        let outward = if is_low { zero - margin } else { margin };
        Self { at: (self.at - (side + self.minus_per_z * end) + outward) / step, ..*self }
    }

    #[inline(always)]
    fn inward(&self, rows: &[[u16; 8]; 6], order: L::Order) -> L {
        self.minus_per_z.about_mul_add(L::from_steps(&rows[self.end], order), L::from_steps(&rows[self.side], order))
    }
}

impl<L: Eight> BoxTest<L> {
    /// For a beam that is the same in all lanes, and its range of axis 2, before it is known what boxes count.
    #[inline(always)]
    pub(crate) fn new(beam: &Beam<L>, axes: [usize; 3], z: Range<f32>) -> Self {
        let [x, y, end] = axes;
        let [across, up] = &beam.sides;
        Self {
            low: [Plane::new(&across.low, x, end, true), Plane::new(&up.low, y, end, true)],
            high: [Plane::new(&across.high, x, end, false), Plane::new(&up.high, y, end, false)],
            ends: [2 * end, 2 * end + 1],
            first_step: L::splat(z.least),
            last_step: L::splat(z.greatest),
        }
    }

    /// The test for boxes that count the root's steps, given where the root's corner is.
    #[inline(always)]
    pub(crate) fn in_root(&self, corner: [f32; 3]) -> Self {
        let along = L::splat(corner[self.ends[0] / 2]);
        let ([a, b], [c, d]) = (&self.low, &self.high);
        Self {
            low: [a.in_root(true, corner), b.in_root(true, corner)],
            high: [c.in_root(false, corner), d.in_root(false, corner)],
            ends: self.ends,
            first_step: self.first_step - along - L::splat(ABOVE),
            last_step: self.last_step - along - L::splat(BELOW),
        }
    }

    /// The test for the boxes of a node with a lattice.
    #[inline(always)]
    pub(crate) fn in_lattice(&self, corner: [L; 3], step: L, margin: L) -> Self {
        let along = corner[self.ends[0] / 2];
        let ([a, b], [c, d]) = (&self.low, &self.high);
        Self {
            low: [a.in_lattice(true, corner, step, margin), b.in_lattice(true, corner, step, margin)],
            high: [c.in_lattice(false, corner, step, margin), d.in_lattice(false, corner, step, margin)],
            ends: self.ends,
            first_step: (self.first_step - along - step - margin) / step,
            last_step: (self.last_step - along + margin) / step,
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
