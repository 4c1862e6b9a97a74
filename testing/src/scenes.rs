//! Scenes: one made in code of every kind that a tracer could fail on, and real ones, where LEAFWALK_SCENES names a folder
//! of them.

use std::path::{Path, PathBuf};

use leafwalk_cpu::Mesh;

use super::meshes;

/// A scene of healthy triangles only.
pub const ORDINARY: &str = "bumpy sphere";

/// Those made in code, by name.
pub fn made() -> Vec<(&'static str, Mesh)> {
    vec![
        (ORDINARY, meshes::bumpy_sphere(5, 7)),
        ("needle box", meshes::needle_box(30)),
        ("turned needle box", meshes::turned(&meshes::needle_box(30))),
        ("soup", meshes::soup(1500, 4)),
        ("walls", meshes::walls(200, 5)),
        ("specks", meshes::shards(2000, 1e-7..1e-5, 1.0, 10)),
        ("giants", meshes::shards(500, 1.0..4.0, 1.0, 11)),
        ("needles", meshes::shards(1500, 1e-3..4.0, 1e6, 12)),
        ("far away", meshes::placed(&meshes::soup(1500, 21), 1e-3, 1e4)),
    ]
}

/// A real scene that benches measure with.
pub struct Real {
    /// As it is called.
    pub name: &'static str,
    /// Its file in the folder.
    pub file: &'static str,
    /// Whether it is seen from inside, as a room is.
    pub inside: bool,
}

/// All of them.
pub const REAL: [Real; 5] = [
    Real { name: "bunny", file: "bunny.ply.gz", inside: false },
    Real { name: "armadillo", file: "armadillo_346k_resampled.ply.gz", inside: false },
    Real { name: "dragon", file: "dragon.ply.gz", inside: false },
    Real { name: "conference", file: "conference.obj.gz", inside: true },
    Real { name: "sponza", file: "sponza.obj.gz", inside: true },
];

/// The path of a real scene, or `None` with a line that says what is skipped.
pub fn real(name: &str, purpose: &str) -> Option<PathBuf> {
    let path = std::env::var_os("LEAFWALK_SCENES").map(|folder| PathBuf::from(folder).join(name));
    match path {
        Some(path) if path.exists() => Some(path),
        Some(path) => {
            println!("skipped: {purpose}: {} does not exist", path.display());
            None
        }
        None => {
            println!("skipped: {purpose}: LEAFWALK_SCENES is not set");
            None
        }
    }
}

/// What tables call a mesh file: its name up to its first dot.
pub fn name_of(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name.split('.').next().unwrap_or_default().to_owned()
}
