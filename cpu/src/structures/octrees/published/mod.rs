//! The octree of R. Portalez and F. Duguet, "Lancer de rayon dans un octree": leaves alone are kept, each with the
//! addresses of its face neighbours, and a ray goes from leaf to leaf by signs of Plücker products and tables.
//!
//! ```text
//! leaf = the cube map's, where the line enters the root
//! repeat:
//!     for each triangle of the leaf: return if it is hit                 wrong: a hit may lie beyond the leaf
//!     face = EXIT_FACE[octant of the direction][signs of the products at the exit corner]
//!     j = SUB_FACE[face][signs of the products at the centre of that face]
//!     return if the leaf has no neighbour across the face
//!     leaf = the neighbour, or the j-th if there are four
//! ```
//! That is [`Mode::Printed`], with the tables of [`leafwalk_core::tables`]; a ray from within the root begins where its
//! line enters it, too. [`Mode::Corrected`] differs in what is wrong or left open there: it begins in the leaf where
//! the ray does, takes the exit face and the quadrant from the times at which planes are crossed (which the signs of
//! the products compare, but for rounding), knows no undefined face, and ends where the nearest hit lies before the
//! leaf's exit.

mod cube_map;
mod records;
mod table;
mod walk;

pub use table::{TableRow, nearest_leaf_limit, table_row};

use self::cube_map::CubeMap;
use self::records::Records;
use super::branches::{Branches, Names};
use super::cells::Cells;
use super::limits::Limits;
use super::tree::{Lists, Tree};
use crate::structures::{Line, Scene, Search, Structure};

/// Which loop leads a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// As the paper prints it.
    Printed,
    /// With its faults mended.
    #[default]
    Corrected,
}

/// What may be chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Settings {
    /// When cells are cut no more, but for those that are too large beside their neighbours.
    pub limits: Limits,
    /// Which triangles a leaf lists, which the paper does not say.
    pub lists: Lists,
    /// Which loop leads a ray.
    pub mode: Mode,
}

/// The octree.
#[derive(Clone, Debug)]
pub struct Published {
    cells: Cells,
    records: Records,
    start: Start,
    listed: Vec<u32>,
    margin: f32,
}

/// How the first leaf is found.
#[derive(Clone, Debug)]
enum Start {
    /// By where the line enters the root, wherever the ray begins.
    Printed(CubeMap),
    /// Down from the root.
    Corrected(Branches),
}

impl Structure for Published {
    type Settings = Settings;
    const COPIES: bool = true;

    fn build(scene: &Scene, settings: &Settings) -> Self {
        let mut tree = Tree::grow(scene, &settings.limits, settings.lists, scene.margin);
        tree.balance();
        let order = tree.leaves();
        let listed = order.iter().flat_map(|leaf| tree.nodes[*leaf as usize].triangles.iter().copied()).collect();
        let (records, addresses) = Records::new(&tree, &order);
        let names = Names::new(&tree, order.into_iter().zip(addresses));
        let branches = Branches::new(&tree, &names);
        let start = match settings.mode {
            Mode::Printed => Start::Printed(CubeMap::new(&tree, &branches)),
            Mode::Corrected => Start::Corrected(branches),
        };
        Self { cells: tree.cells, records, start, listed, margin: scene.margin }
    }

    fn listed(&self) -> &[u32] {
        &self.listed
    }

    fn visit(&self, line: &Line, search: &mut impl Search) {
        match &self.start {
            Start::Printed(map) => self.walk_as_printed(map, line, search),
            Start::Corrected(branches) => self.walk(branches, line, search),
        }
    }

    fn bytes(&self) -> usize {
        let start = match &self.start {
            Start::Printed(map) => map.bytes(),
            Start::Corrected(branches) => branches.bytes(),
        };
        self.records.bytes() + start + size_of_val(&self.listed[..])
    }
}
