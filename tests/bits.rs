//! One hash of all bits of all answers, which every build must give, whatever instructions its compiler may assume, on
//! any machine. `.ci/run` tests it for several.
//!
//! The expected one stands here, so meshes and rays are made by operations that IEEE 754 defines to the last bit.

use leafwalk::{BruteForce, Builder, CpuTracer, Hit, LengthMismatch, Mesh, Octree, Ray, Tracer, hit_hash};
use leafwalk_core::step::Pluecker;
use leafwalk_core::testing::Standard;
use leafwalk_cpu::testing;
use leafwalk_testing::meshes;
use leafwalk_testing::number::{Arithmetic, Fused, Number, Sound};
use leafwalk_testing::random::Random;
use leafwalk_testing::rays::{self, Shared};
use leafwalk_testing::tracers::{Every, OneByOne, Stepping};

/// Only a change of the numeric contract, or of the rays below, changes it.
const EXPECTED: u64 = 0x23f2_3b6b_dd79_0a02;

/// Rays of each kind at each mesh; several of the tracer's tasks, with a rest.
const RAYS: u64 = 4_000;

type Any<'a> = &'a dyn Tracer<Error = LengthMismatch>;

/// A mesh, its octree, and rays at it.
struct Scene {
    mesh: Mesh,
    octree: Octree<Vec<u32>>,
    rays: Vec<Ray>,
}

impl Scene {
    /// Rays of every hard kind, and runs of them for tiles: aimed at edges and vertices, in axis planes, from near and
    /// far, some cut next to their own hits.
    fn new(mesh: Mesh, seed: u64) -> Self {
        let octree = Builder::new().build(&mesh).expect("a mesh that builds");
        let (centre, size) = rays::extent(&mesh);
        let mut rays = rays::hard_and_cut(&octree, &mesh, RAYS, seed);
        for (shares, seed) in Shared::ALL.into_iter().zip(seed + 500..) {
            rays.extend((0..RAYS).map(|i| rays::coherent(shares, &mesh, centre, size, &mut Random::new(seed, i))));
        }
        Self { mesh, octree, rays }
    }

    fn batches(&self) -> CpuTracer<&[u32]> {
        CpuTracer::new(self.octree.view())
    }

    fn portable(&self) -> CpuTracer<&[u32]> {
        testing::portable(self.batches())
    }

    /// # Panics
    /// When a ray is occluded that hits nothing, or the other way around.
    fn hits(&self, tracer: Any<'_>) -> Vec<Hit> {
        let mut hits = vec![Hit::MISS; self.rays.len()];
        let mut occluded = vec![false; self.rays.len()];
        tracer.closest_hits(&self.rays, &mut hits).expect("equal lengths");
        tracer.occlusions(&self.rays, &mut occluded).expect("equal lengths");
        for ((ray, hit), occluded) in self.rays.iter().zip(&hits).zip(&occluded) {
            assert_eq!(!hit.is_miss(), *occluded, "{}", rays::hex(ray));
        }
        hits
    }
}

/// Small triangles and needles, closed; large ones close to each other.
fn scenes() -> [Scene; 3] {
    [
        Scene::new(meshes::bumpy_sphere(3, 71), 71),
        Scene::new(meshes::needle_box(30), 72),
        Scene::new(meshes::walls(100, 73), 73),
    ]
}

/// The hash of what a tracer of all scenes answers.
fn hash(scenes: &[Scene], answer: impl Fn(&Scene) -> Vec<Hit>) -> u64 {
    let hits: Vec<Hit> = scenes.iter().flat_map(answer).collect();
    let share = hits.iter().filter(|hit| !hit.is_miss()).count() as f64 / hits.len() as f64;
    assert!(share > 0.3, "{share} of the rays hit something, which tests too little");
    hit_hash(&hits)
}

fn hash_by<A: Arithmetic>(scenes: &[Scene]) -> u64 {
    hash(scenes, |scene| scene.hits(&Every::<Number<A>>::of(&scene.octree)))
}

/// A tracer by its name.
type Way<'a> = (&'a str, &'a dyn Fn(&Scene) -> Vec<Hit>);

#[test]
fn all_tracers_of_all_builds() {
    let ways: [Way<'_>; 13] = [
        ("every triangle", &|scene| scene.hits(&BruteForce::new(&scene.mesh).expect("a mesh that builds"))),
        ("the scalar walk", &|scene| scene.hits(&scene.octree)),
        ("the scalar walk by Plücker signs", &|scene| {
            scene.hits(&Stepping::<Pluecker, Standard>::new(&scene.octree.parts()))
        }),
        ("batches", &|scene| scene.hits(&scene.batches())),
        ("streams", &|scene| scene.hits(&testing::streamed(scene.batches()))),
        ("interleaved rays", &|scene| scene.hits(&testing::interleaved(scene.batches()))),
        ("walks in lanes", &|scene| scene.hits(&testing::walked(scene.batches()))),
        ("single rays", &|scene| scene.hits(&OneByOne(&scene.batches()))),
        ("batches in portable registers", &|scene| scene.hits(&scene.portable())),
        ("streams in portable registers", &|scene| scene.hits(&testing::streamed(scene.portable()))),
        ("interleaved rays in portable registers", &|scene| scene.hits(&testing::interleaved(scene.portable()))),
        ("walks in lanes, in portable registers", &|scene| scene.hits(&testing::walked(scene.portable()))),
        ("single rays in portable registers", &|scene| scene.hits(&OneByOne(&scene.portable()))),
    ];
    let scenes = scenes();
    for (name, way) in ways {
        let found = hash(&scenes, way);
        println!("{name}: {found:#018x}");
        assert_eq!(found, EXPECTED, "{name}: {found:#018x}, not {EXPECTED:#018x}");
    }
}

/// Small numbers stay what they are.
#[derive(Clone, Copy)]
struct Unflushed;
impl Arithmetic for Unflushed {
    const FLUSHES: bool = false;
}

#[test]
fn mutants_hash_otherwise() {
    let scenes = scenes();
    assert_eq!(hash_by::<Sound>(&scenes), EXPECTED, "the arithmetic of the mutants, not broken");
    assert_ne!(hash_by::<Fused>(&scenes), EXPECTED, "fused multiply-add in the triangle test");
    assert_ne!(hash_by::<Unflushed>(&scenes), EXPECTED, "numbers too small for exact products not flushed");
}
