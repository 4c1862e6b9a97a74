//! Rays that share too little to go down together: several in flight, each on its own way, one branch or block a turn.
//!
//! A ray's turns wait for memory and for each other, those of different rays do not: the machine works on several at once.

use leafwalk_core::Ray;
use leafwalk_core::layout::Block;
use leafwalk_core::triangle::Shear;

use crate::hierarchy::{Hierarchy, ROOT, Source};
use crate::lanes::Eight;
use crate::node::{meet, test_block};
use crate::question::Question;
use crate::ready::Ready;
use crate::stack::{END, Stack};
use crate::waiting::Waiting;

/// Rays in flight. 8 and 16 were not faster, 4 were slower (dragon).
const FLIGHTS: usize = 12;

/// A ray on its way.
struct Flight<L: Eight> {
    ready: Ready<L>,
    /// Which of the batch.
    index: usize,
    /// The child to visit next.
    child: u32,
    stack: Stack,
}

/// Answers rays; the answers are those of misses before.
#[inline(always)]
pub(crate) fn fly<L: Eight, B: Source, Q: Question>(
    hierarchy: &Hierarchy<'_, B>,
    rays: &[Ray],
    answers: &mut [Q::Answer],
) {
    let mut waiting = Waiting::new(hierarchy, rays);
    let mut flights: Vec<Flight<L>> = Vec::with_capacity(FLIGHTS);
    while flights.len() < FLIGHTS
        && let Some((index, ready)) = waiting.take()
    {
        flights.push(Flight { ready, index, child: ROOT, stack: Stack::new() });
    }
    let (mut at, mut room) = (0, None);
    while !flights.is_empty() {
        at = if at < flights.len() { at } else { 0 };
        let flight = &mut flights[at];
        flight.turn::<B, Q>(hierarchy, &mut room);
        if flight.child != END {
            at += 1;
            continue;
        }
        answers[flight.index] = Q::answer(&flight.ready.clock, &flight.ready.nearest);
        match waiting.take() {
            Some((index, ready)) => {
                (flight.index, flight.ready, flight.child) = (index, ready, ROOT);
                flight.stack.clear();
            }
            None => drop(flights.swap_remove(at)),
        }
    }
}

impl<L: Eight> Flight<L> {
    /// Visits a branch or a block, and asks for the next.
    #[inline(always)]
    fn turn<B: Source, Q: Question>(&mut self, hierarchy: &Hierarchy<'_, B>, room: &mut Option<Block>) {
        let Ready { slabs, order, shear, axes, neg, nearest, .. } = &mut self.ready;
        if let Some(branch) = hierarchy.branch(self.child) {
            let (first, met) = meet(slabs, *order, branch, nearest);
            self.stack.push(branch, *neg, first, met);
        } else if let Some(block) = hierarchy.block(self.child, room) {
            test_block(block, &Shear::<L>::splat(shear), *axes, nearest);
            if Q::ANY && nearest.is_hit() {
                self.child = END;
                return;
            }
        }
        self.child = self.stack.pop(nearest.t);
        hierarchy.prefetch::<L>(self.child);
    }
}
