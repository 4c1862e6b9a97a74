//! A batch of rays, each traced in the way that suits it: runs with one origin as tiles, the others as a stream.

use core::ops::Range;

use leafwalk_core::{Parts, Ray};

use crate::lanes::{Eight, Kernel};
use crate::prepare::Prepared;
use crate::question::Question;
use crate::stream::stream;
use crate::tile::{PACKETS, RAYS, Tile};
use crate::trail::Trail;

/// Rays of one origin that are worth a tile; the tile is filled up with copies.
const LEAST_RUN: usize = 32;

/// A batch of rays to answer.
pub(crate) struct Batch<'a, Q: Question> {
    pub(crate) parts: &'a Parts<'a>,
    pub(crate) rays: &'a [Ray],
    pub(crate) answers: &'a mut [Q::Answer],
}

impl<Q: Question> Kernel for Batch<'_, Q> {
    type Output = ();

    #[inline(always)]
    fn run<L: Eight>(self) {
        let Self { parts, rays, answers } = self;
        answers.fill(Q::MISS);
        if parts.payloads.is_empty() {
            return;
        }
        let mut trail = Trail::new();
        // Rays from here on wait for a stream.
        let mut from = 0;
        while from < rays.len() {
            let tile = next_tile::<L>(parts, rays, from);
            let at = tile.as_ref().map_or(rays.len(), |(run, ..)| run.start);
            stream::<L, Q>(parts, &rays[from..at], &mut answers[from..at]);
            let Some((run, prepared, mut tile)) = tile else { return };
            if Q::ANY {
                tile.trace::<true>(parts, &mut trail);
            } else {
                tile.trace::<false>(parts, &mut trail);
            }
            from = run.end;
            for (ray, answer) in answers[run].iter_mut().enumerate() {
                *answer = Q::answer(&prepared[ray / 8].clocks[ray % 8], &tile.nearest[ray]);
            }
        }
    }
}

/// The first run of rays that makes a tile: where it is, its rays and the tile.
#[inline(always)]
fn next_tile<L: Eight>(
    parts: &Parts<'_>,
    rays: &[Ray],
    from: usize,
) -> Option<(Range<usize>, [Prepared; PACKETS], Tile<L>)> {
    let mut at = from;
    while at < rays.len() {
        let end = at + run_of_one_origin(&rays[at..]);
        if end - at >= LEAST_RUN
            && let Some(prepared) = prepare::<L>(parts, &rays[at..end])
            && let Some(tile) = Tile::<L>::new(&prepared)
        {
            return Some((at..end, prepared, tile));
        }
        at = end;
    }
    None
}

/// How many of the first rays, a tile at the most, have the origin of the first.
#[inline(always)]
fn run_of_one_origin(rays: &[Ray]) -> usize {
    let [x, y, z] = rays[0].origin;
    let is_like = |ray: &&Ray| {
        let [a, b, c] = ray.origin;
        // Bit by bit, so that a NaN is like itself.
        (x.to_bits() ^ a.to_bits()) | (y.to_bits() ^ b.to_bits()) | (z.to_bits() ^ c.to_bits()) == 0
    };
    rays.iter().take(RAYS).take_while(is_like).count()
}

/// The rays of a tile, the last of them repeated until it is full.
#[inline(always)]
fn prepare<L: Eight>(parts: &Parts<'_>, rays: &[Ray]) -> Option<[Prepared; PACKETS]> {
    let mut full = [*rays.last()?; RAYS];
    full[..rays.len()].copy_from_slice(rays);
    let packet = |packet: usize| &full[8 * packet..8 * packet + 8];
    Some([
        Prepared::of::<L>(&parts.frame, packet(0)),
        Prepared::of::<L>(&parts.frame, packet(1)),
        Prepared::of::<L>(&parts.frame, packet(2)),
        Prepared::of::<L>(&parts.frame, packet(3)),
        Prepared::of::<L>(&parts.frame, packet(4)),
        Prepared::of::<L>(&parts.frame, packet(5)),
        Prepared::of::<L>(&parts.frame, packet(6)),
        Prepared::of::<L>(&parts.frame, packet(7)),
    ])
}
