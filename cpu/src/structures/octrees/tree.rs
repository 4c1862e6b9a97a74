//! `Tree`: an octree as it grows, from which each structure is laid out.

use core::cmp::Reverse;

use rayon::prelude::*;

use super::cells::{Cell, Cells};
use super::limits::Limits;
use crate::structures::Scene;

/// No node.
pub(super) const NONE: u32 = u32::MAX;

/// Which triangles a leaf lists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lists {
    /// Those that its cell meets.
    #[default]
    Triangles,
    /// Those whose boxes its cell meets: more, and sooner found.
    Boxes,
}

/// A node: with children, or with triangles.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub(super) cell: Cell,
    /// The first of eight, by octant, or [`NONE`].
    pub(super) children: u32,
    pub(super) triangles: Vec<u32>,
}

impl Node {
    pub(super) fn is_leaf(&self) -> bool {
        self.children == NONE
    }
}

/// An octree. Cells are dilated by the margin before it is seen what they meet.
pub(super) struct Tree<'a> {
    scene: &'a Scene,
    lists: Lists,
    margin: f32,
    pub(super) cells: Cells,
    /// Parents before children.
    pub(super) nodes: Vec<Node>,
}

impl<'a> Tree<'a> {
    /// Cuts cells, level by level, where they list more than a leaf may.
    pub(super) fn grow(scene: &'a Scene, limits: &Limits, lists: Lists, margin: f32) -> Self {
        let cells = Cells::around(scene, margin, limits.levels());
        let root = Node { cell: cells.root(), children: NONE, triangles: (0..scene.len() as u32).collect() };
        let mut tree = Self { scene, lists, margin, cells, nodes: vec![root] };
        let (mut listed, most) = (scene.len(), limits.listed(scene.len()));
        let mut open = vec![0];
        while !open.is_empty() {
            open.retain(|&at| tree.may_be_cut(at) && tree.len(at) > limits.leaf as usize);
            open.sort_by_key(|&at| Reverse(tree.len(at)));
            let parts: Vec<_> = open.par_iter().map(|&at| tree.parts(at)).collect();
            let mut next = Vec::new();
            for (at, parts) in open.into_iter().zip(parts) {
                let after = listed - tree.len(at) + parts.iter().map(Vec::len).sum::<usize>();
                if after <= most {
                    listed = after;
                    next.extend(tree.cut(at, parts));
                }
            }
            open = next;
        }
        tree
    }

    /// Cuts leaves until none has a neighbour across a face that is smaller than half of it.
    pub(super) fn balance(&mut self) {
        let mut pending: Vec<u32> = (0..self.nodes.len() as u32).collect();
        while let Some(at) = pending.pop() {
            let Node { cell, children: NONE, .. } = self.nodes[at as usize] else { continue };
            let count = self.cells.count;
            for across in (0..6).filter_map(|face| cell.across(face, count)) {
                let holder = self.holder(across);
                if self.nodes[holder as usize].cell.size > 2 * cell.size {
                    let parts = self.parts(holder);
                    pending.extend(self.cut(holder, parts));
                    // One cut may not do.
                    pending.push(at);
                }
            }
        }
    }

    fn len(&self, at: u32) -> usize {
        self.nodes[at as usize].triangles.len()
    }

    fn may_be_cut(&self, at: u32) -> bool {
        self.nodes[at as usize].cell.size > 1
    }

    /// The triangles that each child of a leaf would list.
    fn parts(&self, at: u32) -> [Vec<u32>; 8] {
        let Node { cell, triangles, .. } = &self.nodes[at as usize];
        core::array::from_fn(|octant| {
            let bounds = self.cells.bounds(cell.child(octant as u32)).dilated(self.margin);
            let is_met = |triangle: u32| match self.lists {
                Lists::Triangles => self.scene.meets(triangle, &bounds),
                Lists::Boxes => !self.scene.bounds_of(triangle).meet(bounds).is_empty(),
            };
            triangles.iter().copied().filter(|triangle| is_met(*triangle)).collect()
        })
    }

    fn cut(&mut self, at: u32, parts: [Vec<u32>; 8]) -> core::ops::Range<u32> {
        let first = self.nodes.len() as u32;
        let node = &mut self.nodes[at as usize];
        let cell = node.cell;
        (node.children, node.triangles) = (first, Vec::new());
        let child = |(octant, triangles)| Node { cell: cell.child(octant), children: NONE, triangles };
        self.nodes.extend((0..).zip(parts).map(child));
        first..first + 8
    }

    /// The smallest node, no smaller than a cell, that holds it.
    fn holder(&self, cell: Cell) -> u32 {
        let (mut at, mut size) = (0, self.cells.count);
        while size > cell.size && !self.nodes[at as usize].is_leaf() {
            size /= 2;
            at = self.nodes[at as usize].children + Cell::octant_of(cell.corner, size);
        }
        at
    }

    /// The leaves, depth first.
    pub(super) fn leaves(&self) -> Vec<u32> {
        let (mut leaves, mut pending) = (Vec::new(), vec![0]);
        while let Some(at) = pending.pop() {
            match self.nodes[at as usize].children {
                NONE => leaves.push(at),
                children => pending.extend((children..children + 8).rev()),
            }
        }
        leaves
    }

    /// For each node and face the node of the same size across it, or the leaf that holds that place, or [`NONE`].
    pub(super) fn neighbours(&self) -> Vec<[u32; 6]> {
        let mut neighbours = vec![[NONE; 6]; self.nodes.len()];
        for (at, node) in self.nodes.iter().enumerate().filter(|(_, node)| !node.is_leaf()) {
            for (octant, face) in (0..48).map(|i| (i / 6, i % 6)) {
                let (axis, is_upper) = (face / 2, face % 2);
                let mirrored = octant ^ 1 << axis;
                let outside = neighbours[at][face as usize];
                neighbours[(node.children + octant) as usize][face as usize] = match self.nodes.get(outside as usize) {
                    _ if octant >> axis & 1 != is_upper => node.children + mirrored,
                    Some(outside) if !outside.is_leaf() => outside.children + mirrored,
                    _ => outside,
                };
            }
        }
        neighbours
    }
}
