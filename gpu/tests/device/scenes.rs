//! Small scenes of every kind that a walk could fail on, real ones where there are any, and their hard rays.

use std::sync::LazyLock;

use leafwalk::{Builder, Mesh, Octree, Ray, load_mesh};
use leafwalk_testing::random::Random;
use leafwalk_testing::{meshes, rays, scenes};

/// An octree, and the mesh that rays are aimed at.
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    pub(crate) mesh: Mesh,
    pub(crate) octree: Octree<Vec<u32>>,
}

impl Scene {
    pub(crate) fn new(name: &'static str, mesh: Mesh) -> Self {
        Self::built_by(&Builder::new(), name, mesh)
    }

    pub(crate) fn built_by(builder: &Builder, name: &'static str, mesh: Mesh) -> Self {
        let octree = builder.build(&mesh).expect("a mesh that builds");
        Self { name, mesh, octree }
    }
}

/// All of them, built once for all adapters.
pub(crate) static ALL: LazyLock<Vec<Scene>> = LazyLock::new(|| {
    let made = scenes::made().into_iter().map(|(name, mesh)| Scene::new(name, mesh));
    // So few levels that leaves list nodes of the BVH.
    let large_leaves = Scene::built_by(&Builder::new().max_level(2), "large leaves", meshes::soup(5000, 22));
    let mut all: Vec<_> = made.chain([large_leaves, wide()]).collect();
    for (name, file) in [("bunny", "bunny.ply.gz"), ("dragon", "dragon.ply.gz"), ("conference", "conference.obj.gz")] {
        if let Some(path) = scenes::real(file, name) {
            all.push(Scene::new(name, load_mesh(&path).expect("a readable scene").mesh.into_f32()));
        }
    }
    all
});

/// A sphere in a sky box of 1e4 times its size, in leaves so large that they list nodes of the BVH, which have lattices of
/// their own. Rays are aimed at the sphere.
fn wide() -> Scene {
    let mesh = meshes::bumpy_sphere(4, 71);
    let whole = meshes::in_sky_box(&mesh, 2e4, 0.31);
    let octree = Builder::new().max_level(12).build(&whole).expect("a mesh that builds");
    assert!(!octree.lattices().is_empty());
    Scene { name: "wide", mesh, octree }
}

/// Hard rays of a scene, a third of those that hit cut next to a hit.
pub(crate) fn hard(scene: &Scene, count: u64, seed: u64) -> Vec<Ray> {
    rays::hard_and_cut(&scene.octree, &scene.mesh, count, seed)
}

/// Random rays through a scene.
pub(crate) fn chords(scene: &Scene, count: u64, seed: u64) -> Vec<Ray> {
    let (centre, size) = rays::extent(&scene.mesh);
    (0..count)
        .map(|index| {
            let mut random = Random::new(seed, index);
            let [from, to] =
                [random.vector(), random.vector()].map(|v| core::array::from_fn(|k| centre[k] + size * v[k]));
            rays::towards(from, to)
        })
        .collect()
}
