//! Handled conservatively, and with the test of the numeric contract, every structure gives what testing every triangle
//! gives, all bits.

use leafwalk::BruteForce;
use leafwalk::Mesh;
use leafwalk::structures::{Every, Exact, Structure, Traced};
use leafwalk_testing::differences::{differences, hard};
use leafwalk_testing::meshes;
use leafwalk_testing::tally::scaled;

/// Rays for each structure and mesh.
const RAYS: u64 = 4000;

/// Meshes in which methods fail, and a few plain ones.
fn meshes() -> Vec<(&'static str, Mesh)> {
    let one = Mesh::new(vec![[1.0, 2.0, 3.0], [1.5, 2.0, 3.0], [1.0, 2.25, 3.0]], vec![[0, 1, 2]]);
    let flat = Mesh {
        positions: meshes::soup(200, 81).positions.into_iter().map(|[x, y, _]| [x, y, 0.25]).collect(),
        ..meshes::soup(200, 81)
    };
    vec![
        ("one triangle", one),
        ("sphere", meshes::icosphere(3)),
        ("flat", flat),
        ("needles", meshes::needle_box(40)),
        ("walls", meshes::walls(60, 82)),
        ("soup", meshes::soup(1000, 83)),
        ("far from 0", meshes::placed(&meshes::bumpy_sphere(2, 84), 1.0, 1e4)),
        ("small in a sky box", meshes::in_sky_box(&meshes::icosphere(2), 1e4, 0.3)),
    ]
}

/// Compares a structure with brute force on all meshes.
fn compare<S: Structure>(name: &str, settings: &S::Settings) {
    for (seed, (mesh_name, mesh)) in (80..).zip(meshes()) {
        let oracle = BruteForce::new(&mesh).expect("a mesh that builds");
        let traced = Traced::<S, Exact>::conservative(&mesh, settings).expect("the same mesh");
        let found = differences(&[(name, &traced)], &oracle, &hard(&mesh), scaled(RAYS), seed);
        found.passes(&format!("{name}, {mesh_name}"), 0.05);
    }
}

#[test]
fn every_triangle() {
    compare::<Every>("every triangle", &());
}
