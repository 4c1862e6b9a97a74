//! `Query`: what is asked of each ray. The ways of tracing are written once and compiled for both queries.

use leafwalk_core::lanes::Mask as _;
use leafwalk_core::{Clock, Hit, Nearest, unroll, weight_of_vertex_2};

use super::packet::Clocks;
use crate::lanes::Eight;

/// A kind of question, and how the nearest hit answers it.
pub(crate) trait Query {
    /// What is told of each ray.
    type Answer: Copy + Send;
    /// The answer for a ray that hits nothing, or is invalid.
    const MISS: Self::Answer;
    /// Whether any hit answers the query, so that a ray is done at its first.
    const ANY: bool;
    /// The answer for a ray that was searched to the end.
    fn answer(clock: &Clock, nearest: &Nearest) -> Self::Answer;
    /// The answers for a packet of rays that were searched to the end.
    fn answers<L: Eight>(clocks: &Clocks, nearest: &Nearest<L>) -> [Self::Answer; 8];
}

/// Where is the ray hit first?
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClosestHit;

impl Query for ClosestHit {
    type Answer = Hit;
    const MISS: Hit = Hit::MISS;
    const ANY: bool = false;
    #[inline(always)]
    fn answer(clock: &Clock, nearest: &Nearest) -> Hit {
        nearest.hit(clock)
    }
    #[inline(always)]
    fn answers<L: Eight>(clocks: &Clocks, nearest: &Nearest<L>) -> [Hit; 8] {
        let Nearest { t, u, v, primitive, .. } = *nearest;
        // The other fields of a lane without a hit are those of a miss already.
        let t = clocks.reported(t).or_else(nearest.is_hit(), L::splat(Hit::MISS.t));
        let v = weight_of_vertex_2(u, v);
        let zero = L::splat(0.0);
        let rows = L::transpose([t, u, v, L::from_bits(primitive), zero, zero, zero, zero]);
        unroll!(lane in 0..8 => {
            let [t, u, v, primitive, ..] = rows[lane].to_array();
            Hit { t, u, v, primitive: primitive.to_bits() }
        })
    }
}

/// Is the ray hit at all?
#[derive(Clone, Copy, Debug)]
pub(crate) struct AnyHit;

impl Query for AnyHit {
    type Answer = bool;
    const MISS: bool = false;
    const ANY: bool = true;
    #[inline(always)]
    fn answer(_: &Clock, nearest: &Nearest) -> bool {
        nearest.is_hit()
    }
    #[inline(always)]
    fn answers<L: Eight>(_: &Clocks, nearest: &Nearest<L>) -> [bool; 8] {
        let is_hit = nearest.is_hit().to_bits();
        unroll!(lane in 0..8 => is_hit >> lane & 1 == 1)
    }
}
