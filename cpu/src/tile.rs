//! Rays with one origin and much the same direction, traced together: 64 rays share each node and each triangle.
//!
//! What a tile skips, it skips by bounds that each of its rays keeps: so it gives what each ray alone gives.

use leafwalk_core::lanes::{Lanes, Mask as _};
use leafwalk_core::layout::{BLOCK_WIDTH, BOX_MARGIN, Block, LATTICE, NONE, Payload, SMALLEST_SHEARED};
use leafwalk_core::triangle::{PERMUTATIONS, Shear, Sheared};
use leafwalk_core::{Nearest, Parts, per_axis};

use crate::lanes::Eight;
use crate::prepare::Prepared;
use crate::trail::Trail;

/// Packets of eight rays a tile.
pub(crate) const PACKETS: usize = 8;
/// Rays a tile.
pub(crate) const RAYS: usize = 8 * PACKETS;
/// Difference of slopes between rays (about 11 degrees) above which a tile shares too little.
const WIDEST: f32 = 0.2;
/// Triangles of which a tile remembers that it has tested them: a power of two.
const MAILBOXES: usize = 64;
/// The box margin in lattice steps.
const MARGIN: f32 = BOX_MARGIN * LATTICE as f32;

/// The least and the greatest of some numbers.
#[derive(Clone, Copy, Debug)]
struct Range<L> {
    least: L,
    greatest: L,
}

/// A tile under way.
pub(crate) struct Tile<L> {
    neg: u32,
    axes: [usize; 3],
    /// In lattice steps, moved by the box margin to where near sides, or far ones, count from.
    near: [L; 3],
    far: [L; 3],
    inverse: [Range<L>; 3],
    t_min: f32,
    /// Permuted, in lattice units.
    origin: [L; 3],
    packets: [Shear<L>; PACKETS],
    /// Slopes of each packet, a packet a lane.
    of_packets: [Range<L>; 2],
    /// Slopes of all.
    of_all: [Range<L>; 2],
    pub(crate) nearest: [Nearest; RAYS],
    /// The farthest t' that any ray still asks for.
    last: f32,
    mailboxes: [u32; MAILBOXES],
}

impl<L: Eight> Tile<L> {
    /// A tile of 64 rays, or `None` where they have too little in common.
    #[inline(always)]
    pub(crate) fn new(prepared: &[Prepared; PACKETS]) -> Option<Self> {
        let (neg, main_axis) = (prepared[0].neg[0], prepared[0].main_axis[0]);
        let origin: [f32; 3] = per_axis!(k => prepared[0].origin[k][0]);
        for rays in prepared {
            let is_alike = rays.waiting == 0xff
                && rays.neg == [neg; 8]
                && rays.main_axis == [main_axis; 8]
                && rays.origin == origin.map(|c| [c; 8]);
            if !is_alike {
                return None;
            }
        }
        let all: [(f32, f32); 2] =
            [widest(range::<L>(prepared, |rays| &rays.slope[0])), widest(range::<L>(prepared, |rays| &rays.slope[1]))];
        if all.iter().any(|(least, greatest)| greatest - least > WIDEST) {
            return None;
        }
        let axes = PERMUTATIONS[usize::from(main_axis).min(2)];
        // From permuted lattice units to lattice steps.
        let mut steps = [0.0; 3];
        for k in 0..3 {
            steps[axes[k]] = origin[k] * LATTICE as f32;
        }
        let inverse = per_axis!(axis => widest(range::<L>(prepared, |rays| &rays.inverse[axis])));
        let of_packets = [of_packets(prepared, 0), of_packets(prepared, 1)];
        let nearest = core::array::from_fn(|ray| {
            let (packet, lane) = (&prepared[ray / 8], ray % 8);
            Nearest { t_min: packet.t_min[lane], t: packet.t_max[lane], u: 0.0, v: 0.0, primitive: NONE }
        });
        let is_negative = |k: usize| neg >> k & 1 == 1;
        let (below, above) = (steps.map(|c| c - (1.0 + MARGIN)), steps.map(|c| c + MARGIN));
        Some(Self {
            neg,
            axes,
            near: per_axis!(k => L::splat(if is_negative(k) { below[k] } else { above[k] })),
            far: per_axis!(k => L::splat(if is_negative(k) { above[k] } else { below[k] })),
            inverse: per_axis!(k => splat(inverse[k])),
            t_min: widest(range::<L>(prepared, |rays| &rays.t_min)).0,
            origin: per_axis!(k => L::splat(origin[k])),
            packets: [
                shear(&prepared[0]),
                shear(&prepared[1]),
                shear(&prepared[2]),
                shear(&prepared[3]),
                shear(&prepared[4]),
                shear(&prepared[5]),
                shear(&prepared[6]),
                shear(&prepared[7]),
            ],
            of_packets,
            of_all: [splat(all[0]), splat(all[1])],
            nearest,
            last: widest(range::<L>(prepared, |rays| &rays.t_max)).1,
            mailboxes: [NONE; MAILBOXES],
        })
    }

