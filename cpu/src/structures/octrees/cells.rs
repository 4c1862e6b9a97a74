//! `Cells`: where the cells of an octree lie.

use glam::Vec3;

use crate::structures::{Bounds, Scene};

/// By what the root is larger than the cube around the triangles, so that no rounding leaves one outside: a few
/// roundoffs.
const ENLARGED: f32 = 1.0 + 8.0 * f32::EPSILON;

/// The grid of the smallest cells that an octree may have. All planes between cells are planes of it, so that each is
/// the same number whichever cell asks for it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cells {
    /// The root's corner of the least coordinates.
    lower: Vec3,
    /// The edge of a smallest cell.
    pub(super) step: f32,
    /// How many of these make an edge of the root: a power of two.
    pub(super) count: u32,
}

impl Cells {
    /// The cube around a scene, dilated, at the corner of the least coordinates, cut as often as told.
    pub(super) fn around(scene: &Scene, margin: f32, levels: u32) -> Self {
        let bounds = if scene.is_empty() { Bounds::around(&[Vec3::ZERO]) } else { scene.bounds() }.dilated(margin);
        let count = 1 << levels;
        Self { lower: bounds.lower, step: bounds.extent().max_element() * ENLARGED / count as f32, count }
    }

    /// A root of edge 1 in a corner at 0.
    pub(super) fn unit(count: u32) -> Self {
        Self { lower: Vec3::ZERO, step: 1.0 / count as f32, count }
    }

    /// Where a plane across an axis lies.
    #[inline]
    pub(super) fn plane(&self, axis: usize, plane: u32) -> f32 {
        self.lower[axis] + self.step * plane as f32
    }

    /// The box of a cell.
    pub(super) fn bounds(&self, cell: Cell) -> Bounds {
        let corner = |plus: u32| Vec3::from_array(core::array::from_fn(|k| self.plane(k, cell.corner[k] + plus)));
        Bounds { lower: corner(0), upper: corner(cell.size) }
    }

    /// The root.
    pub(super) fn root(&self) -> Cell {
        Cell { corner: [0; 3], size: self.count }
    }
}

/// A cell, in smallest cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cell {
    /// The corner of the least coordinates.
    pub(super) corner: [u32; 3],
    /// The edge: a power of two.
    pub(super) size: u32,
}

impl Cell {
    /// One of the eight halves: bit k of its octant is 1 where it is the upper one along axis k.
    pub(super) fn child(self, octant: u32) -> Self {
        let size = self.size / 2;
        Self { corner: core::array::from_fn(|k| self.corner[k] + size * (octant >> k & 1)), size }
    }

    /// The cell of the same size across a face, unless that is the root's: face 2k below along axis k, 2k + 1 above.
    pub(super) fn across(mut self, face: u32, count: u32) -> Option<Self> {
        let corner = &mut self.corner[face as usize / 2];
        *corner = if face & 1 == 1 { *corner + self.size } else { corner.checked_sub(self.size)? };
        (*corner < count).then_some(self)
    }

    /// The octant of a child of this size's parent that holds a corner.
    pub(super) fn octant_of(corner: [u32; 3], size: u32) -> u32 {
        (0..3).fold(0, |octant, k| octant | u32::from(corner[k] & size != 0) << k)
    }

    /// The cell of twice the size that holds this one.
    #[inline]
    pub(super) fn parent(self) -> Self {
        self.holder(2 * self.size)
    }

    /// The cell of a size, no smaller than this one's, that holds it.
    #[inline]
    pub(super) fn holder(self, size: u32) -> Self {
        Self { corner: self.corner.map(|c| c & !(size - 1)), size }
    }
}
