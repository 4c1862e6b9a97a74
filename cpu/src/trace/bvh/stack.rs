//! `Stack`: the children that wait while rays descend the BVH, the nearest on top.

use leafwalk_core::layout::{BVH_WIDTH, BvhNode, MAX_DEPTH, NONE};

use crate::lanes::Eight;

/// Entries of a stack: its end, for each node on the way to the deepest one all children but one, for that one all, and
/// eight more, since all slots of a node are written at once.
const ROOM: usize = 1 + MAX_DEPTH * BVH_WIDTH + BVH_WIDTH;

/// Stands at the bottom of a stack: the word of a block beyond all blocks, and not that of a vacant child.
pub(crate) const END: u32 = NONE - 1;

/// Children that wait, by their words, with t' where each is entered.
#[derive(Clone, Debug)]
pub(crate) struct Stack {
    children: [u32; ROOM],
    first: [f32; ROOM],
    len: usize,
}

impl Stack {
    pub(crate) const fn new() -> Self {
        // The end is entered before everything, so that it is always taken, and no look is needed for how much is left.
        let (mut children, mut first) = ([0; ROOM], [0.0; ROOM]);
        (children[0], first[0]) = (END, f32::NEG_INFINITY);
        Self { children, first, len: 1 }
    }

    /// Drops all children that wait, so that only the end is left.
    #[inline(always)]
    pub(crate) fn clear(&mut self) {
        self.len = 1;
    }

    /// Lets the children wait whose lanes are in `met`, a mask; there may be none.
    #[inline(always)]
    pub(crate) fn push<L: Eight>(&mut self, node: &BvhNode, neg: u32, first: L, met: u32) {
        self.put(node, neg, first, in_order::<L>(neg, met));
    }

    /// The nearest of the children whose lanes are in `met`, a mask that is not 0; the others wait.
    #[inline(always)]
    pub(crate) fn enter<L: Eight>(&mut self, node: &BvhNode, neg: u32, first: L, met: u32) -> u32 {
        self.enter_in_order(node, neg, first, in_order::<L>(neg, met))
    }

    /// [`Stack::enter`], given places in the ray's order instead of lanes.
    #[inline(always)]
    pub(crate) fn enter_in_order<L: Eight>(&mut self, node: &BvhNode, neg: u32, first: L, met: u32) -> u32 {
        let nearest = (met.trailing_zeros() ^ neg) & 7;
        // This runs even where there are no others: whether there are cannot be predicted.
        self.put(node, neg, first, met & met.wrapping_sub(1));
        node.children[nearest as usize]
    }

    /// Adds children by their places in the ray's order: all eight lanes are written, those that count first.
    #[inline(always)]
    fn put<L: Eight>(&mut self, node: &BvhNode, neg: u32, first: L, in_order: u32) {
        let lanes = &FARTHEST_FIRST[in_order as usize & 0xff];
        let room = self.len..self.len + BVH_WIDTH;
        let children = L::load(bytemuck::cast_ref(&node.children)).permute_lanes(lanes, neg).to_array();
        self.children[room.clone()].copy_from_slice(bytemuck::cast_ref::<_, [u32; BVH_WIDTH]>(&children));
        self.first[room].copy_from_slice(&first.permute_lanes(lanes, if L::IS_BY_SLOT { neg } else { 0 }).to_array());
        self.len += in_order.count_ones() as usize;
    }

    /// The next child that is entered before `last`; after all others, once, [`END`].
    #[inline(always)]
    pub(crate) fn pop(&mut self, last: f32) -> u32 {
        let mut at = self.len - 1;
        while self.first[at] > last {
            at -= 1;
        }
        self.len = at;
        self.children[at]
    }
}

/// A stack whose children remember which rays of a tile meet them.
#[derive(Clone, Debug)]
pub(crate) struct TileStack {
    pub(crate) stack: Stack,
    /// A bit a ray, for each child; it means something once [`TileStack::set_all_rays`] was called.
    rays: [u64; ROOM],
}

impl TileStack {
    pub(crate) const fn new() -> Self {
        Self { stack: Stack::new(), rays: [0; ROOM] }
    }

    /// Sets which rays meet each of the children that wait.
    #[inline(always)]
    pub(crate) fn set_all_rays(&mut self, rays: u64) {
        self.rays[..self.stack.len].fill(rays);
    }

    /// Sets which rays meet the children that are entered next: those of `met`, by their places in the rays' order.
    #[inline(always)]
    pub(crate) fn set_rays(&mut self, met: u32, rays: &[u64; BVH_WIDTH]) {
        let places = &FARTHEST_FIRST[met as usize & 0xff];
        // All eight are written: whether there are others than the first cannot be predicted.
        for (waiting, place) in self.rays[self.stack.len..self.stack.len + BVH_WIDTH].iter_mut().zip(places) {
            *waiting = rays[*place as usize & 7];
        }
    }

    /// The rays that meet the child that was popped last.
    #[inline(always)]
    pub(crate) fn rays(&self) -> u64 {
        self.rays[self.stack.len]
    }
}

/// A mask of lanes as a mask of places in the ray's order: low bits are near.
#[inline(always)]
pub(crate) fn in_order<L: Eight>(neg: u32, met: u32) -> u32 {
    if !L::IS_BY_SLOT {
        return met;
    }
    u32::from(FLIPPED[neg as usize & 7][met as usize & 0xff])
}

/// Row n, column m: the slots in m, each XOR n.
const FLIPPED: [[u8; 256]; 8] = {
    let mut table = [[0; 256]; 8];
    let mut at = 0;
    while at < 8 * 256 * 8 {
        let (neg, mask, slot) = (at >> 11, at >> 3 & 0xff, at & 7);
        if mask >> slot & 1 == 1 {
            table[neg][mask] |= 1 << (slot ^ neg);
        }
        at += 1;
    }
    table
};

/// Row m: the bits of m from the highest down, then zeros.
pub(crate) const FARTHEST_FIRST: [[u8; BVH_WIDTH]; 256] = {
    let mut table = [[0; BVH_WIDTH]; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut left, mut at) = (mask as u32, 0);
        while left != 0 {
            let highest = left.ilog2();
            table[mask][at] = highest as u8;
            left ^= 1 << highest;
            at += 1;
        }
        mask += 1;
    }
    table
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::Portable;

    fn waiting(stack: &mut Stack, last: f32) -> impl Iterator<Item = u32> {
        core::iter::from_fn(move || Some(stack.pop(last)).filter(|child| *child != END))
    }

    #[test]
    fn the_nearest_slots_come_first() {
        let node = BvhNode { children: core::array::from_fn(|slot| 100 + slot as u32), ..BvhNode::VACANT };
        let first: [f32; 8] = core::array::from_fn(|slot| slot as f32);
        for (neg, met) in (0..8).flat_map(|neg| (1..256u32).map(move |met| (neg, met))) {
            let expected: Vec<u32> = (0..8).map(|at| at ^ neg).filter(|slot| met >> slot & 1 == 1).collect();
            let mut stack = Stack::new();
            stack.push(&node, neg, Portable::load(&first), met);
            let popped: Vec<u32> = waiting(&mut stack, 7.0).map(|child| child - 100).collect();
            assert_eq!(popped, expected);

            stack.clear();
            let entered = stack.enter(&node, neg, Portable::load(&first), met);
            let mut found = vec![entered - 100];
            found.extend(waiting(&mut stack, 3.5).map(|child| child - 100));
            let (nearest, others) = expected.split_first().expect("a mask that is not 0");
            assert!(found.iter().eq([nearest].into_iter().chain(others.iter().filter(|slot| **slot <= 3))));
        }
    }
}
