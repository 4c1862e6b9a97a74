//! One ray at a time: it descends the BVH from the root, eight boxes at once, nearest slot first.
//!
//! ```text
//! child = root
//! loop:
//!     child is a node:   test its eight boxes; enter the nearest that is hit, the others wait on the stack
//!     child is a block:  test its eight triangles; keep the nearest hit
//!     no box was hit, or child was a block: pop the next child that is entered before the nearest hit
//!     the stack is empty: done
//! ```
//! A ray meets the box of every block in which it hits something (docs/contract.md, "Descent"), so it gets what the walk
//! from leaf to leaf gives.

use core::cell::RefCell;
use core::marker::PhantomData;

use leafwalk_core::{CanonicalRay, Nearest, Ray};

use super::bvh::node::{boxes_hit, test_block};
use super::bvh::stack::{END, Stack};
use super::bvh::{BlockSource, Bvh, ROOT};
use super::probe::Probe;
use super::query::Query;
use crate::lanes::{Eight, Kernel, Registers};

/// The nearest hit of a ray, or any hit where that is the query.
#[inline(always)]
pub(crate) fn descend<L: Eight, B: BlockSource, Q: Query>(
    bvh: &Bvh<'_, B>,
    probe: &Probe<L>,
    stack: &mut Stack,
) -> Nearest {
    let Probe { slabs, origin, order, neg, shear, axes, mut nearest, .. } = *probe;
    stack.clear();
    let mut child = ROOT;
    let mut room = None;
    loop {
        if let Some(node) = bvh.node(child) {
            let (first, met) = boxes_hit(&bvh.blocks.slabs(child, &slabs, origin), order, node, &nearest);
            if met != 0 {
                child = stack.enter(node, neg, first, met);
                continue;
            }
        } else if let Some(block) = bvh.block(child, &mut room) {
            test_block::<L, Q>(block, (shear, axes), move || (shear, axes), &mut nearest);
            if Q::ANY && nearest.is_hit() {
                return nearest;
            }
        }
        child = stack.pop(nearest.t);
        if child == END {
            return nearest;
        }
    }
}

// A new stack would have to be filled for each ray.
thread_local!(static STACK: RefCell<Stack> = const { RefCell::new(Stack::new()) });

/// Answers a query for one ray, as a call of its own.
#[inline]
pub(crate) fn answer<B: BlockSource, Q: Query>(registers: Registers, bvh: &Bvh<'_, B>, ray: &Ray) -> Q::Answer {
    STACK.with_borrow_mut(|stack| registers.run(Single::<B, Q> { bvh, ray, stack, query: PhantomData }))
}

/// One ray as work for lanes.
struct Single<'a, B, Q> {
    bvh: &'a Bvh<'a, B>,
    ray: &'a Ray,
    stack: &'a mut Stack,
    query: PhantomData<Q>,
}

impl<B: BlockSource, Q: Query> Kernel for Single<'_, B, Q> {
    type Output = Q::Answer;

    #[inline(always)]
    fn run<L: Eight>(self) -> Q::Answer {
        let Some(ray) = self.bvh.frame.canonical(self.ray) else { return Q::MISS };
        let nearest = descend::<L, B, Q>(self.bvh, &Probe::new(&ray), self.stack);
        Q::answer(&ray.clock, &nearest)
    }
}

/// [`descend`] for one ray that is canonical already, as a call of its own.
pub(crate) fn nearest<B: BlockSource, Q: Query>(registers: Registers, bvh: &Bvh<'_, B>, ray: &CanonicalRay) -> Nearest {
    STACK.with_borrow_mut(|stack| registers.run(Canonical::<B, Q> { bvh, ray, stack, query: PhantomData }))
}

/// One canonical ray as work for lanes.
struct Canonical<'a, B, Q> {
    bvh: &'a Bvh<'a, B>,
    ray: &'a CanonicalRay,
    stack: &'a mut Stack,
    query: PhantomData<Q>,
}

impl<B: BlockSource, Q: Query> Kernel for Canonical<'_, B, Q> {
    type Output = Nearest;

    #[inline(always)]
    fn run<L: Eight>(self) -> Nearest {
        descend::<L, B, Q>(self.bvh, &Probe::new(self.ray), self.stack)
    }
}
