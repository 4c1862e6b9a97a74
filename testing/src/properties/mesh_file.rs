//! Any file: a typed error, or a mesh whose indices are in range.

use std::fs;

use leafwalk::mesh_file::{Limits, load_with};
use leafwalk::{BuildError, Builder};

/// Reads the bytes as a file of this extension: `obj`, `ply` or `stl`. Returns whether they are one.
pub fn check(extension: &str, bytes: &[u8]) -> bool {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("mesh").with_extension(extension);
    fs::write(&path, bytes).expect("a file in it");
    let limits = Limits { max_bytes: 1 << 20, max_line: 1 << 16 };
    let file = match load_with(&path, &limits) {
        Ok(file) => file,
        Err(error) => {
            assert!(error.to_string().contains("mesh."), "an error names its file: {error}");
            return false;
        }
    };
    let (mesh, materials) = (&file.mesh, file.materials.len() as u32);
    assert!(mesh.triangles.iter().flatten().all(|i| (*i as usize) < mesh.positions.len()), "an index out of range");
    assert!(mesh.material_ids.iter().all(|id| *id < materials), "a material out of range");
    match Builder::new().memory_limit(1 << 28).lenient().build(mesh) {
        Ok(octree) => assert_eq!(octree.stats().primitives as usize, mesh.triangles.len()),
        Err(error) => assert!(matches!(error, BuildError::OutOfMemory { .. }), "{error}"),
    }
    true
}
