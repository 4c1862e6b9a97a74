//! The readers of mesh files, as the fuzz targets call them.

use std::path::Path;

use leafwalk::load_mesh_with_limits;
use leafwalk::mesh_file::Limits;
use leafwalk_testing::properties::mesh_file::{self, MAX_BYTES, MAX_LINE};

/// Reads the bytes as a file of this extension, and panics where the property of mesh files does not hold.
pub fn check_mesh_file(extension: &str, bytes: &[u8]) {
    let limits = Limits { max_bytes: MAX_BYTES, max_line: MAX_LINE };
    let read = |path: &Path| load_mesh_with_limits(path, &limits).map(|file| (file.mesh, file.materials.len()));
    mesh_file::check(extension, bytes, read);
}
