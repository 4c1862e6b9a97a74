//! The eight-lane machine: how a batch of rays is traced, each in the way that suits it.
//!
//! ```text
//! for each eight rays of the batch: make them a packet, once
//!     the packet is uniform and goes with those before it: it joins the run
//!     else the run ends, as it does with eight packets and with the batch:
//!         a run of four packets or more: a tile, if its rays have enough in common; it answers them
//!         packets that no tile answered go alone:
//!             a small batch:                   ray by ray                  (single)
//!             rays that meet the same nodes:   those of an octant together (stream)
//!             rays that share too little:      twelve at a time            (interleaved)
//! ```
//!
//! A caller may force one of these ways, without tiles, or the walk from leaf to leaf in eight lanes (walk), which is not
//! chosen otherwise.
//!
//! Every way meets all boxes of a ray's hits and orders hits alike, so all give the same bits (docs/contract.md,
//! "Descent" and "The walk"); which way a ray goes is a matter of speed alone.

mod alone;
pub(crate) mod bvh;
mod interleaved;
pub(crate) mod packet;
mod patience;
pub(crate) mod probe;
pub(crate) mod query;
mod run;
pub(crate) mod single;
mod stream;
mod tile;
mod walk;

use leafwalk_core::{Leaf, Octree, Ray};

use crate::lanes::{Eight, Kernel};
use alone::Alone;
pub(crate) use alone::Scratch;
pub use alone::Way;
use bvh::stack::TileStack;
use bvh::{BlockSource, Bvh};
use packet::Packet;
use patience::Patience;
use query::Query;
use run::Run;
use tile::Tile;
pub(crate) use tile::Tiling;
pub(crate) use walk::Leaves;

/// Packets that are worth a tile, which is filled up with repetitions of the last one.
const LEAST_RUN: usize = 4;

/// A batch of rays to answer.
pub(crate) struct Batch<'a, B, Q: Query> {
    pub(crate) octree: &'a Octree<&'a [u32]>,
    pub(crate) bvh: &'a Bvh<'a, B>,
    pub(crate) tiling: Tiling,
    pub(crate) way: Way,
    pub(crate) scratch: &'a mut Scratch,
    pub(crate) rays: &'a [Ray],
    /// Walks alone look at them.
    pub(crate) leaves: Leaves<'a>,
    pub(crate) answers: &'a mut [Q::Answer],
}

impl<B: BlockSource, Q: Query> Kernel for Batch<'_, B, Q> {
    type Output = ();

    #[inline(always)]
    fn run<L: Eight>(self) {
        let Self { octree, bvh, tiling, way, scratch, rays, leaves, answers } = self;
        answers.fill(Q::MISS);
        leaves.ends.fill(Leaf::UNKNOWN);
        if bvh.nodes.is_empty() {
            return;
        }
        let mut waiting = TileStack::new();
        let mut alone = Alone::<L>::new(way, rays.len(), octree, bvh.hull(), leaves, scratch);
        let mut patience = Patience::new();
        let mut run = Run::new();
        let mut eights = (0..).step_by(8).zip(rays.chunks(8));
        loop {
            let next = eights.next();
            let is_end = next.is_none();
            if let Some((first, eight)) = next {
                *run.slot() = Packet::new::<L>(&bvh.frame, eight, first);
                if run.goes_on() {
                    continue;
                }
            }
            let mut at = 0;
            let is_tried = match tiling.takes_every_run {
                true => run.len() > 0,
                false => way == Way::Auto && run.len() >= LEAST_RUN && patience.tries(),
            };
            if is_tried {
                let (first, len) = (run.first(), run.len());
                if let Some(mut tile) = Tile::<L>::new::<B>(run.fill_up(), bvh.frame.frame().corner, tiling) {
                    let is_answered = tile.trace::<B, Q>(bvh, &mut waiting);
                    patience.learns(is_answered);
                    if is_answered {
                        tile.answer::<Q>(&mut answers[first..rays.len().min(first + 8 * len)]);
                        at = len;
                    }
                }
            }
            loop {
                let packet = run.alone(at);
                let is_last = packet.is_none();
                if is_last && !is_end {
                    break;
                }
                alone.admit::<B, Q>(bvh, packet, &mut waiting.stack, answers);
                if is_last {
                    return;
                }
                at += 1;
            }
            run.restart();
        }
    }
}
