//! Rays that have nothing in common: several in flight, each on its own way down, one node a turn.
//!
//! A ray's turns depend on each other, those of different rays do not: the machine works on several at once.

use leafwalk_core::layout::NONE;
use leafwalk_core::triangle::Shear;
use leafwalk_core::{Parts, Ray};

use crate::lanes::Eight;
use crate::node::{meet, test_block};
use crate::prepare::{Prepared, Ready};
use crate::question::Question;
use crate::trail::Trail;

/// Rays in flight.
const FLIGHTS: usize = 12;

/// A ray on its way.
struct Flight<L> {
    ready: Ready<L>,
    /// Which of the batch.
    index: usize,
    /// The payload to visit next.
    node: u32,
    trail: Trail,
}

/// A block that a flight is to test.
#[derive(Clone, Copy)]
struct Queued {
    flight: u32,
    block: u32,
}

/// Answers rays; the answers are those of misses before.
#[inline(always)]
pub(crate) fn stream<L: Eight, Q: Question>(parts: &Parts<'_>, rays: &[Ray], answers: &mut [Q::Answer]) {
    let mut waiting = Waiting { parts, rays, next: 0, prepared: Prepared::none() };
    let mut flights: Vec<Flight<L>> = Vec::with_capacity(FLIGHTS);
    while flights.len() < FLIGHTS
        && let Some((index, ready)) = waiting.take()
    {
        flights.push(Flight { ready, index, node: 0, trail: Trail::new() });
    }
    let mut queue = [Queued { flight: 0, block: 0 }; 8 * FLIGHTS];
    let mut landed = [0u8; FLIGHTS];
    while !flights.is_empty() {
        let (mut queued, mut landings) = (0, 0);
        for (number, flight) in flights.iter_mut().enumerate() {
            let Ready { slabs, neg, nearest, .. } = &flight.ready;
            let payload = &parts.payloads[flight.node as usize];
            let (first, mut met) = meet(slabs, *neg, payload, nearest);
            let is_inner = payload.children != 0;
            flight.trail.wait(payload, *neg, if is_inner { met } else { 0 }, first);
            met = if is_inner { 0 } else { met };
            while met != 0 {
                let block = payload.first + met.trailing_zeros();
                L::prefetch(&parts.blocks[block as usize]);
                queue[queued] = Queued { flight: number as u32, block };
                queued += 1;
                met &= met - 1;
            }
            let next = if payload.next != NONE { payload.next } else { flight.trail.back(*neg, nearest.t) };
            flight.node = next;
            if let Some(payload) = parts.payloads.get(next as usize) {
                L::prefetch(payload);
            } else {
                landed[landings] = number as u8;
                landings += 1;
            }
        }
        for Queued { flight, block } in &queue[..queued] {
            let Ready { shear, axes, nearest, .. } = &mut flights[*flight as usize].ready;
            if Q::ANY && nearest.is_hit() {
                continue;
            }
            test_block(&parts.blocks[*block as usize], &Shear::<L>::splat(shear), *axes, nearest);
        }
        if Q::ANY {
            landings = 0;
            for (number, flight) in flights.iter().enumerate() {
                landed[landings] = number as u8;
                landings += usize::from(flight.node == NONE || flight.ready.nearest.is_hit());
            }
        }
        // From the last, so that those before keep their places.
        for &number in landed[..landings].iter().rev() {
            let number = usize::from(number);
            let flight = &mut flights[number];
            answers[flight.index] = Q::answer(&flight.ready.clock, &flight.ready.nearest);
            match waiting.take() {
                Some((index, ready)) => {
                    (flight.index, flight.ready, flight.node) = (index, ready, 0);
                    flight.trail.clear();
                }
                None => drop(flights.swap_remove(number)),
            }
        }
    }
}

/// The rays that are not in flight yet.
struct Waiting<'a> {
    parts: &'a Parts<'a>,
    rays: &'a [Ray],
    /// The first ray that is not prepared.
    next: usize,
    prepared: Prepared,
}

impl Waiting<'_> {
    /// The next ray that can hit anything.
    #[inline(always)]
    fn take<L: Eight>(&mut self) -> Option<(usize, Ready<L>)> {
        loop {
            if let Some((lane, ready)) = self.prepared.take() {
                return Some((self.next - EIGHT + lane, ready));
            }
            if self.next >= self.rays.len() {
                return None;
            }
            let end = self.rays.len().min(self.next + EIGHT);
            self.prepared = Prepared::of::<L>(&self.parts.frame, &self.rays[self.next..end]);
            self.next += EIGHT;
        }
    }
}

/// Rays that are prepared at a time.
const EIGHT: usize = 8;
