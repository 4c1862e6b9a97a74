//! Any file: a typed error, or a mesh whose indices are in range.
//!
//! The reader under test belongs to the package `leafwalk`, which this one does not see, so callers pass it in.

use core::fmt::Display;
use std::fs;
use std::path::Path;

use leafwalk_cpu::{BuildError, Builder, MeshRef};

/// The limit of a file's size that the reader is to be given: what is made up stays small, and a file that is made to grow
/// when it is read meets the limit.
pub const MAX_BYTES: u64 = 1 << 20;
/// The limit of a line's length that the reader is to be given.
pub const MAX_LINE: usize = 1 << 16;

/// Reads the bytes as a file of this extension: `obj`, `ply` or `stl`. Returns whether they are one.
///
/// `read` gives the mesh of a file, and how many materials the file has.
pub fn check<M, E: Display>(extension: &str, bytes: &[u8], read: impl FnOnce(&Path) -> Result<(M, usize), E>) -> bool
where
    for<'m> &'m M: Into<MeshRef<'m>>,
{
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("mesh").with_extension(extension);
    fs::write(&path, bytes).expect("a file in it");
    let (mesh, materials) = match read(&path) {
        Ok(file) => file,
        Err(error) => {
            assert!(error.to_string().contains("mesh."), "an error names its file: {error}");
            return false;
        }
    };
    let mesh: MeshRef<'_> = (&mesh).into();
    assert!(mesh.material_ids().iter().all(|id| (*id as usize) < materials), "a material out of range");
    // An index that is out of range is another error.
    match Builder::new().memory_limit(1 << 28).lenient().build(mesh) {
        Ok(octree) => assert_eq!(octree.stats().primitives as usize, mesh.triangles().len()),
        Err(error) => assert!(matches!(error, BuildError::OutOfMemory { .. }), "{error}"),
    }
    true
}
