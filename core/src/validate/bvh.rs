//! The nodes form one tree over the blocks: no descent loops, outgrows its stack, or looks for what is not there.

use super::wrong_length;
use crate::blocks::{Blocks, Indexed};
use crate::error::DecodeError;
use crate::layout::{
    BLOCK_WORDS, BVH_NODE_WORDS, BVH_WIDTH, BvhNode, Child, INDEXED_BLOCK_WORDS, Lattice, LatticeBox, MAX_DEPTH,
    Section,
};
use crate::parts::Parts;

/// A depth-first traversal must meet the nodes in such an order that each takes the next numbers for the nodes and blocks that
/// it leads to, by slot: so each but the first node, and each block, has exactly one parent.
///
/// That the boxes of blocks are large enough is left to the verification.
pub(super) fn check(parts: &Parts<'_>) -> Result<(), DecodeError> {
    let mut census = Census { parts, taken: 1, led_to: 0 };
    let wrong = Err(wrong_length(Section::Bvh, parts.bvh.len(), BVH_NODE_WORDS));
    if parts.bvh.is_empty() {
        return if parts.blocks.is_empty() { Ok(()) } else { wrong };
    }
    lattices(parts)?;
    census.enter(0)?;
    // At each depth the node, and the slot to look at next.
    let mut path = [(0u32, 0usize); MAX_DEPTH];
    let mut depth = 0;
    loop {
        let (number, slot) = path[depth];
        if slot == BVH_WIDTH {
            if depth == 0 {
                break;
            }
            depth -= 1;
            continue;
        }
        path[depth].1 += 1;
        if let (_, Child::Node(child)) = parts.bvh[number as usize].child(slot) {
            depth += 1;
            *path.get_mut(depth).ok_or(DecodeError::BadBvhNode { node: number })? = (child, 0);
            census.enter(child)?;
        }
    }
    if census.taken as usize != parts.bvh.len() {
        return wrong;
    }
    if census.led_to == parts.blocks.len() {
        return Ok(());
    }
    Err(match parts.blocks {
        Blocks::Packed(blocks) => wrong_length(Section::Blocks, blocks.len(), BLOCK_WORDS),
        Blocks::Indexed(Indexed { blocks, .. }) => {
            wrong_length(Section::IndexedBlocks, blocks.len(), INDEXED_BLOCK_WORDS)
        }
    })
}

/// Checks the lattices of a wide octree: the root's is that of the root, so that no box reaches out of it.
fn lattices(parts: &Parts<'_>) -> Result<(), DecodeError> {
    let is_wrong = |(node, lattice): &(u32, &Lattice)| match node {
        0 => **lattice != Lattice::root(&parts.frame),
        _ => !lattice.is_sound(),
    };
    match (0..).zip(parts.lattices).find(is_wrong) {
        Some((node, _)) => Err(DecodeError::BadLattice { node }),
        None => Ok(()),
    }
}

/// What nodes have led to so far.
struct Census<'a> {
    parts: &'a Parts<'a>,
    taken: u32,
    led_to: usize,
}

impl Census<'_> {
    /// Checks all children of a node that exists.
    fn enter(&mut self, number: u32) -> Result<(), DecodeError> {
        let node = &self.parts.bvh[number as usize];
        let is_right = (0..BVH_WIDTH).all(|slot| self.child(number, node.child(slot)));
        if is_right && node.children.iter().any(|word| Child::from_word(*word) != Child::Vacant) {
            Ok(())
        } else {
            Err(DecodeError::BadBvhNode { node: number })
        }
    }

    fn child(&mut self, parent: u32, (boxed, child): (LatticeBox, Child)) -> bool {
        match child {
            Child::Vacant => boxed == LatticeBox::VACANT,
            Child::Block(block) => {
                let is_next = block as usize == self.led_to && self.led_to < self.parts.blocks.len();
                self.led_to += 1;
                is_next && boxed.is_whole()
            }
            Child::Node(child) => {
                let is_next = child == self.taken;
                self.taken = self.taken.saturating_add(1);
                is_next && self.is_hull(parent, boxed, child)
            }
        }
    }

    /// Whether the box of a child that is a node is that of its own children; in a wide octree, where the two count different
    /// steps, whether it holds them.
    fn is_hull(&self, parent: u32, boxed: LatticeBox, child: u32) -> bool {
        let Parts { bvh, lattices, .. } = self.parts;
        let Some(hull) = bvh.get(child as usize).map(BvhNode::hull) else { return false };
        match lattices.get(child as usize) {
            Some(own) => boxed.is_whole() && self.parts.lattice(parent).holds(boxed, own, hull),
            None => hull == boxed,
        }
    }
}
