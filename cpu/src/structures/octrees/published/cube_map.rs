//! `CubeMap`: the leaf at each place of the root's surface.

use glam::Vec3;

use super::super::branches::Branches;
use super::super::cells::Cells;
use super::super::course::Course;
use super::super::tree::Tree;
use crate::structures::Line;

/// Texels along an edge of the root, at most: what the paper's largest map has. Where leaves at the surface are
/// smaller, some are never found.
const MOST_TEXELS: u32 = 1024;

/// For each texel of the root's six faces, lower and upper x, y, z, the leaf at its centre.
#[derive(Clone, Debug)]
pub(super) struct CubeMap {
    /// Texels along an edge.
    side: u32,
    texels: Vec<u32>,
}

impl CubeMap {
    /// As fine as the smallest leaf, if that is not too fine.
    pub(super) fn new(tree: &Tree<'_>, branches: &Branches) -> Self {
        let smallest = tree.nodes.iter().map(|node| node.cell.size).min().unwrap_or(tree.cells.count);
        let side = (tree.cells.count / smallest).min(MOST_TEXELS);
        let texels = (0..6 * side * side).map(|texel| {
            let (face, v, u) = ((texel / (side * side)) as usize, texel / side % side, texel % side);
            // A line into the root through the texel's middle, in a root whose edge is 1.
            let middle = |texel: u32| (texel as f32 + 0.5) / side as f32;
            let (axis, is_upper) = (face / 2, face % 2 == 1);
            let mut origin = [0.0; 3];
            (origin[axis], origin[(axis + 1) % 3], origin[(axis + 2) % 3]) =
                (f32::from(u8::from(is_upper)), middle(u), middle(v));
            let mut direction = [0.0; 3];
            direction[axis] = if is_upper { -1.0 } else { 1.0 };
            let line = Line::new(origin, direction, 0.0, f32::INFINITY);
            let course = Course::new(&Cells::unit(tree.cells.count), &line);
            branches.locate(&mut tree.cells.root(), &course, 0.0)
        });
        Self { side, texels: texels.collect() }
    }

    /// The leaf at a place of a face, in parts of the root's edge.
    pub(super) fn leaf(&self, axis: usize, is_upper: bool, place: Vec3) -> u32 {
        let texel = |k: usize| ((place[k] * self.side as f32) as u32).min(self.side - 1);
        let face = 2 * axis as u32 + u32::from(is_upper);
        self.texels[((face * self.side + texel((axis + 2) % 3)) * self.side + texel((axis + 1) % 3)) as usize]
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.texels[..])
    }
}
