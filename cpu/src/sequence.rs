//! Rays that have nothing in common, one after another.

use leafwalk_core::Ray;

use crate::descent::descend;
use crate::hierarchy::{Hierarchy, Source};
use crate::lanes::Eight;
use crate::question::Question;
use crate::stack::Stack;
use crate::waiting::Waiting;

/// Answers rays; the answers are those of misses before.
#[inline(always)]
pub(crate) fn sequence<L: Eight, B: Source, Q: Question>(
    hierarchy: &Hierarchy<'_, B>,
    rays: &[Ray],
    answers: &mut [Q::Answer],
    stack: &mut Stack,
) {
    let mut waiting = Waiting::new(hierarchy, rays);
    while let Some((index, ready)) = waiting.take::<L>() {
        let nearest = if Q::ANY {
            descend::<L, B, true>(hierarchy, &ready, stack)
        } else {
            descend::<L, B, false>(hierarchy, &ready, stack)
        };
        answers[index] = Q::answer(&ready.clock, &nearest);
    }
}
