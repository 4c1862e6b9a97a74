//! `Unconstrained`: a walk over links between leaves of any size.
//!
//! The octree of R. Portalez and F. Duguet ([`super::Published`]) lets neighbours differ by one level at most, so that
//! a link leads to one leaf or one of four; they ask what would be gained without. Here a link leads to the node of the
//! same size across a face, or to the larger leaf that holds it; from a node that has children the line goes down to
//! the leaf where it is. Leaves are fewer, and steps into smaller ones longer.

use super::branches::{Branches, Names};
use super::cells::Cells;
use super::course::Course;
use super::limits::Limits;
use super::tree::{Lists, NONE, Tree};
use crate::structures::{Line, Scene, Search, Structure};

/// Bits of [`Leaf::len_and_log_size`] that are the logarithm of the leaf's size; the others are how many triangles it
/// lists.
const LOG_BITS: u32 = 5;

/// An octree of linked leaves, without a constraint on how they meet.
#[derive(Clone, Debug)]
pub struct Unconstrained {
    cells: Cells,
    branches: Branches,
    leaves: Vec<Leaf>,
    listed: Vec<u32>,
    margin: f32,
}

/// A leaf: 32 bytes.
#[derive(Clone, Copy, Debug)]
struct Leaf {
    /// The first of its triangles.
    first: u32,
    len_and_log_size: u32,
    /// What lies across each face, by the names of [`Branches`], or [`NONE`].
    links: [u32; 6],
}

impl Leaf {
    fn size(&self) -> u32 {
        1 << (self.len_and_log_size & ((1 << LOG_BITS) - 1))
    }

    fn triangles(&self) -> core::ops::Range<usize> {
        self.first as usize..self.first as usize + (self.len_and_log_size >> LOG_BITS) as usize
    }
}

impl Structure for Unconstrained {
    type Settings = Limits;
    const COPIES: bool = true;

    fn build(scene: &Scene, limits: &Limits) -> Self {
        let tree = Tree::grow(scene, limits, Lists::Triangles, scene.margin);
        let order = tree.leaves();
        let names = Names::new(&tree, order.iter().copied().zip(0..));
        let neighbours = tree.neighbours();
        let (mut leaves, mut listed) = (Vec::with_capacity(order.len()), Vec::new());
        for at in order {
            let node = &tree.nodes[at as usize];
            let named = |neighbour: u32| if neighbour == NONE { NONE } else { names.of(neighbour) };
            leaves.push(Leaf {
                first: listed.len() as u32,
                len_and_log_size: (node.triangles.len() as u32) << LOG_BITS | node.cell.size.ilog2(),
                links: neighbours[at as usize].map(named),
            });
            listed.extend(&node.triangles);
        }
        Self { cells: tree.cells, branches: Branches::new(&tree, &names), leaves, listed, margin: scene.margin }
    }

    fn listed(&self) -> &[u32] {
        &self.listed
    }

    fn visit(&self, line: &Line, search: &mut impl Search) {
        let course = Course::new(&self.cells, line);
        let mut cell = self.cells.root();
        let Some(mut t) = course.start(line, cell, self.margin) else { return };
        let mut number = self.branches.locate(&mut cell, &course, t);
        // Numbers that are none might lead astray, but not for longer.
        for _ in 0..self.leaves.len() {
            let leaf = &self.leaves[number as usize];
            search.step();
            search.test(leaf.triangles());
            let exits @ [x, y, z] = course.exits(cell);
            t = x.min(y.min(z));
            let axis = (0..2).find(|k| exits[*k] == t).unwrap_or(2);
            let link = leaf.links[2 * axis + (!course.mirror >> axis & 1) as usize];
            if link == NONE || search.end() < t - self.margin {
                return;
            }
            // The cell of the same size, and then the leaf that is smaller or larger.
            cell.corner[axis] += cell.size;
            number = self.branches.descend(link, &mut cell, &course, t);
            cell = cell.holder(self.leaves[number as usize].size());
        }
    }

    fn bytes(&self) -> usize {
        self.branches.bytes() + size_of_val(&self.leaves[..]) + size_of_val(&self.listed[..])
    }
}