    /// Finds the nearest hit of each ray; with `ANY`, some hit.
    #[inline(always)]
    pub(crate) fn trace<const ANY: bool>(&mut self, parts: &Parts<'_>, trail: &mut Trail) {
        trail.clear();
        let mut node = 0;
        while let Some(payload) = parts.payloads.get(node as usize) {
            let (first, mut met) = self.meet(payload);
            let is_inner = payload.children != 0;
            trail.wait(payload, self.neg, if is_inner { met } else { 0 }, first);
            met = if is_inner { 0 } else { met };
            while met != 0 {
                let b = met.trailing_zeros();
                met &= met - 1;
                if first[b as usize & 7] <= self.last {
                    self.test_block::<ANY>(&parts.blocks[(payload.first + b) as usize]);
                }
            }
            node = if payload.next != NONE { payload.next } else { trail.back(self.neg, self.last) };
        }
    }

    /// Which of a payload's boxes any ray may meet, and the earliest t' at which one may.
    #[inline(always)]
    fn meet(&self, payload: &Payload) -> ([f32; 8], u32) {
        let (near, far) = (payload.facing(self.neg), payload.facing(!self.neg));
        let [x, y, z]: [L; 3] = per_axis!(k => {
            let Range { least, greatest } = self.inverse[k];
            let distance = L::from_steps(near[k]) - self.near[k];
            (distance * least).min(distance * greatest)
        });
        let first = L::splat(self.t_min).max(x).max(y.max(z));
        let [x, y, z]: [L; 3] = per_axis!(k => {
            let Range { least, greatest } = self.inverse[k];
            let distance = L::from_steps(far[k]) - self.far[k];
            (distance * least).max(distance * greatest)
        });
        let last = L::splat(self.last).min(x).min(y.min(z));
        (first.to_array(), first.at_most(last).to_bits())
    }

    #[inline(always)]
    fn test_block<const ANY: bool>(&mut self, block: &Block) {
        let corners: [[L; 3]; 3] =
            per_axis!(c => per_axis!(k => L::load(&block.vertices[c][self.axes[k]]) - self.origin[k]));
        let mut triangles = may_hit(&corners, &self.of_all).to_bits();
        if triangles == 0 {
            return;
        }
        let corners: [[[f32; BLOCK_WIDTH]; 3]; 3] = per_axis!(c => per_axis!(k => corners[c][k].to_array()));
        let mut is_hit = false;
        while triangles != 0 {
            let lane = triangles.trailing_zeros() as usize & 7;
            triangles &= triangles - 1;
            let primitive = block.primitives[lane];
            let mailbox = &mut self.mailboxes[primitive as usize % MAILBOXES];
            // Vacant lanes look like triangles that were tested.
            if *mailbox == primitive || primitive == NONE {
                continue;
            }
            *mailbox = primitive;
            let triangle: [[L; 3]; 3] = per_axis!(c => per_axis!(k => L::splat(corners[c][k][lane])));
            let mut packets = may_hit(&triangle, &self.of_packets).to_bits();
            while packets != 0 {
                let packet = packets.trailing_zeros() as usize & 7;
                packets &= packets - 1;
                is_hit |= self.test_packet::<ANY>(packet, triangle, primitive);
            }
        }
        if is_hit {
            self.last = self.nearest.iter().map(|nearest| nearest.t).fold(f32::NEG_INFINITY, f32::max);
        }
    }

