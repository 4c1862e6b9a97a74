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

/// The branches that a ray has yet to come back to: at most one a level, deepest last.
#[derive(Clone, Debug)]
pub(crate) struct Trail {
    branches: [Branch; MAX_LEVEL as usize + 1],
    len: usize,
}

impl Trail {
    pub(crate) fn new() -> Self {
        Self { branches: [Branch::zeroed(); MAX_LEVEL as usize + 1], len: 0 }
    }

    /// Forgets everything.
    #[inline(always)]
    pub(crate) fn clear(&mut self) {
        self.len = 0;
    }

    /// The payload of the nearest of the children that a ray of octant `neg` meets, a mask that is not 0; the others wait.
    #[inline(always)]
    pub(crate) fn enter(&mut self, payload: &Payload, neg: u32, met: u32, first: [f32; 8]) -> u32 {
        let ahead = u32::from(FLIPPED[neg as usize & 7][met as usize & 0xff]);
        let (children_at, children) = (payload.first, u32::from(payload.children));
        let others = ahead & ahead.wrapping_sub(1);
        if others != 0 {
            self.branches[self.len] = Branch { first, children_at, children, ahead: others };
            self.len += 1;
        }
        child(children_at, children, (ahead.trailing_zeros() ^ neg) & 7)
    }

    /// The next payload that waits and is entered before `last`, or [`NONE`].
    #[inline(always)]
    pub(crate) fn back(&mut self, neg: u32, last: f32) -> u32 {
        while self.len > 0 {
            let branch = &mut self.branches[self.len - 1];
            let octant = (branch.ahead.trailing_zeros() ^ neg) & 7;
            branch.ahead &= branch.ahead - 1;
            self.len -= usize::from(branch.ahead == 0);
            if branch.first[octant as usize] <= last {
                return child(branch.children_at, branch.children, octant);
            }
        }
        NONE
    }
}

#[inline(always)]
fn child(children_at: u32, children: u32, octant: u32) -> u32 {
    children_at + (children & ((1 << octant) - 1)).count_ones()
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
