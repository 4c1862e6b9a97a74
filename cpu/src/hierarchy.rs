//! The part of an octree that rays descend.

use crate::lanes::Eight;
use leafwalk_core::layout::{Block, Branch, Child};
use leafwalk_core::{Frame, Octree};

/// Branches, and the triangles that they lead to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hierarchy<'a> {
    pub(crate) frame: Frame,
    pub(crate) branches: &'a [Branch],
    pub(crate) blocks: &'a [Block],
}

impl<'a> Hierarchy<'a> {
    #[inline]
    pub(crate) fn of<W: AsRef<[u32]>>(octree: &'a Octree<W>) -> Self {
        Self { frame: octree.frame(), branches: octree.branches(), blocks: octree.blocks() }
    }

    /// A branch by the word of a child. A block's is beyond all branches.
    #[inline(always)]
    pub(crate) fn branch(&self, child: u32) -> Option<&'a Branch> {
        self.branches.get(child as usize)
    }

    /// A block by the word of a child that is no branch. That of a vacant child is beyond all blocks.
    #[inline(always)]
    pub(crate) fn block(&self, child: u32) -> Option<&'a Block> {
        self.blocks.get((child & Child::NUMBERS) as usize)
    }

    /// Asks for a branch or block that is visited soon.
    #[inline(always)]
    pub(crate) fn prefetch<L: Eight>(&self, child: u32) {
        if let Some(branch) = self.branch(child) {
            L::prefetch(branch);
        } else if let Some(block) = self.block(child) {
            L::prefetch(block);
        }
    }
}

/// The word of the first branch as a child.
pub(crate) const ROOT: u32 = 0;
