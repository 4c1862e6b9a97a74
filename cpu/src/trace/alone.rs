//! `Alone`: the packets of a batch that no tile answers, and the way that their rays are traced.

use leafwalk_core::layout::LatticeBox;

use super::bvh::stack::Stack;
use super::bvh::{BlockSource, Bvh};
use super::interleaved::Interleaved;
use super::packet::Packet;
use super::patience::Patience;
use super::query::Query;
use super::single::descend;
use super::stream::Stream;
use crate::lanes::Eight;

/// Rays of a batch that are worth a stream.
const LEAST_STREAM: usize = 64;
/// Rays that must meet a node that any meets, on average, or each is faster on its own way.
const LEAST_SHARING: f32 = 3.0;

/// How rays are traced that no tile answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    /// As suits the size of the batch, and how much the rays before them shared.
    Auto,
    /// Ray by ray.
    Single,
    /// All rays of an octant together.
    Stream,
    /// Twelve at a time, each on its own way.
    Interleaved,
}

/// What a thread keeps from one batch to the next.
pub(crate) struct Scratch {
    /// Made when it is first needed.
    stream: Option<Stream>,
    /// Whether streams are worth a try.
    patience: Patience,
}

impl Scratch {
    pub(crate) const fn new() -> Self {
        Self { stream: None, patience: Patience::new() }
    }
}

/// The rays of a batch that go alone.
pub(crate) struct Alone<'a, L: Eight> {
    way: Way,
    hull: LatticeBox,
    scratch: &'a mut Scratch,
    interleaved: Interleaved<L>,
}

impl<'a, L: Eight> Alone<'a, L> {
    /// For a batch of so many rays at triangles inside a hull.
    #[inline(always)]
    pub(crate) fn new(way: Way, rays: usize, hull: LatticeBox, scratch: &'a mut Scratch) -> Self {
        let way = if way == Way::Auto && rays < LEAST_STREAM { Way::Single } else { way };
        Self { way, hull, scratch, interleaved: Interleaved::new() }
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
                packet.drop_beyond::<L>(&self.hull);
                self.choose();
            }
            // No ray goes alone.
            None if self.way == Way::Auto => return,
            None => {}
        }
        let Scratch { stream, patience } = self.scratch;
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
