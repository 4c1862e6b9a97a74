//! One ray from the first branch down: eight boxes at once, nearest slot first.
//!
//! The branches are a bounding volume hierarchy over the octree's blocks. A ray that descends it meets the box of every
//! block in which it hits something (ARCHITECTURE.md, "Descent"), so it gives what the walk gives.

use leafwalk_core::Nearest;
use leafwalk_core::triangle::Shear;

use crate::hierarchy::{Hierarchy, ROOT, Source};
use crate::lanes::Eight;
use crate::node::{meet, test_block};
use crate::ready::Ready;
use crate::stack::{END, Stack};

/// The nearest hit of one ray; with `ANY`, some hit.
#[inline(always)]
pub(crate) fn descend<L: Eight, B: Source, const ANY: bool>(
    hierarchy: &Hierarchy<'_, B>,
    ready: &Ready<L>,
    stack: &mut Stack,
) -> Nearest {
    let Ready { slabs, order, neg, mut nearest, .. } = *ready;
    stack.clear();
    let mut child = ROOT;
    let mut room = None;
    loop {
        if let Some(branch) = hierarchy.branch(child) {
            let (first, met) = meet(&slabs, order, branch, &nearest);
            if met != 0 {
                child = stack.enter(branch, neg, first, met);
                continue;
            }
        } else if let Some(block) = hierarchy.block(child, &mut room) {
            test_block(block, &Shear::<L>::splat(&ready.shear), ready.axes, &mut nearest);
            if ANY && nearest.is_hit() {
                return nearest;
            }
        }
        child = stack.pop(nearest.t);
        if child == END {
            return nearest;
        }
    }
}
