//! The input: an indexed triangle mesh, owned or borrowed.

use leafwalk_core::{Hit, geometric_normal};

/// An indexed triangle mesh in the caller's units.
///
/// A triangle's place in `triangles` is its `primitive` in every hit.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Mesh {
    /// Vertex positions; those no triangle uses are ignored.
    #[cfg_attr(feature = "serde", serde(with = "positions"))]
    pub positions: Vec<[f32; 3]>,
    /// The corners of each triangle: three indices into `positions`, counter-clockwise as seen from its front.
    pub triangles: Vec<[u32; 3]>,
    /// The material id of each triangle; empty where the mesh has no materials.
    pub material_ids: Vec<u32>,
}

/// How serde writes and reads the positions of a mesh: with the numbers that formats for humans, such as JSON, lack.
#[cfg(feature = "serde")]
mod positions {
    use leafwalk_core::numbers::Number;
    use serde::{Deserialize, Deserializer, Serializer};

    pub(super) fn serialize<S: Serializer>(positions: &[[f32; 3]], serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(positions.iter().map(|position| position.map(Number)))
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<[f32; 3]>, D::Error> {
        let positions = Vec::<[Number<f32>; 3]>::deserialize(deserializer)?;
        Ok(positions.into_iter().map(|position| position.map(|Number(c)| c)).collect())
    }
}

/// A borrowed [`Mesh`]: what builds and verifications read.
///
/// Positions that other crates keep need no copy. The vectors of glam (`Vec3`) and of nalgebra (`Point3<f32>`,
/// `Vector3<f32>`) are plain data with their feature `bytemuck`; so may be a type of one's own:
/// ```
/// use bytemuck::{Pod, Zeroable};
/// use leafwalk_cpu::{Builder, MeshRef};
///
/// #[derive(Clone, Copy, Pod, Zeroable)]
/// #[repr(C)]
/// struct Vector {
///     x: f32,
///     y: f32,
///     z: f32,
/// }
///
/// let positions = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| Vector { x, y, z: 0.0 });
/// let indices: Vec<u32> = vec![0, 1, 2];
/// let mesh = MeshRef::new(bytemuck::cast_slice(&positions), bytemuck::cast_slice(&indices));
/// let octree = Builder::new().build(mesh)?;
/// # assert_eq!(octree.stats().primitives, 1);
/// # Ok::<(), leafwalk_cpu::BuildError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeshRef<'a> {
    // Not public, so that positions of another precision can be borrowed one day.
    pub(crate) positions: &'a [[f32; 3]],
    pub(crate) triangles: &'a [[u32; 3]],
    pub(crate) material_ids: &'a [u32],
}

impl<'a> MeshRef<'a> {
    /// Borrows a mesh without materials: the fields of [`Mesh`] say what positions and triangles are.
    pub fn new(positions: &'a [[f32; 3]], triangles: &'a [[u32; 3]]) -> Self {
        Self { positions, triangles, material_ids: &[] }
    }

    /// Returns this mesh with materials instead of those that it had: `material_ids` holds one id for each triangle.
    #[must_use]
    pub fn with_material_ids(self, material_ids: &'a [u32]) -> Self {
        Self { material_ids, ..self }
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
    /// When the hit is [`Hit::MISS`], or its triangle or one of that triangle's indices is out of range.
    pub fn position(&self, hit: &Hit) -> [f32; 3] {
        hit.position(&self.corners(hit.primitive as usize)).map(|c| c as f32)
    }

    /// The unit normal of a triangle, on the side from which its corners stand counter-clockwise; zero for a triangle
    /// without area.
    ///
    /// # Panics
    /// When the triangle or one of its indices is out of range.
    pub fn normal(&self, primitive: usize) -> [f32; 3] {
        geometric_normal(&self.corners(primitive))
    }

    /// Whether a ray of this direction hit the front of the triangle, from which its corners stand counter-clockwise.
    ///
    /// # Panics
    /// When the hit is [`Hit::MISS`], or its triangle or one of that triangle's indices is out of range.
    pub fn front(&self, hit: &Hit, direction: [f32; 3]) -> bool {
        Hit::front(&self.corners(hit.primitive as usize), direction)
    }
}

impl<'a> From<&'a Mesh> for MeshRef<'a> {
    fn from(mesh: &'a Mesh) -> Self {
        Self { positions: &mesh.positions, triangles: &mesh.triangles, material_ids: &mesh.material_ids }
    }
}

impl Mesh {
    /// Makes a mesh without materials.
    pub fn new(positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Self {
        Self { positions, triangles, material_ids: Vec::new() }
    }

    /// The three corners of a triangle, in the caller's units, as [`MeshRef::corners`] gives them.
    ///
    /// # Panics
    /// When [`MeshRef::corners`] does.
    pub fn corners(&self, primitive: usize) -> [[f32; 3]; 3] {
        MeshRef::from(self).corners(primitive)
    }

    /// The point that was hit, in the caller's units, as [`MeshRef::position`] gives it.
    ///
    /// # Panics
    /// When [`MeshRef::position`] does.
    pub fn position(&self, hit: &Hit) -> [f32; 3] {
        MeshRef::from(self).position(hit)
    }

    /// The unit normal of a triangle, as [`MeshRef::normal`] gives it.
    ///
    /// # Panics
    /// When [`MeshRef::normal`] does.
    pub fn normal(&self, primitive: usize) -> [f32; 3] {
        MeshRef::from(self).normal(primitive)
    }

    /// Whether a ray of this direction hit the front of the triangle, as [`MeshRef::front`] tells it.
    ///
    /// # Panics
    /// When [`MeshRef::front`] does.
    pub fn front(&self, hit: &Hit, direction: [f32; 3]) -> bool {
        MeshRef::from(self).front(hit, direction)
    }
}
