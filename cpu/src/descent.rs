//! One ray from the root down: eight boxes of a payload at once, nearest octant first.
//!
//! The octree's payloads are a bounding volume hierarchy of eight children a node. A ray that descends it meets the box
//! of every block in which it hits something (ARCHITECTURE.md, "Descent"), so it gives what the walk gives.

use leafwalk_core::boxes::Slabs;
use leafwalk_core::layout::NONE;
use leafwalk_core::step::Line;
use leafwalk_core::triangle::Shear;
use leafwalk_core::{CanonicalRay, Nearest, Parts, per_axis};

use crate::lanes::Eight;
use crate::node::{meet, test_block};
use crate::trail::Trail;

/// The nearest hit of one ray; with `ANY`, some hit.
#[inline(always)]
pub(crate) fn descend<L: Eight, const ANY: bool>(parts: &Parts<'_>, ray: &CanonicalRay, trail: &mut Trail) -> Nearest {
    let mut nearest = Nearest::new(ray);
    let line = Line::<f32>::new(ray);
    let (shear, axes) = Shear::<L>::new(ray);
    let slabs = Slabs::<L>::new(per_axis!(k => L::splat(line.origin[k])), per_axis!(k => L::splat(line.inverse[k])));
    trail.clear();
    let mut node = 0;
    while let Some(payload) = parts.payloads.get(node as usize) {
        let (first, mut met) = meet(&slabs, line.neg, payload, &nearest);
        if payload.children != 0 && met != 0 {
            node = trail.enter(payload, line.neg, met, first);
            continue;
        }
        while payload.children == 0 && met != 0 {
            let b = met.trailing_zeros();
            met &= met - 1;
            if first[b as usize & 7] <= nearest.t {
                test_block::<L>(&parts.blocks[(payload.first + b) as usize], &shear, axes, &mut nearest);
                if ANY && nearest.is_hit() {
                    return nearest;
                }
            }
        }
        node = if payload.next != NONE { payload.next } else { trail.back(line.neg, nearest.t) };
    }
    nearest
}
