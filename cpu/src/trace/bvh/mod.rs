//! `Bvh`: the part of a file that rays descend, with the tests of its nodes and blocks.

pub(crate) mod node;
pub(crate) mod stack;

use leafwalk_core::canonical::PreparedFrame;
use leafwalk_core::layout::{Block, BvhNode, Child, LatticeBox};
use leafwalk_core::{Indexed, Octree};

use crate::lanes::Eight;

/// The word of the root as a child.
pub(crate) const ROOT: u32 = 0;

/// The nodes of the BVH, and the blocks of triangles that they lead to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bvh<'a, B> {
    pub(crate) frame: PreparedFrame,
    pub(crate) nodes: &'a [BvhNode],
    pub(crate) blocks: B,
}

/// Blocks, packed or indexed: kernels are compiled for either, so that neither costs the other anything.
pub(crate) trait BlockSource: Copy + Sync {
    /// A block by its number, put together in `room` where the file does not hold it as it is tested; `None` beyond all
    /// blocks.
    fn block<'b>(&'b self, number: usize, room: &'b mut Option<Block>) -> Option<&'b Block>;
    /// Asks for the cache lines of a block that is visited soon.
    fn prefetch<L: Eight>(&self, number: usize);
}

impl BlockSource for &[Block] {
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

impl BlockSource for Indexed<'_> {
    #[inline(always)]
    fn block<'b>(&'b self, number: usize, room: &'b mut Option<Block>) -> Option<&'b Block> {
        self.assemble(number, room)
    }
    /// Which vertices a block names only the block itself knows, so they are not asked for.
    #[inline(always)]
    fn prefetch<L: Eight>(&self, number: usize) {
        if let Some(block) = self.blocks.get(number) {
            L::prefetch(block);
        }
    }
}

impl<'a, B: BlockSource> Bvh<'a, B> {
    #[inline]
    pub(crate) fn new<W: AsRef<[u32]>>(octree: &'a Octree<W>, frame: PreparedFrame, blocks: B) -> Self {
        Self { frame, nodes: octree.bvh(), blocks }
    }

    /// The box around all triangles.
    #[inline(always)]
    pub(crate) fn hull(&self) -> LatticeBox {
        self.nodes.first().map_or(LatticeBox::VACANT, BvhNode::hull)
    }

    /// A node by the word of a child; `None` where that leads to a block, whose word is beyond all nodes.
    #[inline(always)]
    pub(crate) fn node(&self, child: u32) -> Option<&'a BvhNode> {
        self.nodes.get(child as usize)
    }

    /// A block by the word of a child that leads to no node, put together in `room` where it must be; `None` for a vacant
    /// child, whose word is beyond all blocks.
    #[inline(always)]
    pub(crate) fn block<'b>(&'b self, child: u32, room: &'b mut Option<Block>) -> Option<&'b Block> {
        self.blocks.block((child & Child::NUMBERS) as usize, room)
    }

    /// Asks for the cache lines of a child that is visited soon.
    #[inline(always)]
    pub(crate) fn prefetch<L: Eight>(&self, child: u32) {
        match self.node(child) {
            Some(node) => L::prefetch(node),
            None => self.blocks.prefetch::<L>((child & Child::NUMBERS) as usize),
        }
    }
}
