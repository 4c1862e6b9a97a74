//! `Branches`: the inner nodes of an octree whose leaves stand elsewhere.

use super::cells::Cell;
use super::course::Course;
use super::tree::Tree;

/// What is named is a leaf, by a number of the structure's own; without it, a branch.
const LEAF: u32 = 1 << 31;

/// What nodes of a [`Tree`] are called: leaves by numbers of the structure's own, the others by their places among the
/// branches.
pub(super) struct Names(Vec<u32>);

impl Names {
    /// Leaves are numbered below 2^31.
    pub(super) fn new(tree: &Tree<'_>, leaves: impl Iterator<Item = (u32, u32)>) -> Self {
        let mut names = vec![0; tree.nodes.len()];
        for (leaf, number) in leaves {
            names[leaf as usize] = number | LEAF;
        }
        let inner = tree.nodes.iter().zip(&mut names).filter(|(node, _)| !node.is_leaf());
        for (number, (_, name)) in (0..).zip(inner) {
            *name = number;
        }
        Self(names)
    }

    /// The name of a node.
    pub(super) fn of(&self, node: u32) -> u32 {
        self.0[node as usize]
    }
}

/// The inner nodes: the names of the children of each, by octant.
#[derive(Clone, Debug)]
pub(super) struct Branches {
    root: u32,
    children: Vec<[u32; 8]>,
}

impl Branches {
    pub(super) fn new(tree: &Tree<'_>, names: &Names) -> Self {
        let inner = tree.nodes.iter().filter(|node| !node.is_leaf());
        let children = inner.map(|node| core::array::from_fn(|octant| names.of(node.children + octant as u32)));
        Self { root: names.of(0), children: children.collect() }
    }

    /// Goes down from the root, whose cell is given, to the leaf in which the line is at some t: its number.
    pub(super) fn locate(&self, cell: &mut Cell, course: &Course, t: f32) -> u32 {
        self.descend(self.root, cell, course, t)
    }

    /// Likewise, from a node of some name.
    #[inline]
    pub(super) fn descend(&self, mut name: u32, cell: &mut Cell, course: &Course, t: f32) -> u32 {
        while name & LEAF == 0 {
            name = self.children[name as usize][course.enter(cell, t) as usize];
        }
        name & !LEAF
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.children[..])
    }
}
