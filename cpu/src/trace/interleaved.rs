//! Rays that share too little to go down together: twelve at a time, each on its own way, one node or block a turn.
//!
//! ```text
//! for each ray that comes in:
//!     a slot is free:  the ray starts there at the root
//!     no slot is free: the rays in the slots take turns, round robin, until one ends
//! a turn: visit a node or a block, as a single ray does; pop the next child; prefetch it
//! ```
//! The turns of one ray wait for memory and for each other, those of different rays do not: the machine works on several
//! at once.

use leafwalk_core::layout::Block;

use super::bvh::node::{boxes_hit, test_block};
use super::bvh::stack::{END, Stack};
use super::bvh::{BlockSource, Bvh, ROOT};
use super::packet::Packet;
use super::probe::Probe;
use super::query::Query;
use crate::lanes::Eight;

/// Rays under way at a time. 8 and 16 were not faster, 4 were slower (dragon).
const SLOTS: usize = 12;

/// Rays under way, and the blocks that they look at where these must be put together.
pub(crate) struct Interleaved<L: Eight> {
    slots: Vec<Slot<L>>,
    /// Whose turn it is.
    turn: usize,
    /// The ray whose turn it is has ended and was answered.
    is_free: bool,
    room: Option<Block>,
}

/// A ray on its way.
struct Slot<L: Eight> {
    probe: Probe<L>,
    /// The place of the ray in the batch.
    index: usize,
    /// The child to visit next.
    child: u32,
    stack: Stack,
}

impl<L: Eight> Interleaved<L> {
    #[inline(always)]
    pub(crate) const fn new() -> Self {
        Self { slots: Vec::new(), turn: 0, is_free: false, room: None }
    }

    /// Takes in the rays of a packet, while others are traced to make room; without a packet, traces all to the end. The
    /// answers of rays that miss were written before.
    #[inline(always)]
    pub(crate) fn admit<B: BlockSource, Q: Query>(
        &mut self,
        bvh: &Bvh<'_, B>,
        packet: Option<&mut Packet>,
        answers: &mut [Q::Answer],
    ) {
        let Some(packet) = packet else {
            while !self.slots.is_empty() {
                if self.is_free {
                    self.slots.swap_remove(self.turn);
                    self.is_free = false;
                } else {
                    self.trace::<B, Q>(bvh, answers);
                }
            }
            return;
        };
        while packet.waiting() != 0 {
            if self.is_free {
                self.is_free = false;
                let slot = &mut self.slots[self.turn];
                (slot.index, slot.probe) = packet.take();
                slot.child = ROOT;
                slot.stack.clear();
            } else {
                self.add(packet);
            }
            if self.slots.len() == SLOTS {
                self.trace::<B, Q>(bvh, answers);
            }
        }
    }

    /// Adds a slot, in which the next ray of a packet starts. That is rare, and kept out of the code around it.
    #[inline(never)]
    fn add(&mut self, packet: &mut Packet) {
        // Room for all: a slot is two kilobytes, too many to be moved as the list grows.
        self.slots.reserve_exact(SLOTS - self.slots.len());
        let (index, probe) = packet.take();
        self.slots.push(Slot { probe, index, child: ROOT, stack: Stack::new() });
    }

    /// Lets the rays take turns until one ends, and answers it.
    #[inline(always)]
    fn trace<B: BlockSource, Q: Query>(&mut self, bvh: &Bvh<'_, B>, answers: &mut [Q::Answer]) {
        let (slots, mut turn) = (self.slots.as_mut_slice(), self.turn);
        loop {
            turn = if turn < slots.len() { turn } else { 0 };
            let slot = &mut slots[turn];
            slot.visit::<B, Q>(bvh, &mut self.room);
            if slot.child == END {
                answers[slot.index] = Q::answer(&slot.probe.clock, &slot.probe.nearest);
                break;
            }
            turn += 1;
        }
        (self.turn, self.is_free) = (turn, true);
    }
}

impl<L: Eight> Slot<L> {
    /// Visits a node or a block, and asks for the next.
    #[inline(always)]
    fn visit<B: BlockSource, Q: Query>(&mut self, bvh: &Bvh<'_, B>, room: &mut Option<Block>) {
        if let Some(node) = bvh.node(self.child) {
            let Probe { slabs, origin, order, neg, nearest, .. } = &self.probe;
            let slabs = bvh.blocks.slabs(self.child, slabs, *origin);
            let (first, met) = boxes_hit(&slabs, *order, node, nearest);
            self.stack.push(node, *neg, first, met);
        } else if let Some(block) = bvh.block(self.child, room) {
            let Probe { shear, axes, nearest, .. } = &mut self.probe;
            let (shear, axes) = (&*shear, &*axes);
            test_block::<L, Q>(block, (*shear, *axes), move || (*shear, *axes), nearest);
            if Q::ANY && nearest.is_hit() {
                self.child = END;
                return;
            }
        }
        self.child = self.stack.pop(self.probe.nearest.t);
        bvh.prefetch::<L>(self.child);
    }
}
