//! The part of an octree that rays descend.

use leafwalk_core::layout::{Block, Branch, CORNER, Child, LatticeBox};
use leafwalk_core::{Frame, Indexed, Octree};

use crate::lanes::Eight;

/// Branches, and the triangles that they lead to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hierarchy<'a, B> {
    pub(crate) frame: Frame,
    pub(crate) branches: &'a [Branch],
    pub(crate) blocks: B,
}

/// Blocks, packed or indexed: kernels are compiled for either, so that neither costs the other anything.
pub(crate) trait Source: Copy + Sync {
    /// A block by its number, made in `room` where it must be; `None` beyond all blocks.
    fn block<'b>(&'b self, number: usize, room: &'b mut Option<Block>) -> Option<&'b Block>;
    /// Asks for the cache lines of a block that is visited soon.
    fn prefetch<L: Eight>(&self, number: usize);
}

impl Source for &[Block] {
    #[inline(always)]
    fn block<'b>(&'b self, number: usize, _: &'b mut Option<Block>) -> Option<&'b Block> {
        self.get(number)
    }
    #[inline(always)]
    fn prefetch<L: Eight>(&self, number: usize) {
        if let Some(block) = self.get(number) {
            L::prefetch(block);
        }
    }
}

impl Source for Indexed<'_> {
    #[inline(always)]
    fn block<'b>(&'b self, number: usize, room: &'b mut Option<Block>) -> Option<&'b Block> {
        self.assemble(number, room)
    }
    /// Which vertices it names, only the block itself knows.
    #[inline(always)]
    fn prefetch<L: Eight>(&self, number: usize) {
        if let Some(block) = self.blocks.get(number) {
            L::prefetch(block);
        }
    }
}

impl<'a, B: Source> Hierarchy<'a, B> {
    #[inline]
    pub(crate) fn new<W: AsRef<[u32]>>(octree: &'a Octree<W>, frame: Frame, blocks: B) -> Self {
        Self { frame, branches: octree.branches(), blocks }
    }

    /// The box around all triangles.
    #[inline(always)]
    pub(crate) fn hull(&self) -> LatticeBox {
        self.branches.first().map_or(CORNER, Branch::hull)
    }

    /// A branch by the word of a child. A block's is beyond all branches.
    #[inline(always)]
    pub(crate) fn branch(&self, child: u32) -> Option<&'a Branch> {
        self.branches.get(child as usize)
    }

    /// A block by the word of a child that is no branch, assembled in `room` where it must be. That of a vacant child is
    /// beyond all blocks.
    #[inline(always)]
    pub(crate) fn block<'b>(&'b self, child: u32, room: &'b mut Option<Block>) -> Option<&'b Block> {
        self.blocks.block((child & Child::NUMBERS) as usize, room)
    }

    /// Asks for the cache lines of a child that is visited soon.
    #[inline(always)]
    pub(crate) fn prefetch<L: Eight>(&self, child: u32) {
        match self.branch(child) {
            Some(branch) => L::prefetch(branch),
            None => self.blocks.prefetch::<L>((child & Child::NUMBERS) as usize),
        }
    }
}

/// The word of the first branch as a child.
pub(crate) const ROOT: u32 = 0;
