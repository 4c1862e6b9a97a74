//! `Flat`: an octree of eight bytes a node, for walks that go up and down.

use core::ops::Range;

use super::tree::{NONE, Tree};

/// Nodes in blocks of eight siblings behind the root, depth first, and what leaves list in the same order.
#[derive(Clone, Debug)]
pub(super) struct Flat {
    pub(super) nodes: Vec<Slot>,
    pub(super) listed: Vec<u32>,
}

/// A node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    /// The first of eight children, by octant, or of the triangles listed.
    pub(super) first: u32,
    /// How many triangles are listed, or [`NONE`] where there are children.
    len: u32,
}

impl Slot {
    pub(super) fn is_leaf(&self) -> bool {
        self.len != NONE
    }

    /// The triangles of a leaf.
    pub(super) fn triangles(&self) -> Range<usize> {
        self.first as usize..self.first as usize + self.len as usize
    }
}

impl Flat {
    pub(super) fn new(tree: &Tree<'_>) -> Self {
        let mut flat = Self { nodes: vec![Slot { first: 0, len: NONE }], listed: Vec::new() };
        let mut pending = vec![(0, 0)];
        while let Some((at, slot)) = pending.pop() {
            let node = &tree.nodes[at as usize];
            if node.is_leaf() {
                flat.nodes[slot] = Slot { first: flat.listed.len() as u32, len: node.triangles.len() as u32 };
                flat.listed.extend(&node.triangles);
            } else {
                let first = flat.nodes.len();
                flat.nodes[slot] = Slot { first: first as u32, len: NONE };
                flat.nodes.extend([Slot { first: 0, len: NONE }; 8]);
                pending.extend((0..8).rev().map(|octant| (node.children + octant, first + octant as usize)));
            }
        }
        flat
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.listed[..])
    }
}
