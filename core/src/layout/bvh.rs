//! `BvhNode`: one node of the bounding volume hierarchy over all triangles, or what a leaf of the octree lists.

use super::{LatticeBox, NONE};
use crate::unroll;

/// Children of a node.
pub const BVH_WIDTH: usize = 8;
/// Words of a node.
pub const BVH_NODE_WORDS: usize = 32;
/// Nodes on the way from the root to a block, both ends included, at most: it bounds what a descent must remember.
///
/// Nine levels of eight hold all blocks that a file may have; the others are room for scenes that ask for uneven trees.
pub const MAX_DEPTH: usize = 24;

/// Where a child of a node leads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Child {
    /// To a node, by its number.
    Node(u32),
    /// To a block of triangles, by its number.
    Block(u32),
    /// Nowhere: the slot is not in use.
    Vacant,
}

impl Child {
    /// The bit that is set in the words of blocks.
    const BLOCK: u32 = 1 << 31;
    /// Numbers that fit beside that bit.
    pub const NUMBERS: u32 = Self::BLOCK - 1;

    /// Its word in a node. Numbers are below [`Child::NUMBERS`].
    #[inline]
    pub fn to_word(self) -> u32 {
        match self {
            Self::Node(number) => number,
            Self::Block(number) => number | Self::BLOCK,
            Self::Vacant => NONE,
        }
    }

    /// Reads what [`Child::to_word`] wrote.
    #[inline(always)]
    pub fn from_word(word: u32) -> Self {
        match word {
            NONE => Self::Vacant,
            _ if word & Self::BLOCK != 0 => Self::Block(word & Self::NUMBERS),
            _ => Self::Node(word),
        }
    }
}

/// A node of the bounding volume hierarchy over all triangles: up to eight boxes with what they hold, 128 bytes.
///
/// Rays descend the hierarchy from its root, alone or many together, or from what a leaf of the octree lists. Children stand in
/// slots by octant, such that a ray of octant `neg` meets those of low slot XOR `neg` first, as far as there is such an
/// order (H. Ylitie, T. Karras and S. Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs",
/// HPG 2017, <https://research.nvidia.com/publication/2017-07_efficient-incoherent-ray-traversal-gpus-through-compressed-wide-bvhs>).
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct BvhNode {
    /// Lower and upper sides of the children's boxes, axis by axis.
    pub sides: [[[u16; BVH_WIDTH]; 2]; 3],
    /// Where each child leads: see [`Child`].
    pub children: [u32; BVH_WIDTH],
}

impl BvhNode {
    /// A node whose slots are all vacant.
    pub const VACANT: Self = Self { sides: [[[u16::MAX; BVH_WIDTH]; 2]; 3], children: [NONE; BVH_WIDTH] };

    /// The child in a slot, and its box.
    #[inline]
    pub fn child(&self, slot: usize) -> (LatticeBox, Child) {
        let lower = self.sides.map(|[lower, _]| lower[slot]);
        let upper = self.sides.map(|[_, upper]| upper[slot]);
        (LatticeBox { lower, upper }, Child::from_word(self.children[slot]))
    }

    /// Puts a child in a slot.
    pub fn put(&mut self, slot: usize, boxed: LatticeBox, child: Child) {
        for k in 0..3 {
            (self.sides[k][0][slot], self.sides[k][1][slot]) = (boxed.lower[k], boxed.upper[k]);
        }
        self.children[slot] = child.to_word();
    }

    /// How many slots are in use.
    pub fn count(&self) -> u32 {
        self.children.iter().map(|word| u32::from(*word != NONE)).sum()
    }

    /// The box around all children.
    pub fn hull(&self) -> LatticeBox {
        let children = (0..BVH_WIDTH).map(|slot| self.child(slot));
        LatticeBox::around(children.filter(|(_, child)| *child != Child::Vacant).map(|(boxed, _)| boxed))
    }

    /// Per axis, the sides of all boxes that a ray of octant `neg` meets first, or last with `neg` inverted.
    #[inline(always)]
    pub fn near_sides(&self, neg: u32) -> [&[u16; BVH_WIDTH]; 3] {
        unroll!(k in 0..3 => &self.sides[k][(neg >> k & 1) as usize])
    }
}
