//! Bounding volume hierarchies of two children a node: J. T. Kay and T. L. Kajiya, "Ray Tracing Complex Scenes", SIGGRAPH
//! 1986, with the builders of I. Wald, "On Fast Construction of SAH-based Bounding Volume Hierarchies", 2007.
//!
//! ```text
//! visit(line): if the root's volume is met, stack = [root]
//!     while there is a node on the stack whose entry is before the end of the search
//!         leaf: test its triangles
//!         else: both children whose volumes are met go onto the stack, the farther one first
//! ```

mod axis_box;
mod ball;
mod build;
mod k_dop;
mod oriented_box;
mod volume;

use core::ops::Range;

use super::line::Line;
use super::scene::Scene;
use super::structure::{Refit, Search, Structure};

pub use ball::Ball;
pub use build::{Settings, Splits};
pub use k_dop::KDop;
pub use oriented_box::OrientedBox;
pub use volume::Volume;

use build::{DEEPEST, Topology};

/// A hierarchy of volumes; each triangle lies in one leaf.
#[derive(Clone, Debug)]
pub struct Bvh<V> {
    /// Siblings side by side, and behind their parent; none where there is no triangle.
    nodes: Vec<Node<V>>,
    /// The triangles, leaf after leaf.
    listed: Vec<u32>,
}

/// A node: 32 bytes, if its volume is a box along the axes.
#[derive(Clone, Copy, Debug)]
struct Node<V> {
    volume: V,
    /// The first of its triangles, or the first of its two children.
    first: u32,
    /// How many triangles it has; 0 if it has children.
    count: u32,
}

impl<V: Volume> Bvh<V> {
    /// Fits the volumes to the triangles, children first.
    fn fit(&mut self, scene: &Scene) {
        let margin = V::MARGINS * scene.margin;
        let mut ranges = vec![0..0; self.nodes.len()];
        for i in (0..self.nodes.len()).rev() {
            let Node { first, count, .. } = self.nodes[i];
            let joined = if count > 0 {
                ranges[i] = first as usize..(first + count) as usize;
                None
            } else {
                let [left, right] = [first as usize, first as usize + 1];
                ranges[i] = ranges[left].start..ranges[right].end;
                self.nodes[left].volume.join(&self.nodes[right].volume)
            };
            self.nodes[i].volume =
                joined.unwrap_or_else(|| V::around(&corners(scene, &self.listed, &ranges[i]), margin));
        }
    }
}

/// The corners of a range of triangles.
fn corners(scene: &Scene, listed: &[u32], range: &Range<usize>) -> Vec<glam::Vec3> {
    listed[range.clone()].iter().flat_map(|triangle| scene.corners[*triangle as usize]).collect()
}

impl<V: Volume> Structure for Bvh<V> {
    type Settings = Settings;
    const COPIES: bool = true;

    fn build(scene: &Scene, settings: &Settings) -> Self {
        let Topology { nodes, listed } = Topology::new(scene, settings);
        let nodes = nodes.into_iter().map(|(first, count)| Node { volume: V::EMPTY, first, count }).collect();
        let mut bvh = Self { nodes, listed };
        bvh.fit(scene);
        bvh
    }

    fn listed(&self) -> &[u32] {
        &self.listed
    }

    fn visit(&self, line: &Line, search: &mut impl Search) {
        let Some(root) = self.nodes.first() else { return };
        let probe = V::probe(line);
        let Some(mut entry) = root.volume.entry(&probe, line.t_min, search.end()) else { return };
        // On each level below the root one node waits at most.
        let mut stack = [(0.0_f32, 0_u32); DEEPEST];
        let mut waiting = 0;
        let mut node = root;
        loop {
            if entry <= search.end() {
                search.step();
                let first = node.first as usize;
                if node.count > 0 {
                    search.test(first..first + node.count as usize);
                } else {
                    let end = search.end();
                    let [left, right] = [&self.nodes[first], &self.nodes[first + 1]];
                    let left_entry = left.volume.entry(&probe, line.t_min, end);
                    let right_entry = right.volume.entry(&probe, line.t_min, end);
                    match (left_entry, right_entry) {
                        (Some(a), Some(b)) => {
                            let is_left_near = a <= b;
                            stack[waiting] = if is_left_near { (b, node.first + 1) } else { (a, node.first) };
                            waiting += 1;
                            (entry, node) = if is_left_near { (a, left) } else { (b, right) };
                            continue;
                        }
                        (Some(a), None) => {
                            (entry, node) = (a, left);
                            continue;
                        }
                        (None, Some(b)) => {
                            (entry, node) = (b, right);
                            continue;
                        }
                        (None, None) => {}
                    }
                }
            }
            if waiting == 0 {
                return;
            }
            waiting -= 1;
            entry = stack[waiting].0;
            node = &self.nodes[stack[waiting].1 as usize];
        }
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.listed[..])
    }
}

impl<V: Volume> Refit for Bvh<V> {
    fn refit(&mut self, scene: &Scene) {
        self.fit(scene);
    }
}
