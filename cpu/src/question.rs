//! What is asked of each ray.

use leafwalk_core::{Clock, Hit, Nearest};

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
}
