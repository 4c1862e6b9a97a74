//! One ray, eight lanes.

use core::cell::RefCell;
use core::marker::PhantomData;

use leafwalk_core::{CanonicalRay, Nearest, Ray};

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
    let Some(ray) = hierarchy.frame.canonical(ray) else { return Q::MISS };
    STACK.with_borrow_mut(|stack| {
        let nearest = registers.run(Single::<B, Q> { hierarchy, ray: &ray, stack, question: PhantomData });
        Q::answer(&ray.clock, &nearest)
    })
}

struct Single<'a, B, Q> {
    hierarchy: &'a Hierarchy<'a, B>,
    ray: &'a CanonicalRay,
    stack: &'a mut Stack,
    question: PhantomData<Q>,
}

impl<B: Source, Q: Question> Kernel for Single<'_, B, Q> {
    type Output = Nearest;

    #[inline(always)]
    fn run<L: Eight>(self) -> Nearest {
        let ready = Ready::<L>::new(self.ray);
        if Q::ANY {
            descend::<L, B, true>(self.hierarchy, &ready, self.stack)
        } else {
            descend::<L, B, false>(self.hierarchy, &ready, self.stack)
        }
    }
}
