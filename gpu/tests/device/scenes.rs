//! Small scenes of every kind that a walk could fail on, real ones where there are any, and their hard rays.

use std::sync::LazyLock;

use leafwalk::{Builder, Hit, Mesh, Octree, Ray, load_mesh};
use leafwalk_testing::random::Random;
use leafwalk_testing::tally::bits;
use leafwalk_testing::{meshes, rays, scenes};

/// A mesh and its octree.
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

/// A scene of healthy triangles only.
pub(crate) const ORDINARY: &str = "bumpy sphere";

/// All of them, built once for all adapters.
pub(crate) static ALL: LazyLock<Vec<Scene>> = LazyLock::new(|| {
    let mut all = made();
    for (name, file) in [("bunny", "bunny.ply.gz"), ("dragon", "dragon.ply.gz"), ("conference", "conference.obj.gz")] {
        if let Some(path) = scenes::real(file, name) {
            all.push(Scene::new(name, load_mesh(&path).expect("a readable scene").mesh));
        }
    }
    all
});

fn made() -> Vec<Scene> {
    vec![
        Scene::new(ORDINARY, meshes::bumpy_sphere(5, 7)),
        Scene::new("needle box", meshes::needle_box(30)),
        Scene::new("turned needle box", meshes::turned(&meshes::needle_box(30))),
        Scene::new("soup", meshes::soup(1500, 4)),
        Scene::new("walls", meshes::walls(200, 5)),
        Scene::new("specks", meshes::shards(2000, 1e-7..1e-5, 1.0, 10)),
        Scene::new("giants", meshes::shards(500, 1.0..4.0, 1.0, 11)),
        Scene::new("needles", meshes::shards(1500, 1e-3..4.0, 1e6, 12)),
        Scene::new("far away", meshes::placed(&meshes::soup(1500, 21), 1e-3, 1e4)),
        // So few levels that payloads are chained.
        Scene::built_by(&Builder::new().max_level(2), "chains", meshes::soup(5000, 22)),
    ]
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

/// How many hits differ in some bit.
pub(crate) fn differing(hits: &[Hit], expected: &[Hit]) -> usize {
    hits.iter().zip(expected).filter(|(hit, expected)| bits(hit) != bits(expected)).count()
}
