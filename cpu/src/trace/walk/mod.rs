//! Rays that walk the octree from leaf to leaf, eight in lockstep, each in its own cell.
//!
//! ```text
//! for each ray that comes in:
//!     a lane is free:  the ray starts there, in the leaf where it enters the hull, or the one that is known to hold it
//!     no lane is free: rounds are made until one is
//! a round, each line for all groups of eight:
//!     look at the cells' records; ask for the payloads of those that list anything
//!     descend from what each such leaf lists, eight boxes at once; ask for the blocks that are met
//!     test the blocks, eight triangles at once, but for those that begin behind a hit
//!     step into the next cells; ask for their records
//!     answer the rays that end, whose lanes are free from then on
//! ```
//! The step is the one that the scalar walk makes, over eight lanes instead of one; so the walk visits the same cells.
//!
//! Source: R. Portalez and F. Duguet, "Lancer de rayon dans un octree". Departures from it:
//! 1. Eight rays step at once, and a ray that ends makes room for the next, so that no lane waits for another's end.
//! 2. Several groups are under way, and what a group reads next was asked for while the others had their turn.
//! 3. The exit face is the nearest of three planes, not one that a table of signs gives.
//! 4. A walk starts where the ray enters the hull, by the entry grid unless the caller knows the leaf, and ends where it
//!    leaves the hull.
//! 5. Triangles come in blocks of eight, whose boxes are tested first: there one ray takes all lanes.

mod group;

use leafwalk_core::layout::Block;
use leafwalk_core::start::Span;
use leafwalk_core::{Leaf, Parts};
use rayon::prelude::*;

use super::bvh::BlockSource;
use super::packet::Packet;
use super::query::Query;
use crate::lanes::Eight;
use group::Group;

/// Groups of eight that are under way.
const GROUPS: usize = 4;
/// A bit for each lane of each group.
const ALL: u32 = u32::MAX >> (u32::BITS as usize - 8 * GROUPS);

/// A block that a ray is to be tested against.
#[derive(Clone, Copy, Debug)]
struct Visit {
    /// The ray, by its lane among those of all groups.
    lane: u32,
    /// The block's number.
    block: u32,
    /// t' where the ray enters the block's box.
    first: f32,
}

/// A node below a leaf that a ray is to descend to.
#[derive(Clone, Copy, Debug)]
struct Pending {
    node: u32,
    /// The part of the ray, from t' to t', that lies in the leaf's box around it.
    part: (f32, f32),
}

/// The leaves of a batch, in the order of its rays; by default nothing is known, and nothing asked for.
#[derive(Default)]
pub(crate) struct Leaves<'a> {
    /// Where rays may start. Of those beyond its end nothing is known.
    pub(crate) known: &'a [Leaf],
    /// Where walks end, as far as it has room. [`Leaf::UNKNOWN`] for a ray without a walk.
    pub(crate) ends: &'a mut [Leaf],
}

impl<'a> Leaves<'a> {
    /// Those of each so many rays of a batch.
    pub(crate) fn par_chunks(self, size: usize, rays: usize) -> impl IndexedParallelIterator<Item = Leaves<'a>> {
        let missing = |chunks: usize| (chunks..rays.div_ceil(size)).into_par_iter();
        let (known, ends) = (self.known.par_chunks(size), self.ends.par_chunks_mut(size));
        let (without_known, without_ends) = (missing(known.len()), missing(ends.len()));
        let known = known.chain(without_known.map(|_| [].as_slice()));
        let ends = ends.chain(without_ends.map(|_| [].as_mut_slice()));
        known.zip(ends).map(|(known, ends)| Leaves { known, ends })
    }
}

/// Rays under way.
pub(crate) struct Walk {
    groups: Box<[Group; GROUPS]>,
    /// The lanes without a ray, a bit each.
    free: u32,
    /// The nodes that a ray has still to descend to in its leaf.
    pending: Vec<Pending>,
    /// The blocks to visit in this round.
    visits: Vec<Visit>,
    room: Option<Block>,
}

impl Walk {
    pub(crate) fn new() -> Self {
        let groups = Box::new([const { Group::EMPTY }; GROUPS]);
        Self { groups, free: ALL, pending: Vec::new(), visits: Vec::new(), room: None }
    }

    /// Takes in the rays of a packet, while others are traced to make room; without a packet, traces all to the end. The
    /// answers of rays that miss were written before.
    #[inline(always)]
    pub(crate) fn admit<L: Eight, B: BlockSource, Q: Query>(
        &mut self,
        parts: &Parts<'_>,
        blocks: &B,
        hull: &[[f32; 3]; 2],
        packet: Option<&mut Packet>,
        answers: &mut [Q::Answer],
        Leaves { known, ends }: &mut Leaves<'_>,
    ) {
        let Some(packet) = packet else {
            while self.free != ALL {
                self.round::<L, B, Q>(parts, blocks, answers, ends);
            }
            return;
        };
        let span = Span::new(&packet.line::<L>(), L::load(&packet.t_min), L::load(&packet.t_max), hull);
        let start = [span.start[0].to_array(), span.start[1].to_array(), span.start[2].to_array()];
        let end = span.end.to_array();
        packet.keep(span.is_met);
        while packet.waiting() != 0 {
            if self.free == 0 {
                self.round::<L, B, Q>(parts, blocks, answers, ends);
                continue;
            }
            let lane = self.free.trailing_zeros() as usize;
            self.free &= self.free - 1;
            let from = packet.next();
            let leaf = known.get(packet.first as usize + from).copied().unwrap_or_default();
            let start = [start[0][from], start[1][from], start[2][from]];
            let place = parts.locate(start, packet.neg[from], leaf);
            self.groups[lane / 8 % GROUPS].start(lane % 8, packet, from, end[from], place);
        }
    }

    /// Brings each ray through its cell into the next.
    #[inline(always)]
    fn round<L: Eight, B: BlockSource, Q: Query>(
        &mut self,
        parts: &Parts<'_>,
        blocks: &B,
        answers: &mut [Q::Answer],
        ends: &mut [Leaf],
    ) {
        let Self { groups, free, pending, visits, room } = self;
        for group in groups.iter_mut() {
            group.look::<L>(parts);
        }
        visits.clear();
        for (number, group) in groups.iter().enumerate() {
            group.meet::<L, B>(parts, blocks, 8 * number as u32, pending, visits);
        }
        for Visit { lane, block, first } in visits.iter() {
            let group = &mut groups[*lane as usize / 8 % GROUPS];
            group.visit::<L, B, Q>(*lane as usize % 8, blocks, *block, *first, room);
        }
        for (number, group) in groups.iter_mut().enumerate() {
            *free |= group.step::<L, Q>(parts, answers, ends) << (8 * number);
        }
    }
}
