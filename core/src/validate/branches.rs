//! The branches form one tree over the blocks: no descent loops, outgrows its stack, or looks for what is not there.

use super::wrong_length;
use crate::error::DecodeError;
use crate::layout::{BRANCH_WIDTH, BRANCH_WORDS, CORNER, Child, LatticeBox, MAX_DEPTH};
use crate::octree::Parts;
use crate::wire::Section;

/// A depth-first traversal must meet the branches in such an order that each takes the next numbers for those that it
/// leads to, by slot: so each but the first has exactly one parent.
///
/// As many blocks are led to as there are. That these are all of them, and their boxes large enough, takes memory to
/// prove, and is left to the verification.
pub(super) fn check(parts: &Parts<'_>) -> Result<(), DecodeError> {
    let mut census = Census { parts, taken: 1, led_to: 0 };
    let wrong = Err(wrong_length(Section::Branches, parts.branches.len(), BRANCH_WORDS));
    if parts.branches.is_empty() {
        return if parts.blocks.is_empty() { Ok(()) } else { wrong };
    }
    census.enter(0)?;
    // At each depth the branch, and the slot to look at next.
    let mut path = [(0u32, 0usize); MAX_DEPTH];
    let mut depth = 0;
    loop {
        let (number, slot) = path[depth];
        if slot == BRANCH_WIDTH {
            if depth == 0 {
                break;
            }
            depth -= 1;
            continue;
        }
        path[depth].1 += 1;
        if let (_, Child::Branch(child)) = parts.branches[number as usize].child(slot) {
            depth += 1;
            *path.get_mut(depth).ok_or(DecodeError::BadBranch { branch: number })? = (child, 0);
            census.enter(child)?;
        }
    }
    let is_complete = census.taken as usize == parts.branches.len() && census.led_to == parts.blocks.len();
    if is_complete { Ok(()) } else { wrong }
}

/// What branches have led to so far.
struct Census<'a> {
    parts: &'a Parts<'a>,
    taken: u32,
    led_to: usize,
}

impl Census<'_> {
    /// Checks all children of a branch that exists.
    fn enter(&mut self, number: u32) -> Result<(), DecodeError> {
        let branch = &self.parts.branches[number as usize];
        let is_right = (0..BRANCH_WIDTH).all(|slot| self.child(branch.child(slot)));
        if is_right && branch.children.iter().any(|word| Child::from_word(*word) != Child::Vacant) {
            Ok(())
        } else {
            Err(DecodeError::BadBranch { branch: number })
        }
    }

    fn child(&mut self, (boxed, child): (LatticeBox, Child)) -> bool {
        match child {
            Child::Vacant => boxed == CORNER,
            Child::Block(block) => {
                self.led_to += 1;
                (block as usize) < self.parts.blocks.len() && (0..3).all(|k| boxed.0[k] <= boxed.1[k])
            }
            Child::Branch(child) => {
                let is_next = child == self.taken;
                self.taken = self.taken.saturating_add(1);
                is_next && self.parts.branches.get(child as usize).is_some_and(|child| child.hull() == boxed)
            }
        }
    }
}
