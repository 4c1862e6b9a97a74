//! A batch of rays, each traced in the way that suits it: runs that go the same way as tiles, the others one by one or, in
//! structures that outgrow the caches, several in flight.

use core::ops::Range;

use leafwalk_core::{Frame, Ray};

use crate::hierarchy::{Hierarchy, Source};
use crate::lanes::{Eight, Kernel, eight_times};
use crate::prepare::{PACKETS, Prepared};
use crate::question::Question;
use crate::sequence::sequence;
use crate::stack::Stack;
use crate::stream::stream;
use crate::tile::{RAYS, Tile};

/// Rays that are worth a tile; it is filled up with copies.
const LEAST_RUN: usize = 32;
/// Bytes of branches and blocks that a core's own cache holds: only where they are more it pays to have several rays in
/// flight (ARCHITECTURE.md, "Choices").
const LARGE: usize = 1 << 20;

/// A batch of rays to answer.
pub(crate) struct Batch<'a, B, Q: Question> {
    pub(crate) hierarchy: &'a Hierarchy<'a, B>,
    pub(crate) beam_margin: f32,
    /// Whatever the size of the hierarchy.
    pub(crate) is_in_flight: bool,
    pub(crate) rays: &'a [Ray],
    pub(crate) answers: &'a mut [Q::Answer],
}

impl<B: Source, Q: Question> Kernel for Batch<'_, B, Q> {
    type Output = ();

    #[inline(always)]
    fn run<L: Eight>(self) {
        let Self { hierarchy, beam_margin, is_in_flight, rays, answers } = self;
        answers.fill(Q::MISS);
        if hierarchy.branches.is_empty() {
            return;
        }
        let is_in_flight = is_in_flight || (L::PREFETCHES && hierarchy.size() > LARGE);
        let mut stack = Stack::new();
        // Rays from here on wait until it is known how many are to be traced alone.
        let (mut from, mut at) = (0, 0);
        let mut patience = Patience { failures: 0, skipped: 0 };
        while from < rays.len() {
            let run = next_run(rays, at);
            at = run.end;
            let mut is_traced = false;
            if !run.is_empty() && patience.tries() {
                let prepared = prepare::<L>(&hierarchy.frame, &rays[run.clone()]);
                if let Some(mut tile) = Tile::<L>::new(&prepared, beam_margin) {
                    is_traced = if Q::ANY {
                        tile.trace::<B, true>(hierarchy, &mut stack)
                    } else {
                        tile.trace::<B, false>(hierarchy, &mut stack)
                    };
                    patience.learns(is_traced);
                    if is_traced {
                        for (ray, answer) in answers[run.clone()].iter_mut().enumerate() {
                            *answer = tile.answer::<Q>(ray);
                        }
                    }
                }
            }
            if !is_traced && at < rays.len() {
                continue;
            }
            let alone = from..if is_traced { run.start } else { at };
            if is_in_flight {
                stream::<L, B, Q>(hierarchy, &rays[alone.clone()], &mut answers[alone]);
            } else {
                sequence::<L, B, Q>(hierarchy, &rays[alone.clone()], &mut answers[alone], &mut stack);
            }
            from = at;
        }
    }
}

/// How often to try tiles where they failed.
struct Patience {
    /// In a row.
    failures: u32,
    /// Runs not tried since.
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
fn next_run(rays: &[Ray], mut at: usize) -> Range<usize> {
    while at < rays.len() {
        let octant = octant(&rays[at]);
        let is_like = |ray: &&Ray| self::octant(ray) == octant;
        let end = at + rays[at..].iter().take(RAYS).take_while(is_like).count();
        if end - at >= LEAST_RUN {
            return at..end;
        }
        at = end;
    }
    at..at
}

/// The signs of a direction.
#[inline(always)]
fn octant(ray: &Ray) -> u32 {
    let [x, y, z] = ray.direction;
    x.to_bits() >> 31 | y.to_bits() >> 31 << 1 | z.to_bits() >> 31 << 2
}

/// The rays of a tile, the last of them repeated until it is full.
#[inline(always)]
fn prepare<L: Eight>(frame: &Frame, rays: &[Ray]) -> [Prepared; PACKETS] {
    let mut full = [rays[rays.len() - 1]; RAYS];
    full[..rays.len()].copy_from_slice(rays);
    eight_times!(packet => Prepared::of::<L>(frame, &full[8 * packet..8 * packet + 8]))
}
