//! What is asked of each ray.

use leafwalk_core::lanes::Mask as _;
use leafwalk_core::{Clock, Hit, Nearest};

use crate::lanes::{Eight, eight_times};
use crate::prepare::Clocks;

/// A kind of answer.
pub(crate) trait Question {
    /// What is told of each ray.
    type Answer: Copy + Send;
    /// Of a ray that hits nothing, or is invalid.
    const MISS: Self::Answer;
    /// Whether any hit answers it.
    const ANY: bool;
    /// Of a ray that was searched to the end.
    fn answer(clock: &Clock, nearest: &Nearest) -> Self::Answer;
    /// Of eight such rays.
    fn answers<L: Eight>(clocks: &Clocks, nearest: &Nearest<L>) -> [Self::Answer; 8];
}

/// Where is it hit first?
#[derive(Clone, Copy, Debug)]
pub(crate) struct Closest;

impl Question for Closest {
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
        // All else of a miss is so already.
        let t = clocks.reported(t).or_else(nearest.is_hit(), L::splat(Hit::MISS.t));
        let zero = L::splat(0.0);
        let rows = L::transpose([t, u, v, L::from_bits(primitive), zero, zero, zero, zero]);
        eight_times!(lane => {
            let [t, u, v, primitive, ..] = rows[lane].to_array();
            Hit { t, u, v, primitive: primitive.to_bits() }
        })
    }
}

/// Is anything hit?
#[derive(Clone, Copy, Debug)]
pub(crate) struct Occluded;

impl Question for Occluded {
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
        eight_times!(lane => is_hit >> lane & 1 == 1)
    }
}
