//! The input: an indexed triangle mesh.

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
}
