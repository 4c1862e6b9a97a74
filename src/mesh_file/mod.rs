//! Triangle meshes in OBJ (with MTL), PLY and STL files, each also gzipped.
//!
//! [`load_mesh`](crate::load_mesh) chooses the format by the file's extension (`.obj`, `.ply`, `.stl`, in any case,
//! with or without a `.gz` after it) and answers with a [`MeshFile`]: triangles in the order of the file's faces,
//! polygons split into fans, and a material for each triangle where the file names some. Bad input is a [`MeshError`]
//! that names the file and the place; it never panics, and memory grows only with bytes that were really read.
//!
//! Vertices that are not finite pass through as they are, from every format that can hold them (ASCII PLY and ASCII
//! STL cannot: there they are a [`MeshError::Syntax`]); the builder rejects them by number.

mod any_mesh;
mod error;
mod lines;
pub(crate) mod load;
mod mtl;
mod obj;
mod ply;
mod polygon;
mod source;
mod stl;

use std::path::PathBuf;

pub use any_mesh::AnyMesh;
pub use error::MeshError;

/// What a mesh file held.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshFile {
    /// The vertices of the file in its order, used or not (STL: each different position once, in order of appearance),
    /// and its triangles in the order of its faces. Material ids index [`materials`](Self::materials); both are empty
    /// where the file gives no face a material. Builders take it as it is.
    pub mesh: AnyMesh,
    /// The materials of the MTL files in their order, then those that faces use and no MTL file defines.
    pub materials: Vec<Material>,
    /// MTL files that the OBJ file names and that do not exist.
    pub missing_libraries: Vec<PathBuf>,
    /// Faces with fewer than three corners: they make no triangle.
    pub skipped_faces: usize,
}

/// A surface's colours, from an MTL file: linear red, green, blue, as written there.
///
/// A material that no MTL file defines keeps the name that `usemtl` gave it (faces before the first `usemtl`: an empty
/// name) and is a neutral grey of 0.5 that emits nothing. So is, for the one colour, a material whose `Kd` is absent,
/// not finite, or given as a spectrum.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name in the file.
    pub name: String,
    /// Diffuse reflectance, `Kd`.
    pub diffuse: [f32; 3],
    /// Emitted radiance, `Ke`; zero where absent.
    pub emission: [f32; 3],
}

impl Material {
    fn neutral(name: &str) -> Self {
        Self { name: name.to_owned(), diffuse: [0.5; 3], emission: [0.0; 3] }
    }
}

/// How much of a file is read before it counts as an attack or an accident.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes after decompression, of the mesh file and of each MTL file. While it is read, a file made to be costly
    /// takes at most some ten times as much memory, an OBJ file some fifty times (tobj keeps 104 bytes a face).
    pub max_bytes: u64,
    /// Bytes of one line of text, line end and continuations included.
    pub max_line: usize,
}

impl Default for Limits {
    /// 8 GiB, and lines of 16 MiB: a polygon of a million corners.
    fn default() -> Self {
        Self { max_bytes: 8 << 30, max_line: 16 << 20 }
    }
}
