//! Loading a mesh file: which format it has, and who reads it.

use std::path::Path;

use super::source::{self, Source};
use super::{Limits, MeshError, MeshFile, obj, ply, stl};

/// Reads an OBJ, PLY or STL file, gzipped or not, under the default [`Limits`].
///
/// # Errors
/// [`MeshError`], when the file cannot be read or does not hold a mesh.
pub fn load_mesh(path: impl AsRef<Path>) -> Result<MeshFile, MeshError> {
    load_mesh_with_limits(path, &Limits::default())
}

/// Reads a mesh file as [`load_mesh`] does, under other limits.
///
/// # Errors
/// [`MeshError`], when the file cannot be read, does not hold a mesh, or goes beyond `limits`.
pub fn load_mesh_with_limits(path: impl AsRef<Path>, limits: &Limits) -> Result<MeshFile, MeshError> {
    let path = path.as_ref();
    let name = if source::is_named_gzip(path) { path.with_extension("") } else { path.to_owned() };
    let extension = name.extension().map(|extension| extension.to_ascii_lowercase());
    let read = match extension.as_ref().and_then(|extension| extension.to_str()) {
        Some("obj") => obj::read,
        Some("ply") => ply::read,
        Some("stl") => stl::read,
        _ => return Err(MeshError::UnknownFormat { path: path.to_owned() }),
    };
    read(Source::open(path, limits)?)
}
