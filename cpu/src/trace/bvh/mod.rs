//! `Bvh`: the part of a file that rays descend, with the tests of its nodes and blocks.

pub(crate) mod node;
pub(crate) mod stack;

use leafwalk_core::canonical::PreparedFrame;
use leafwalk_core::layout::{Block, BvhNode, Child, Lattice, LatticeBox};
use leafwalk_core::slabs::Slabs;
use leafwalk_core::{Blocks, Indexed, Octree, unroll};

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

/// Blocks, packed or indexed, below boxes that count the root's steps or those of lattices: kernels are compiled for each, so
/// that none costs the others anything.
pub(crate) trait BlockSource: Copy + Sync {
    /// Whether the boxes of each node count steps of a lattice of its own.
    const IS_WIDE: bool = false;
    /// A block by its number, put together in `room` where the file does not hold it as it is tested; `None` beyond all
    /// blocks.
    fn block<'b>(&'b self, number: usize, room: &'b mut Option<Block>) -> Option<&'b Block>;
    /// Asks for the cache lines of a block that is visited soon.
    fn prefetch<L: Eight>(&self, number: usize);
    /// What the boxes of a node are tested with, given what those that count the root's steps are, and where t' is 0 in
    /// lattice coordinates.
    #[inline(always)]
    fn slabs<L: Eight>(&self, node: u32, slabs: &Slabs<L>, origin: [f32; 3]) -> Slabs<L> {
        self.slabs_of(node, slabs, unroll!(k in 0..3 => L::splat(origin[k])))
    }
    /// [`BlockSource::slabs`] of eight rays.
    #[inline(always)]
    fn slabs_of<L: Eight>(&self, _node: u32, slabs: &Slabs<L>, _origin: [L; 3]) -> Slabs<L> {
        *slabs
    }
    /// The lattice of a node of a wide octree.
    #[inline(always)]
    fn lattice(&self, _node: u32) -> Option<&Lattice> {
        None
    }
    /// Asks for what [`BlockSource::slabs`] reads of a node that is visited soon.
    #[inline(always)]
    fn prefetch_slabs<L: Eight>(&self, _node: u32) {}
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

/// Blocks of a wide octree. Such octrees are few, so the two kinds of blocks share kernels here, which would take a third
/// longer to compile.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wide<'a> {
    pub(crate) blocks: Blocks<'a>,
    /// One a node.
    pub(crate) lattices: &'a [Lattice],
}

impl BlockSource for Wide<'_> {
    const IS_WIDE: bool = true;
    #[inline(always)]
    fn block<'b>(&'b self, number: usize, room: &'b mut Option<Block>) -> Option<&'b Block> {
        match &self.blocks {
            Blocks::Packed(blocks) => blocks.block(number, room),
            Blocks::Indexed(blocks) => blocks.block(number, room),
        }
    }
    #[inline(always)]
    fn prefetch<L: Eight>(&self, number: usize) {
        match &self.blocks {
            Blocks::Packed(blocks) => blocks.prefetch::<L>(number),
            Blocks::Indexed(blocks) => blocks.prefetch::<L>(number),
        }
    }
    #[inline(always)]
    fn slabs_of<L: Eight>(&self, node: u32, slabs: &Slabs<L>, origin: [L; 3]) -> Slabs<L> {
        let Some(lattice) = self.lattices.get(node as usize) else { return *slabs };
        Slabs::in_lattice(lattice, origin, slabs.inverse)
    }
    #[inline(always)]
    fn lattice(&self, node: u32) -> Option<&Lattice> {
        self.lattices.get(node as usize)
    }
    #[inline(always)]
    fn prefetch_slabs<L: Eight>(&self, node: u32) {
        if let Some(lattice) = self.lattices.get(node as usize) {
            L::prefetch(lattice);
        }
    }
}

/// Calls with the blocks of an octree, of whichever kind they are.
macro_rules! with_blocks {
    ($octree:expr, $blocks:ident => $call:expr) => {
        match ($octree.blocks(), $octree.lattices()) {
            (leafwalk_core::Blocks::Packed($blocks), []) => $call,
            (leafwalk_core::Blocks::Indexed($blocks), []) => $call,
            (blocks, lattices) => {
                let $blocks = $crate::trace::bvh::Wide { blocks, lattices };
                $call
            }
        }
    };
}
pub(crate) use with_blocks;

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
            Some(node) => {
                L::prefetch(node);
                self.blocks.prefetch_slabs::<L>(child);
            }
            None => self.blocks.prefetch::<L>((child & Child::NUMBERS) as usize),
        }
    }
}
