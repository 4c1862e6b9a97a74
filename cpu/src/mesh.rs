//! The input: an indexed triangle mesh.

use leafwalk_core::{Hit, geometric_normal};

/// An indexed triangle mesh in the caller's units.
///
/// A triangle's place in `triangles` is its `primitive` in every hit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions; those no triangle uses are ignored.
    pub positions: Vec<[f32; 3]>,
    /// Three indices into `positions` a triangle.
    pub triangles: Vec<[u32; 3]>,
    /// One material id a triangle, or empty: no materials.
    pub material_ids: Vec<u32>,
}

impl Mesh {
    /// A mesh without materials.
    pub fn new(positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Self {
        Self { positions, triangles, material_ids: Vec::new() }
    }

    /// The three corners of a triangle, in the caller's units.
    ///
    /// # Panics
    /// When the triangle or one of its indices is out of range; [`crate::Builder::build`] reports those as errors.
    pub fn corners(&self, primitive: usize) -> [[f32; 3]; 3] {
        self.triangles[primitive].map(|index| self.positions[index as usize])
    }

    /// The point that was hit, in the caller's units. It lies on the triangle, to rounding, however far away the ray
    /// began.
    ///
    /// # Panics
    /// As [`Mesh::corners`]; so it does for [`Hit::MISS`].
    pub fn position(&self, hit: &Hit) -> [f32; 3] {
        hit.position(&self.corners(hit.primitive as usize)).map(|c| c as f32)
    }

    /// The unit normal of a triangle, on the side from which its corners stand counter-clockwise; zero for a triangle
    /// without area.
    ///
    /// # Panics
    /// As [`Mesh::corners`].
    pub fn normal(&self, primitive: usize) -> [f32; 3] {
        geometric_normal(&self.corners(primitive))
    }

    /// Whether a ray of this direction hit the front of the triangle, from which its corners stand counter-clockwise.
    ///
    /// # Panics
    /// As [`Mesh::corners`]; so it does for [`Hit::MISS`].
    pub fn front(&self, hit: &Hit, direction: [f32; 3]) -> bool {
        Hit::front(&self.corners(hit.primitive as usize), direction)
    }
}