    /// Tests one triangle against eight rays.
    #[inline(always)]
    fn test_packet<const ANY: bool>(&mut self, packet: usize, triangle: [[L; 3]; 3], primitive: u32) -> bool {
        let shear = &self.packets[packet];
        let sheared = Sheared::from_differences(shear, triangle);
        let candidates = sheared.is_candidate();
        if !candidates.any() {
            return false;
        }
        let (accepted, found) = sheared.finish(shear);
        let mut accepted = (accepted & candidates).to_bits();
        let (t, u, v) = (found.t.to_array(), found.u.to_array(), found.v.to_array());
        let is_hit = accepted != 0;
        while accepted != 0 {
            let lane = accepted.trailing_zeros() as usize & 7;
            accepted &= accepted - 1;
            let nearest = &mut self.nearest[8 * packet + lane];
            nearest.offer(t[lane], u[lane], v[lane], primitive);
            if ANY && nearest.is_hit() {
                // Nothing is nearer: the ray asks for no more.
                nearest.t = f32::NEG_INFINITY;
            }
        }
        is_hit
    }
}

/// Lanes whose triangle some ray of a range of slopes may hit: along both axes across it, corners on both sides.
///
/// Sheared coordinates are monotone in the slope, rounding included, so those of the outermost slopes bound them all;
/// and coordinates up to [`SMALLEST_SHEARED`] count as 0.
#[inline(always)]
fn may_hit<L: Lanes>(corners: &[[L; 3]; 3], slopes: &[Range<L>; 2]) -> L::Mask {
    straddles(corners, 0, slopes[0]) & straddles(corners, 1, slopes[1])
}

#[inline(always)]
fn straddles<L: Lanes>(corners: &[[L; 3]; 3], axis: usize, slopes: Range<L>) -> L::Mask {
    let [a, b, c]: [(L, L); 3] = per_axis!(c => {
        let one = corners[c][axis] - slopes.least * corners[c][2];
        let other = corners[c][axis] - slopes.greatest * corners[c][2];
        (one.min(other), one.max(other))
    });
    let (least, greatest) = (a.0.min(b.0).min(c.0), a.1.max(b.1).max(c.1));
    least.at_most(L::splat(SMALLEST_SHEARED)) & L::splat(-SMALLEST_SHEARED).at_most(greatest)
}

#[inline(always)]
fn shear<L: Eight>(rays: &Prepared) -> Shear<L> {
    Shear { origin: per_axis!(k => L::load(&rays.origin[k])), slope: per_axis!(k => L::load(&rays.slope[k])) }
}

/// Lane by lane, the range of a row over all packets.
#[inline(always)]
fn range<L: Eight>(prepared: &[Prepared; PACKETS], row: impl Fn(&Prepared) -> &[f32; 8]) -> Range<L> {
    let mut range = Range { least: L::load(row(&prepared[0])), greatest: L::load(row(&prepared[0])) };
    for rays in &prepared[1..] {
        let row = L::load(row(rays));
        range = Range { least: range.least.min(row), greatest: range.greatest.max(row) };
    }
    range
}

/// The range over all lanes.
#[inline(always)]
fn widest<L: Eight>(range: Range<L>) -> (f32, f32) {
    (least(&range.least.to_array()), greatest(&range.greatest.to_array()))
}

/// Packet by packet, the range of its slopes along an axis.
#[inline(always)]
fn of_packets<L: Eight>(prepared: &[Prepared; PACKETS], axis: usize) -> Range<L> {
    let (mut lower, mut upper) = ([0.0; PACKETS], [0.0; PACKETS]);
    for packet in 0..PACKETS {
        lower[packet] = least(&prepared[packet].slope[axis]);
        upper[packet] = greatest(&prepared[packet].slope[axis]);
    }
    Range { least: L::load(&lower), greatest: L::load(&upper) }
}

#[inline(always)]
fn splat<L: Lanes>((least, greatest): (f32, f32)) -> Range<L> {
    Range { least: L::splat(least), greatest: L::splat(greatest) }
}

#[inline(always)]
fn least(row: &[f32; 8]) -> f32 {
    let mut least = row[0];
    for lane in 1..8 {
        least = if row[lane] < least { row[lane] } else { least };
    }
    least
}

#[inline(always)]
fn greatest(row: &[f32; 8]) -> f32 {
    let mut greatest = row[0];
    for lane in 1..8 {
        greatest = if row[lane] > greatest { row[lane] } else { greatest };
    }
    greatest
}
