//! The input: an indexed triangle mesh, owned or borrowed.

use leafwalk_core::{Hit, geometric_normal};

/// An indexed triangle mesh in the caller's units, with positions of f32 or, as `Mesh<f64>`, of f64.
///
/// A triangle's place in `triangles` is its `primitive` in every hit. No vertex of f32 is rounded in an octree. Those of
/// f64 are rounded once, after the frame's anchor is subtracted; they are for scenes that f32 cannot hold, such as UTM
/// coordinates, and their rays are best [`RayF64`](leafwalk_core::RayF64).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(bound = "S: leafwalk_core::numbers::Float"))]
pub struct Mesh<S = f32> {
    /// Vertex positions; those no triangle uses are ignored.
    #[cfg_attr(feature = "serde", serde(with = "positions"))]
    pub positions: Vec<[S; 3]>,
    /// The corners of each triangle: three indices into `positions`, counter-clockwise as seen from its front.
    pub triangles: Vec<[u32; 3]>,
    /// The material id of each triangle; empty where the mesh has no materials.
    pub material_ids: Vec<u32>,
}

impl Default for Mesh {
    /// No triangle.
    fn default() -> Self {
        Self { positions: Vec::new(), triangles: Vec::new(), material_ids: Vec::new() }
    }
}

/// How serde writes and reads the positions of a mesh: with the numbers that formats for humans, such as JSON, lack.
#[cfg(feature = "serde")]
mod positions {
    use leafwalk_core::numbers::{Float, Number};
    use serde::{Deserialize, Deserializer, Serializer};

    pub(super) fn serialize<F: Float, S: Serializer>(positions: &[[F; 3]], serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(positions.iter().map(|position| position.map(Number)))
    }

    pub(super) fn deserialize<'de, F: Float, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<[F; 3]>, D::Error> {
        let positions = Vec::<[Number<F>; 3]>::deserialize(deserializer)?;
        Ok(positions.into_iter().map(|position| position.map(|Number(c)| c)).collect())
    }
}

/// Positions of either precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Positions<'a> {
    F32(&'a [[f32; 3]]),
    F64(&'a [[f64; 3]]),
}

impl Positions<'_> {
    pub(crate) fn len(self) -> usize {
        match self {
            Self::F32(positions) => positions.len(),
            Self::F64(positions) => positions.len(),
        }
    }

    /// A position; every number of f32 is one of f64.
    fn at(self, index: u32) -> [f64; 3] {
        match self {
            Self::F32(positions) => positions[index as usize].map(f64::from),
            Self::F64(positions) => positions[index as usize],
        }
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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshRef<'a> {
    pub(crate) positions: Positions<'a>,
    pub(crate) triangles: &'a [[u32; 3]],
    pub(crate) material_ids: &'a [u32],
}

impl<'a> MeshRef<'a> {
    /// Borrows a mesh without materials: the fields of [`Mesh`] say what positions and triangles are.
    pub fn new(positions: &'a [[f32; 3]], triangles: &'a [[u32; 3]]) -> Self {
        Self { positions: Positions::F32(positions), triangles, material_ids: &[] }
    }

    /// As [`MeshRef::new`], with positions of f64.
    pub fn new_f64(positions: &'a [[f64; 3]], triangles: &'a [[u32; 3]]) -> Self {
        Self { positions: Positions::F64(positions), triangles, material_ids: &[] }
    }

    /// Returns this mesh with materials instead of those that it had: `material_ids` holds one id for each triangle.
    #[must_use]
    pub fn with_material_ids(self, material_ids: &'a [u32]) -> Self {
        Self { material_ids, ..self }
    }

    /// The triangles; see [`Mesh`].
    pub fn triangles(&self) -> &'a [[u32; 3]] {
        self.triangles
    }

    /// The material ids; see [`Mesh`].
    pub fn material_ids(&self) -> &'a [u32] {
        self.material_ids
    }

    /// The three corners of a triangle, in the caller's units; those of f32 lose nothing in f64.
    ///
    /// # Panics
    /// When the triangle or one of its indices is out of range; [`crate::Builder::build`] reports those as errors.
    pub fn corners(&self, primitive: usize) -> [[f64; 3]; 3] {
        self.triangles[primitive].map(|index| self.positions.at(index))
    }

    /// The point that was hit, in the caller's units. It lies on the triangle, to rounding, however far away the ray
    /// began.
    ///
    /// # Panics
    /// When the hit is [`Hit::MISS`], or its triangle or one of that triangle's indices is out of range.
    pub fn position(&self, hit: &Hit) -> [f64; 3] {
        hit.position(&self.corners(hit.primitive as usize))
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
        Self::new(&mesh.positions, &mesh.triangles).with_material_ids(&mesh.material_ids)
    }
}

impl<'a> From<&'a Mesh<f64>> for MeshRef<'a> {
    fn from(mesh: &'a Mesh<f64>) -> Self {
        Self::new_f64(&mesh.positions, &mesh.triangles).with_material_ids(&mesh.material_ids)
    }
}

impl Mesh {
    /// Makes a mesh without materials.
    pub fn new(positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Self {
        Self { positions, triangles, material_ids: Vec::new() }
    }

    /// The point that was hit, in the caller's units, as [`MeshRef::position`] gives it, rounded to f32.
    ///
    /// # Panics
    /// When [`MeshRef::position`] does.
    pub fn position(&self, hit: &Hit) -> [f32; 3] {
        MeshRef::from(self).position(hit).map(|c| c as f32)
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

impl Mesh<f64> {
    /// A mesh of f64 without materials. Its normals and the points of its hits are to be had from its [`MeshRef`].
    pub fn new_f64(positions: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Self {
        Self { positions, triangles, material_ids: Vec::new() }
    }
}

impl<S: Copy> Mesh<S> {
    /// The three corners of a triangle, in the caller's units.
    ///
    /// # Panics
    /// When [`MeshRef::corners`] does.
    pub fn corners(&self, primitive: usize) -> [[S; 3]; 3] {
        self.triangles[primitive].map(|index| self.positions[index as usize])
    }
}
