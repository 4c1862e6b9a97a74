//! Wide scenes: where the detail takes few of the root's steps, the boxes of each node count steps of a lattice of its own.

use leafwalk_core::Frame;
use leafwalk_core::contract::BOX_MARGIN;
use leafwalk_core::layout::{BVH_WIDTH, Child, Lattice, LatticeBox, Triangle};
use rayon::prelude::*;

use super::Hierarchy;
use super::item::Item;
use crate::build::settings::Spoiled;
use crate::build::span::Span;

/// How much larger a block's box may become by the root's steps and by the box margin, in surface, before it counts.
const MOST_INFLATION: f32 = 2.0;
/// The share of blocks that count from which on a scene is wide: it is 0.44 in the conference room, 0.01 for a bunny in a sky box
/// of 100 times its size, and 0.998 in one of 300.
const WIDE_SHARE: f32 = 0.75;
/// About so many blocks tell the share of all.
const SAMPLE: u32 = 1024;

impl Hierarchy {
    /// Gives each node a lattice of its own, and its boxes in steps of that, where the root's steps are too long for many
    /// blocks.
    pub(super) fn widen(&mut self, frame: &Frame, triangles: &[Triangle], spoiled: Spoiled) {
        let around = |block: &[u32]| {
            let boxes = block.iter().map(|&number| Item::new(number, &triangles[number as usize]).bounds());
            boxes.fold(Span::EMPTY, Span::join)
        };
        if !self.is_wide(|block| around(self.block(block))) {
            return;
        }
        let blocks: Vec<Span> = self.par_blocks().map(around).collect();
        let mut nodes = vec![Span::EMPTY; self.nodes.len()];
        self.lattices = vec![Lattice::root(frame); self.nodes.len()];
        for at in (0..self.nodes.len()).rev() {
            let children = [0, 1, 2, 3, 4, 5, 6, 7].map(|slot| self.nodes[at].child(slot).1);
            let bounds = children.map(|child| match child {
                Child::Block(block) => Some(blocks[block as usize]),
                // Its number is larger, so its box is final.
                Child::Node(child) => Some(nodes[child as usize]),
                Child::Vacant => None,
            });
            nodes[at] = bounds.into_iter().flatten().fold(Span::EMPTY, Span::join);
            if at > 0 {
                let [lower, upper] = nodes[at].corners();
                self.lattices[at] = Lattice::around(lower, upper);
            }
            for (slot, bounds) in bounds.into_iter().enumerate() {
                let Some(bounds) = bounds else { continue };
                let boxed = steps(&self.lattices[at], bounds);
                // The decoder compares those of nodes.
                let is_block = matches!(children[slot], Child::Block(_));
                let boxed = if is_block { spoiled.shrunk(boxed) } else { boxed };
                self.nodes[at].put(slot, boxed, children[slot]);
            }
        }
    }

    /// Whether many blocks have boxes that the root's steps make far larger than what is around them, by a sample.
    fn is_wide(&self, around: impl Fn(u32) -> Span) -> bool {
        let children = self.nodes.iter().flat_map(|node| (0..BVH_WIDTH).map(|slot| node.child(slot)));
        let stride = 1 + self.block_count() as u32 / SAMPLE;
        let (mut inflated, mut count) = (0, 0);
        for (boxed, child) in children {
            let Child::Block(block) = child else { continue };
            if block % stride == 0 {
                let [lower, upper] = boxed.dilated(BOX_MARGIN);
                let [x, y, z] = [0, 1, 2].map(|k| upper[k] - lower[k]);
                inflated += u32::from(x * y + y * z + z * x > MOST_INFLATION * around(block).area());
                count += 1;
            }
        }
        inflated as f32 > WIDE_SHARE * count as f32
    }
}

/// The steps of a lattice that a box touches.
fn steps(lattice: &Lattice, bounds: Span) -> LatticeBox {
    let [lower, upper] = bounds.corners();
    let steps = |corner: [f32; 3]| [0, 1, 2].map(|k| lattice.step_of(k, corner[k]));
    LatticeBox { lower: steps(lower), upper: steps(upper) }
}
