//! `AnyMesh`: a mesh in the precision that its file needs.

use leafwalk_core::contract::ROUNDOFF;

use crate::{Mesh, MeshRef};

/// The mesh of a file: of f32, or of f64 where f32 would lose what the file holds.
///
/// It is of f32, each number rounded once from what the file says, where that moves no coordinate of a triangle's corner
/// by more than 2^-24 of the mesh's largest extent. Else it is of f64: so it is with UTM coordinates, of which f32 keeps
/// half metres.
#[derive(Clone, Debug, PartialEq)]
pub enum AnyMesh {
    /// As most meshes are.
    F32(Mesh),
    /// Far from 0 for its extent.
    F64(Mesh<f64>),
}

impl Default for AnyMesh {
    /// No triangle.
    fn default() -> Self {
        Self::F32(Mesh::default())
    }
}

impl AnyMesh {
    /// The mesh of f32, unless it is of f64.
    pub fn as_f32(&self) -> Option<&Mesh> {
        match self {
            Self::F32(mesh) => Some(mesh),
            Self::F64(_) => None,
        }
    }

    /// The mesh in f32. One of f64 is rounded, which moves its vertices by more than an octree does.
    pub fn into_f32(self) -> Mesh {
        match self {
            Self::F32(mesh) => mesh,
            Self::F64(Mesh { positions, triangles, material_ids }) => {
                let positions = positions.into_iter().map(|position| position.map(|c| c as f32)).collect();
                Mesh { positions, triangles, material_ids }
            }
        }
    }

    /// The triangles; see [`Mesh`].
    pub fn triangles(&self) -> &[[u32; 3]] {
        match self {
            Self::F32(mesh) => &mesh.triangles,
            Self::F64(mesh) => &mesh.triangles,
        }
    }

    /// The material ids; see [`Mesh`].
    pub fn material_ids(&self) -> &[u32] {
        match self {
            Self::F32(mesh) => &mesh.material_ids,
            Self::F64(mesh) => &mesh.material_ids,
        }
    }

    /// Chooses between the positions that a file gives in f64 and the same positions in f32.
    pub(super) fn choose(
        rounded: Vec<[f32; 3]>,
        exact: impl Fn(usize) -> [f64; 3],
        triangles: Vec<[u32; 3]>,
        material_ids: Vec<u32>,
    ) -> Self {
        if is_close(&rounded, &exact, &triangles) {
            return Self::F32(Mesh { positions: rounded, triangles, material_ids });
        }
        Self::F64(Mesh { positions: (0..rounded.len()).map(exact).collect(), triangles, material_ids })
    }
}

impl<'a> From<&'a AnyMesh> for MeshRef<'a> {
    fn from(mesh: &'a AnyMesh) -> Self {
        match mesh {
            AnyMesh::F32(mesh) => mesh.into(),
            AnyMesh::F64(mesh) => mesh.into(),
        }
    }
}

/// Whether rounding to f32 moves no corner by more than a roundoff of the largest extent.
fn is_close(rounded: &[[f32; 3]], exact: impl Fn(usize) -> [f64; 3], triangles: &[[u32; 3]]) -> bool {
    let (mut lower, mut upper) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    let mut moved = 0.0_f64;
    let mut is_used = vec![false; rounded.len()];
    triangles.as_flattened().iter().for_each(|&index| is_used[index as usize] = true);
    for (vertex, rounded) in rounded.iter().enumerate().filter(|(vertex, _)| is_used[*vertex]) {
        let exact = exact(vertex);
        // No build takes what f32 cannot hold at all.
        for k in (0..3).filter(|k| rounded[*k].is_finite()) {
            lower[k] = lower[k].min(exact[k]);
            upper[k] = upper[k].max(exact[k]);
            moved = moved.max((exact[k] - f64::from(rounded[k])).abs());
        }
    }
    let extent = (0..3).map(|k| upper[k] - lower[k]).fold(0.0, f64::max);
    moved <= f64::from(ROUNDOFF) * extent
}
