//! P2 in wide scenes, whose detail takes few of the root's steps.

use leafwalk::Mesh;
use leafwalk_testing::meshes;

use crate::same_answer::compare_scene;
use crate::scenes::Scene;

/// Rays at what is small, and at all of the scene.
fn compare(name: &str, detail: &Mesh, edge: f32, share: f32, seed: u64) {
    let whole = meshes::in_sky_box(detail, edge, share);
    let scene = Scene::new(&whole);
    for octree in [&scene.octree, &scene.compact] {
        assert_eq!(octree.lattices().is_empty(), edge < 1e3, "{name} in {edge:e}");
        leafwalk::verify(octree).unwrap_or_else(|error| panic!("{name} in {edge:e}: {error}"));
    }
    compare_scene(&format!("{name} in a sky box of {edge:e}, off by {share}"), &scene, detail, 6_000, seed);
    compare_scene(
        &format!("{name} in a sky box of {edge:e}, off by {share}, from all over"),
        &scene,
        &whole,
        2_000,
        seed,
    );
}

#[test]
fn spheres_in_sky_boxes() {
    let sphere = meshes::bumpy_sphere(3, 71);
    for (edge, seed) in [1e2, 1e4, 1e6, 1e9].into_iter().zip(710..) {
        compare("sphere", &sphere, edge, 0.0, seed);
        compare("sphere", &sphere, edge, 0.31, seed + 100);
    }
}

#[test]
fn soups_and_needles_in_sky_boxes() {
    for (edge, seed) in [1e4, 1e6].into_iter().zip(720..) {
        compare("soup", &meshes::soup(600, 72), edge, 0.0, seed);
        compare("needle box", &meshes::needle_box(30), edge, -0.2, seed);
    }
}

/// What lies away from the anchor is coarser there.
#[test]
fn spheres_away_from_the_anchor() {
    for (offset, seed) in [(40.0, 730), (3e3, 731)] {
        let sphere = meshes::placed(&meshes::bumpy_sphere(3, 73), 1.0, offset);
        compare(&format!("sphere at {offset}"), &sphere, 1e4, 0.0, seed);
    }
}
