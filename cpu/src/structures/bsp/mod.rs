//! `Bsp`: planes of any slant divide space.
//!
//! ```text
//! build(triangles):
//!     if they are few, or no plane of theirs helps: a leaf
//!     choose the plane beyond which a line has the fewest tests to expect, by the surfaces of the two cells
//!     those in the plane stay at the node; those on both sides of it go to both
//! visit(node, part of the line):
//!     near part, far part = the part cut at the plane; each goes on beyond it by the reach
//!     visit the near child; where there are both parts, test those in the plane; visit the far child
//! ```
//! H. Fuchs, Z. Kedem and B. Naylor, "On Visible Surface Generation by A Priori Tree Structures", SIGGRAPH, 1980. What departs
//! from it: triangles are not cut, but listed on both sides; there are leaves, and a bound on depth and on what is listed;
//! which plane is chosen is said by the surfaces of what it makes of a cell (J. MacDonald and K. Booth, "Heuristics for Ray
//! Tracing Using Space Subdivision", The Visual Computer 6, 1990), as by cuts and balance alone rays take two to four times as long;
//! planes may also be erected on the edges of triangles (T. Ize, I. Wald and S. Parker, "Ray Tracing with the BSP Tree",
//! Symposium on Interactive Ray Tracing, 2008), without which convex meshes cannot be divided: each of their planes has all
//! of the mesh on one side.

mod build;
mod cell;
mod plane;
mod visit;

use super::bounds::Bounds;
use super::line::Line;
use super::scene::Scene;
use super::structure::{Search, Structure};
use plane::Plane;

/// No path through the tree has more planes, whatever the mesh.
const DEPTH: usize = 48;

/// How a [`Bsp`] is built.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// As few triangles make a leaf without further ado.
    pub leaf: usize,
    /// Triangles of a node whose planes are tried.
    pub candidates: usize,
    /// Whether the planes that stand at right angles on a triangle's edges are tried beside its own.
    pub erects: bool,
    /// How many triangles may be listed more than once, as a multiple of all of them.
    pub copies: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self { leaf: 4, candidates: 8, erects: true, copies: 8 }
    }
}

impl Settings {
    /// No planes but those of triangles, as Fuchs, Kedem and Naylor have it.
    pub fn own_planes_only() -> Self {
        Self { erects: false, candidates: 16, ..Self::default() }
    }
}

/// A tree of planes, with triangles in its leaves and in the planes themselves.
#[derive(Clone, Debug)]
pub struct Bsp {
    nodes: Vec<Node>,
    listed: Vec<u32>,
    /// Around all triangles, with the margin.
    bounds: Bounds,
    /// How far beyond a plane lines are followed on either side.
    reach: f32,
}

/// Places in [`Bsp::listed`], the second excluded.
type Places = [u32; 2];

#[derive(Clone, Copy, Debug)]
enum Node {
    Leaf(Places),
    Split {
        plane: Plane,
        /// Triangles in the plane.
        within: Places,
        /// Behind the plane and before it.
        children: [u32; 2],
    },
}

impl Structure for Bsp {
    type Settings = Settings;
    const COPIES: bool = false;

    fn build(scene: &Scene, settings: &Settings) -> Self {
        build::build(scene, settings)
    }

    fn listed(&self) -> &[u32] {
        &self.listed
    }

    fn visit(&self, line: &Line, search: &mut impl Search) {
        visit::visit(self, line, search);
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.listed[..])
    }
}
