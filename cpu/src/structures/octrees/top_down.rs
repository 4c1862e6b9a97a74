//! `TopDown`: the parametric descent of J. Revelles, C. Ureña, M. Lastra, "An Efficient Parametric Algorithm for Octree
//! Traversal", WSCG 2000.
//!
//! ```text
//! subtree(node, t0, t1):                    when the line enters and leaves the node across each axis, mirrored so
//!     leave if the node lies behind         that it runs upwards along all of them
//!     if it is a leaf: test its triangles
//!     tm = (t0 + t1) / 2                    when it crosses the middle planes
//!     child = the axes whose middle plane is crossed before the node is entered
//!     repeat:
//!         subtree(child, its t0, its t1)    of each axis t0 and tm, or tm and t1
//!         exit = the axis along which child is left first
//!         leave if child is the upper one along it; else child becomes the upper one
//! ```
//! Where the line is parallel to an axis, the paper has infinite times there, and compares the origin with the middle
//! plane instead of halving. Here such times are finite and beyond all others, so that they are halved like these, with
//! the same decisions.

use glam::Vec3;
use leafwalk_core::contract::{BOX_MARGIN, ROUNDOFF};
use leafwalk_core::layout::LATTICE;

use super::cells::Cells;
use super::course::{inverse, octant};
use super::flat::Flat;
use super::limits::{Limits, MOST_DEPTH};
use super::tree::{Lists, Tree};
use crate::structures::{Line, Scene, Search, Structure};

/// How many times the scene's margin the structure keeps, for what adds up on the way down. A time that is halved on
/// each level is rounded on each: by a roundoff of itself, which stands for two edges of the root at most, the longest
/// way from an origin to a plane. The root's own times need no more of the margin than any plane test.
const DRIFT: f32 = 1.0 + 2.0 * MOST_DEPTH as f32 * ROUNDOFF * LATTICE as f32 / BOX_MARGIN;

/// An octree that each ray descends from the root, once.
#[derive(Clone, Debug)]
pub struct TopDown {
    cells: Cells,
    flat: Flat,
    margin: f32,
}

impl Structure for TopDown {
    type Settings = Limits;
    const COPIES: bool = true;

    fn build(scene: &Scene, limits: &Limits) -> Self {
        let margin = scene.margin * DRIFT;
        let tree = Tree::grow(scene, limits, Lists::Triangles, margin);
        Self { cells: tree.cells, flat: Flat::new(&tree), margin }
    }

    fn listed(&self) -> &[u32] {
        &self.flat.listed
    }

    fn visit(&self, line: &Line, search: &mut impl Search) {
        let mirror = octant(line);
        let root = self.cells.bounds(self.cells.root());
        let inverse = inverse(line);
        let (a, b) = ((root.lower - line.origin) * inverse, (root.upper - line.origin) * inverse);
        let (first, last) = (a.min(b), a.max(b));
        if first.max_element() <= last.min_element() {
            let mut descent =
                Descent { flat: &self.flat, mirror, first: line.t_min - self.margin, margin: self.margin, search };
            descent.subtree(0, first, last);
        }
    }

    fn bytes(&self) -> usize {
        self.flat.bytes()
    }
}

/// A ray on its way down.
struct Descent<'a, S> {
    flat: &'a Flat,
    /// Bit k: axis k is mirrored.
    mirror: u32,
    /// What is left earlier lies behind.
    first: f32,
    margin: f32,
    search: &'a mut S,
}

impl<S: Search> Descent<'_, S> {
    fn subtree(&mut self, node: u32, t0: Vec3, t1: Vec3) {
        if t1.min_element() < self.first {
            return;
        }
        self.search.step();
        let slot = self.flat.nodes[node as usize];
        if slot.is_leaf() {
            self.search.test(slot.triangles());
            return;
        }
        let middle = 0.5 * t0 + 0.5 * t1;
        let entry = t0.max_element();
        let mut child = (0..3).fold(0, |child, k| child | u32::from(middle[k] < entry) << k);
        loop {
            let half =
                |a: Vec3, b: Vec3| Vec3::from_array(core::array::from_fn(|k| [a[k], b[k]][child as usize >> k & 1]));
            let (enter, leave) = (half(t0, middle), half(middle, t1));
            self.subtree(slot.first + (child ^ self.mirror), enter, leave);
            let exit = leave.min_element();
            let axis = (0..2).find(|k| leave[*k] == exit).unwrap_or(2);
            if child >> axis & 1 == 1 || self.search.end() < exit - self.margin {
                return;
            }
            child |= 1 << axis;
        }
    }
}
