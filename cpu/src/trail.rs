//! What is left of the tree while a ray descends.

use bytemuck::Zeroable;
use leafwalk_core::layout::{MAX_LEVEL, NONE, Payload};

/// An inner node with children that wait.
#[derive(Clone, Copy, Debug, Zeroable)]
struct Branch {
    /// t' where the ray enters each child.
    first: [f32; 8],
    /// Payload of the first child.
    children_at: u32,
    /// The octants that have payloads.
    children: u32,
    /// The octants that wait, each XOR the ray's: lower bits are nearer.
    ahead: u32,
}

impl Branch {
    #[inline(always)]
    fn new(payload: &Payload, neg: u32, met: u32, first: [f32; 8]) -> Self {
        let ahead = u32::from(FLIPPED[neg as usize & 7][met as usize & 0xff]);
        Self { first, children_at: payload.first, children: u32::from(payload.children), ahead }
    }

    /// The nearest octant ahead, which is none after that.
    #[inline(always)]
    fn take(&mut self, neg: u32) -> u32 {
        let octant = (self.ahead.trailing_zeros() ^ neg) & 7;
        self.ahead &= self.ahead.wrapping_sub(1);
        octant
    }

    /// The payload of a child.
    #[inline(always)]
    fn child(&self, octant: u32) -> u32 {
        self.children_at + (self.children & ((1 << octant) - 1)).count_ones()
    }
}

/// The branches that a ray has yet to come back to: at most one a level, deepest last.
#[derive(Clone, Debug)]
pub(crate) struct Trail {
    branches: [Branch; MAX_LEVEL as usize + 2],
    len: usize,
}

impl Trail {
    pub(crate) fn new() -> Self {
        Self { branches: [Branch::zeroed(); MAX_LEVEL as usize + 2], len: 0 }
    }

    /// Forgets everything.
    #[inline(always)]
    pub(crate) fn clear(&mut self) {
        self.len = 0;
    }

    /// Lets the children wait that a ray of octant `neg` meets, a mask of octants; there may be none.
    #[inline(always)]
    pub(crate) fn wait(&mut self, payload: &Payload, neg: u32, met: u32, first: [f32; 8]) {
        let branch = Branch::new(payload, neg, met, first);
        // Written whether it counts or not: no branch to mispredict.
        self.branches[self.len] = branch;
        self.len += usize::from(branch.ahead != 0);
    }

    /// The payload of the nearest of the children that a ray meets, a mask that is not 0; the others wait.
    #[inline(always)]
    pub(crate) fn enter(&mut self, payload: &Payload, neg: u32, met: u32, first: [f32; 8]) -> u32 {
        let mut branch = Branch::new(payload, neg, met, first);
        let nearest = branch.take(neg);
        if branch.ahead != 0 {
            self.branches[self.len] = branch;
            self.len += 1;
        }
        branch.child(nearest)
    }

    /// The next payload that waits and is entered before `last`, or [`NONE`].
    #[inline(always)]
    pub(crate) fn back(&mut self, neg: u32, last: f32) -> u32 {
        while self.len > 0 {
            let branch = &mut self.branches[self.len - 1];
            let octant = branch.take(neg);
            self.len -= usize::from(branch.ahead == 0);
            if branch.first[octant as usize & 7] <= last {
                return branch.child(octant);
            }
        }
        NONE
    }
}

/// Row n, column m: the octants in m, each XOR n.
const FLIPPED: [[u8; 256]; 8] = {
    let mut table = [[0; 256]; 8];
    let mut at = 0;
    while at < 8 * 256 * 8 {
        let (neg, mask, octant) = (at >> 11, at >> 3 & 0xff, at & 7);
        if mask >> octant & 1 == 1 {
            table[neg][mask] |= 1 << (octant ^ neg);
        }
        at += 1;
    }
    table
};
