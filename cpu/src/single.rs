//! One ray, eight lanes.

use core::cell::RefCell;
use core::marker::PhantomData;

use leafwalk_core::Ray;

use crate::descent::descend;
use crate::hierarchy::{Hierarchy, Source};
use crate::lanes::{Eight, Kernel, Registers};
use crate::question::Question;
use crate::ready::Ready;
use crate::stack::Stack;

/// Answers a ray.
#[inline]
pub(crate) fn answer<B: Source, Q: Question>(
    registers: Registers,
    hierarchy: &Hierarchy<'_, B>,
    ray: &Ray,
) -> Q::Answer {
    // A new stack would have to be filled for each ray.
    thread_local!(static STACK: RefCell<Stack> = const { RefCell::new(Stack::new()) });
    STACK.with_borrow_mut(|stack| registers.run(Single::<B, Q> { hierarchy, ray, stack, question: PhantomData }))
}

struct Single<'a, B, Q> {
    hierarchy: &'a Hierarchy<'a, B>,
    ray: &'a Ray,
    stack: &'a mut Stack,
    question: PhantomData<Q>,
}

impl<B: Source, Q: Question> Kernel for Single<'_, B, Q> {
    type Output = Q::Answer;

    #[inline(always)]
    fn run<L: Eight>(self) -> Q::Answer {
        let Some(ray) = self.hierarchy.frame.canonical(self.ray) else { return Q::MISS };
        let ready = Ready::<L>::new(&ray);
        let nearest = if Q::ANY {
            descend::<L, B, true>(self.hierarchy, &ready, self.stack)
        } else {
            descend::<L, B, false>(self.hierarchy, &ready, self.stack)
        };
        Q::answer(&ray.clock, &nearest)
    }
}
