//! The part of an octree that rays descend.

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

    /// Bytes of branches and blocks.
    pub(crate) fn size(&self) -> usize {
        size_of_val(self.branches) + size_of_val(self.blocks)
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
}

/// The word of the first branch as a child.
pub(crate) const ROOT: u32 = 0;
