//! Rays one after another, eight lanes a ray.

use leafwalk_core::{Parts, Ray};

use crate::descent::descend;
use crate::lanes::{Eight, Kernel};
use crate::question::Question;
use crate::trail::Trail;

/// Rays to answer.
pub(crate) struct Single<'a, Q: Question> {
    pub(crate) parts: &'a Parts<'a>,
    pub(crate) rays: &'a [Ray],
    pub(crate) answers: &'a mut [Q::Answer],
}

impl<Q: Question> Kernel for Single<'_, Q> {
    type Output = ();

    #[inline(always)]
    fn run<L: Eight>(self) {
        let mut trail = Trail::new();
        for (ray, answer) in self.rays.iter().zip(self.answers) {
            *answer = match self.parts.frame.canonical(ray) {
                Some(ray) if Q::ANY => Q::answer(&ray.clock, &descend::<L, true>(self.parts, &ray, &mut trail)),
                Some(ray) => Q::answer(&ray.clock, &descend::<L, false>(self.parts, &ray, &mut trail)),
                None => Q::MISS,
            };
        }
    }
}
