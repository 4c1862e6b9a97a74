//! `NeighbourFinding`: leaf to leaf by H. Samet, "Implementing Ray Tracing with Octrees and Neighbor Finding",
//! Computers & Graphics 13(4), 1989.
//!
//! ```text
//! leaf = descend from the root to where the line begins
//! repeat:
//!     test the leaf's triangles
//!     axes = those across which the line leaves the leaf, all at a time: one for a face, two an edge, three a corner
//!     climb from node to parent until along each of the axes a node was passed that is its parent's nearer half
//!     leaf = descend from there to where the line is
//! ```
//! The node climbed to is the nearest common ancestor of the leaf and its neighbour. Samet finds the neighbour's mirror
//! image on the way down from tables; here each halving compares times, which for the axes that were crossed comes to
//! the same, and finds the leaf below a neighbour of the same size as well.

use super::cells::{Cell, Cells};
use super::course::Course;
use super::flat::Flat;
use super::limits::Limits;
use super::tree::{Lists, Tree};
use crate::structures::{Line, Scene, Search, Structure};

/// An octree whose nodes know their parents.
#[derive(Clone, Debug)]
pub struct NeighbourFinding {
    cells: Cells,
    flat: Flat,
    /// The parent of each eight siblings.
    parents: Vec<u32>,
    margin: f32,
}

/// A node, and its cell as the line's [`Course`] sees it.
struct Place {
    node: u32,
    cell: Cell,
}

impl NeighbourFinding {
    /// Goes down to the leaf in which the line is at some t.
    fn descend(&self, place: &mut Place, course: &Course, t: f32) {
        loop {
            let slot = self.flat.nodes[place.node as usize];
            if slot.is_leaf() {
                return;
            }
            place.node = slot.first + course.enter(&mut place.cell, t);
        }
    }

    /// Goes up to the node that holds the neighbour across some axes, if there is one.
    fn climb(&self, place: &mut Place, course: &Course, mut axes: u32) -> Option<()> {
        while axes != 0 {
            let (siblings, octant) = (place.node.checked_sub(1)? / 8, (place.node - 1) % 8);
            axes &= octant ^ course.mirror;
            *place = Place { node: self.parents[siblings as usize], cell: place.cell.parent() };
        }
        Some(())
    }
}

impl Structure for NeighbourFinding {
    type Settings = Limits;
    const COPIES: bool = true;

    fn build(scene: &Scene, limits: &Limits) -> Self {
        let tree = Tree::grow(scene, limits, Lists::Triangles, scene.margin);
        let flat = Flat::new(&tree);
        let mut parents = vec![0; flat.nodes.len() / 8];
        for (at, slot) in (0..).zip(&flat.nodes).filter(|(_, slot)| !slot.is_leaf()) {
            parents[(slot.first as usize - 1) / 8] = at;
        }
        Self { cells: tree.cells, flat, parents, margin: scene.margin }
    }

    fn listed(&self) -> &[u32] {
        &self.flat.listed
    }

    fn visit(&self, line: &Line, search: &mut impl Search) {
        let course = Course::new(&self.cells, line);
        let mut place = Place { node: 0, cell: self.cells.root() };
        let Some(mut t) = course.start(line, place.cell, self.margin) else { return };
        // Numbers that are none might lead astray, but not for longer.
        for _ in 0..self.flat.nodes.len() {
            self.descend(&mut place, &course, t);
            search.step();
            search.test(self.flat.nodes[place.node as usize].triangles());
            let exits @ [x, y, z] = course.exits(place.cell);
            t = x.min(y.min(z));
            let axes = (0..3).fold(0, |axes, k| axes | u32::from(exits[k] == t) << k);
            if axes == 0 || search.end() < t - self.margin || self.climb(&mut place, &course, axes).is_none() {
                return;
            }
        }
    }

    fn bytes(&self) -> usize {
        self.flat.bytes() + size_of_val(&self.parents[..])
    }
}
