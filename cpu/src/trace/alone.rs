//! `Alone`: the packets of a batch that no tile answers, and the way that their rays are traced.

use leafwalk_core::contract::BOX_MARGIN;
use leafwalk_core::layout::LatticeBox;
use leafwalk_core::{Octree, Parts};

use super::bvh::stack::Stack;
use super::bvh::{BlockSource, Bvh};
use super::interleaved::Interleaved;
use super::packet::Packet;
use super::patience::Patience;
use super::query::Query;
use super::single::descend;
use super::stream::Stream;
use super::walk::{Leaves, Walk};
use crate::lanes::Eight;

/// Rays of a batch that are worth a stream.
const LEAST_STREAM: usize = 64;
/// Rays that must meet a node that any meets, on average, or each is faster on its own way.
const LEAST_SHARING: f32 = 3.0;

/// How the rays of a batch are traced. No answer depends on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Way {
    /// As suits each: rays in a row that go alike, together in tiles; the others by the size of the batch, and by how much
    /// the rays before them shared.
    #[default]
    Auto,
    /// Ray by ray down the hierarchy.
    Single,
    /// Down the hierarchy, all rays of an octant together.
    Stream,
    /// Down the hierarchy, twelve at a time, each on its own way.
    Interleaved,
    /// From leaf to leaf of the octree, in groups of eight.
    Walk,
}

/// What a thread keeps from one batch to the next.
pub(crate) struct Scratch {
    /// Made when it is first needed.
    stream: Option<Stream>,
    /// Likewise.
    walk: Option<Walk>,
    /// Whether streams are worth a try.
    patience: Patience,
}

impl Scratch {
    pub(crate) const fn new() -> Self {
        Self { stream: None, walk: None, patience: Patience::new() }
    }
}

/// The rays of a batch that go alone.
pub(crate) struct Alone<'a, L: Eight> {
    way: Way,
    hull: LatticeBox,
    octree: &'a Octree<&'a [u32]>,
    /// What walks want to know of the octree, once they have asked: its sections, and the dilated hull.
    parts: Option<(Parts<'a>, [[f32; 3]; 2])>,
    leaves: Leaves<'a>,
    scratch: &'a mut Scratch,
    interleaved: Interleaved<L>,
}

impl<'a, L: Eight> Alone<'a, L> {
    /// For a batch of so many rays at triangles inside a hull.
    #[inline(always)]
    pub(crate) fn new(
        way: Way,
        rays: usize,
        octree: &'a Octree<&'a [u32]>,
        hull: LatticeBox,
        leaves: Leaves<'a>,
        scratch: &'a mut Scratch,
    ) -> Self {
        let way = if way == Way::Auto && rays < LEAST_STREAM { Way::Single } else { way };
        Self { way, hull, octree, parts: None, leaves, scratch, interleaved: Interleaved::new() }
    }

    /// Takes in the rays of a packet; without a packet, traces all that are left to the end. The answers of rays that miss
    /// were written before.
    #[inline(always)]
    pub(crate) fn admit<B: BlockSource, Q: Query>(
        &mut self,
        bvh: &Bvh<'_, B>,
        mut packet: Option<&mut Packet>,
        stack: &mut Stack,
        answers: &mut [Q::Answer],
    ) {
        match &mut packet {
            Some(packet) => {
                // Walks look at the hull themselves.
                if self.way != Way::Walk {
                    packet.drop_beyond::<L>(&self.hull);
                }
                self.choose();
            }
            // No ray goes alone.
            None if self.way == Way::Auto => return,
            None => {}
        }
        let Scratch { stream, walk, patience } = self.scratch;
        match self.way {
            Way::Auto | Way::Single => {
                let Some(packet) = packet else { return };
                while packet.waiting() != 0 {
                    let (index, probe) = packet.take::<L>();
                    answers[index] = Q::answer(&probe.clock, &descend::<L, B, Q>(bvh, &probe, stack));
                }
            }
            Way::Stream => {
                let is_end = packet.is_none();
                let stream = stream.get_or_insert_with(Stream::new);
                stream.admit::<L, B, Q>(bvh, packet, answers);
                if is_end && let Some(sharing) = stream.take_sharing() {
                    patience.learns(sharing > LEAST_SHARING);
                }
            }
            Way::Interleaved => self.interleaved.admit::<B, Q>(bvh, packet, answers),
            Way::Walk => {
                let (octree, hull) = (self.octree, &self.hull);
                let (parts, hull) = self.parts.get_or_insert_with(|| (octree.parts(), hull.dilated(BOX_MARGIN)));
                let walk = walk.get_or_insert_with(Walk::new);
                walk.admit::<L, B, Q>(parts, &bvh.blocks, hull, packet, answers, &mut self.leaves);
            }
        }
    }

    /// Chooses the way of all rays of the batch, before the first of them is traced.
    #[inline(always)]
    fn choose(&mut self) {
        if self.way == Way::Auto {
            let shares = !L::PREFETCHES || self.scratch.patience.tries();
            self.way = if shares { Way::Stream } else { Way::Interleaved };
        }
    }
}
