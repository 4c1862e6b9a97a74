//! A batch of rays, each traced in the way that suits it: runs that go the same way as tiles, the others in streams or,
//! where they share too little, in flight; a few, one by one.

use core::ops::Range;

use leafwalk_core::{Frame, Ray};

use crate::flights::fly;
use crate::hierarchy::{Hierarchy, Source};
use crate::lanes::{Eight, Kernel};
use crate::prepare::{PACKETS, Prepared};
use crate::question::Question;
use crate::sequence::sequence;
use crate::stack::Stack;
use crate::stream::Stream;
use crate::tile::{RAYS, Tile, Tiling};

/// Rays that are worth a tile; it is filled up with copies.
const LEAST_RUN: usize = 32;
/// Rays that are worth a stream.
const LEAST_STREAM: usize = 64;
/// Rays that must meet a branch of those that any meets, on average, or they had better go their own ways.
const LEAST_SHARE: f32 = 3.0;

/// A batch of rays to answer.
pub(crate) struct Batch<'a, B, Q: Question> {
    pub(crate) hierarchy: &'a Hierarchy<'a, B>,
    pub(crate) tiling: Tiling,
    pub(crate) way: Way,
    pub(crate) scratch: &'a mut Scratch,
    pub(crate) rays: &'a [Ray],
    pub(crate) answers: &'a mut [Q::Answer],
}

impl<B: Source, Q: Question> Kernel for Batch<'_, B, Q> {
    type Output = ();

    #[inline(always)]
    fn run<L: Eight>(self) {
        let Self { hierarchy, tiling, way, scratch, rays, answers } = self;
        answers.fill(Q::MISS);
        if hierarchy.branches.is_empty() {
            return;
        }
        let mut stack = Stack::new();
        let mut packets = [const { Prepared::none() }; PACKETS];
        // Rays from here on wait until it is known how many are to be traced alone.
        let (mut from, mut at) = (0, 0);
        let mut patience = Patience { failures: 0, skipped: 0 };
        while from < rays.len() {
            let run = next_run::<L>(rays, at);
            at = run.end;
            let mut is_traced = false;
            if !run.is_empty() && patience.tries() {
                prepare::<L>(&mut packets, &hierarchy.frame, &rays[run.clone()]);
                if let Some(mut tile) = Tile::<L>::new(&packets, tiling) {
                    is_traced = if Q::ANY {
                        tile.trace::<B, true>(hierarchy, &mut stack)
                    } else {
                        tile.trace::<B, false>(hierarchy, &mut stack)
                    };
                    patience.learns(is_traced);
                    if is_traced {
                        tile.answer::<Q>(&mut answers[run.clone()]);
                    }
                }
            }
            if !is_traced && at < rays.len() {
                continue;
            }
            let alone = from..if is_traced { run.start } else { at };
            scratch.answer::<L, B, Q>(hierarchy, way, &rays[alone.clone()], &mut answers[alone], &mut stack);
            from = at;
        }
    }
}

/// How rays are traced that no tile holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    /// As suits their number, and how much those before them shared.
    Measured,
    /// Those of an octant together.
    Stream,
    /// Several in flight.
    Flights,
}

/// What a thread keeps from one batch to the next.
pub(crate) struct Scratch {
    /// Made when it is first needed.
    stream: Option<Stream>,
    /// With streams.
    patience: Patience,
}

impl Scratch {
    pub(crate) fn new() -> Self {
        Self { stream: None, patience: Patience { failures: 0, skipped: 0 } }
    }

    /// Answers rays that no tile holds.
    #[inline(always)]
    fn answer<L: Eight, B: Source, Q: Question>(
        &mut self,
        hierarchy: &Hierarchy<'_, B>,
        way: Way,
        rays: &[Ray],
        answers: &mut [Q::Answer],
        stack: &mut Stack,
    ) {
        let way = match way {
            Way::Measured if rays.len() < LEAST_STREAM => return sequence::<L, B, Q>(hierarchy, rays, answers, stack),
            Way::Measured if !L::PREFETCHES || self.patience.tries() => Way::Stream,
            Way::Measured => Way::Flights,
            way => way,
        };
        if way == Way::Stream {
            let stream = self.stream.get_or_insert_with(Stream::new);
            let share = stream.trace::<L, B, Q>(hierarchy, rays, answers);
            self.patience.learns(share > LEAST_SHARE);
        } else {
            fly::<L, B, Q>(hierarchy, rays, answers);
        }
    }
}

/// How often to try a way that failed.
struct Patience {
    /// In a row.
    failures: u32,
    /// Chances since then that were passed by.
    skipped: u32,
}

impl Patience {
    /// Whether the next run is worth a try: fewer and fewer are.
    #[inline(always)]
    fn tries(&mut self) -> bool {
        self.skipped += 1;
        self.skipped >> (2 * self.failures).min(16) > 0
    }

    #[inline(always)]
    fn learns(&mut self, is_traced: bool) {
        self.failures = if is_traced { 0 } else { self.failures + 1 };
        self.skipped = 0;
    }
}

/// The next rays, a tile at the most, that are worth one as far as their octants tell; where there are none, the end.
#[inline(always)]
fn next_run<L: Eight>(rays: &[Ray], mut at: usize) -> Range<usize> {
    while at + LEAST_RUN <= rays.len() {
        // Every run that starts between here and there goes on from there to its last ray at least.
        let there = at + LEAST_RUN - 1;
        let octant = octant::<L>(&rays[there]);
        let is_like = |ray: &&Ray| self::octant::<L>(ray) == octant;
        let start = there - rays[at..there].iter().rev().take_while(is_like).count();
        let end =
            start + rays[start..].iter().take(RAYS).skip(there - start).take_while(is_like).count() + there - start;
        if end - start >= LEAST_RUN {
            return start..end;
        }
        at = end;
    }
    rays.len()..rays.len()
}

/// The signs of a direction.
#[inline(always)]
fn octant<L: Eight>(ray: &Ray) -> u32 {
    // After the origin and t_min.
    L::load(bytemuck::cast_ref(ray)).signs() >> 4 & 7
}

/// Makes the rays of a tile ready, the last of them repeated until it is full.
#[inline(always)]
fn prepare<L: Eight>(packets: &mut [Prepared; PACKETS], frame: &Frame, rays: &[Ray]) {
    let mut filled;
    for (packet, prepared) in packets.iter_mut().enumerate() {
        let begin = rays.len().min(8 * packet);
        let mut eight = &rays[begin..rays.len().min(begin + 8)];
        if eight.len() < 8 {
            filled = [rays[rays.len() - 1]; 8];
            filled[..eight.len()].copy_from_slice(eight);
            eight = &filled;
        }
        *prepared = Prepared::of::<L>(frame, eight);
    }
}
