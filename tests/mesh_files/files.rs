//! Files of a test.

use std::fs;
use std::io::Write as _;
use std::path::PathBuf;

use flate2::Compression;
use flate2::write::GzEncoder;
use leafwalk::mesh_file::{MeshError, MeshFile};
use leafwalk::{Mesh, load_mesh};
use tempfile::TempDir;

pub(crate) fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

pub(crate) fn write(folder: &TempDir, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.path().join(name);
    fs::write(&path, bytes).expect("a folder of ours");
    path
}

pub(crate) fn gzip(bytes: impl AsRef<[u8]>) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes.as_ref()).expect("room in memory");
    encoder.finish().expect("room in memory")
}

/// Reads the bytes as a file of that name, and again gzipped: both must give the same.
pub(crate) fn read(name: &str, bytes: impl AsRef<[u8]>) -> MeshFile {
    let folder = folder();
    let plain = load_mesh(write(&folder, name, &bytes)).expect("a file that can be read");
    let zipped = load_mesh(write(&folder, &format!("{name}.gz"), gzip(&bytes))).expect("a file that can be read");
    // Not `==`: a NaN must equal itself here, and the zeros differ.
    assert_eq!(format!("{plain:?}"), format!("{zipped:?}"));
    plain
}

/// The mesh of a file whose numbers f32 holds.
pub(crate) fn f32_mesh(file: &MeshFile) -> &Mesh {
    file.mesh.as_f32().expect("a mesh of f32")
}

/// As [`read`], for bytes that are no mesh.
pub(crate) fn refuse(name: &str, bytes: impl AsRef<[u8]>) -> MeshError {
    let folder = folder();
    let plain = load_mesh(write(&folder, name, &bytes)).expect_err("a file that cannot be read");
    let zipped =
        load_mesh(write(&folder, &format!("{name}.gz"), gzip(&bytes))).expect_err("a file that cannot be read");
    assert_eq!(plain.to_string().replace(name, ""), zipped.to_string().replace(&format!("{name}.gz"), ""));
    assert!(plain.to_string().starts_with(&plain.path().display().to_string()), "{plain}");
    plain
}
