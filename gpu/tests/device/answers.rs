//! P4: the flavour `exact` gives the scalar tracer's bits, and its walks visit as many cells.

use std::sync::LazyLock;

use leafwalk::{Hit, Ray, Tracer, Work};
use leafwalk_core::Walk;
use leafwalk_gpu::testing::{Arithmetic, checks, self_test_of, unguarded_tracer};
use leafwalk_gpu::{Exactness, Flavour, Gpu, GpuTracer, SelfTest};
use leafwalk_testing::scenes::ORDINARY;
use leafwalk_testing::tally::{MOST_OTHERS, differing, others, scaled};
use leafwalk_testing::{meshes, rays};

use crate::Test;
use crate::scenes::{self, Scene};

pub(crate) const TESTS: &[Test] = &[
    ("exact hits, occlusions and cells are the scalar tracer's", exact),
    ("fast hits that differ are counted", fast),
    ("without guards some hit differs, or the driver keeps to the text", unguarded),
];

/// Rays a scene; half as many random ones beside them.
const RAYS: u64 = 20_000;

/// Rays of a scene, and what the scalar tracer does with each.
struct Expected {
    rays: Vec<Ray>,
    hits: Vec<Hit>,
    work: Vec<Work>,
}

impl Expected {
    fn new(scene: &Scene, seed: u64) -> Self {
        let mut rays = scenes::hard(scene, scaled(RAYS), seed);
        rays.extend(scenes::chords(scene, scaled(RAYS / 2), seed));
        let parts = scene.octree.parts();
        let walked = rays.iter().map(|ray| Walk::new(&parts).closest_hit_with_work(ray));
        let (hits, work) = walked.map(|(hit, work)| (Hit::from(hit), work)).unzip();
        Self { rays, hits, work }
    }
}

fn exact(gpu: &Gpu) {
    // Walked once for all adapters.
    static EXPECTED: LazyLock<Vec<Expected>> =
        LazyLock::new(|| scenes::ALL.iter().zip(100..).map(|(scene, seed)| Expected::new(scene, seed)).collect());
    let mut rays_in_all = 0;
    for (scene, Expected { rays, hits: expected, work }) in scenes::ALL.iter().zip(&*EXPECTED) {
        let tracer = GpuTracer::on(gpu, &scene.octree, Flavour::Exact).expect("room for a small octree");
        assert_eq!(tracer.exactness(), Exactness::Exact, "{}", tracer.self_test());
        rays_in_all += rays.len();
        let found = hits(&tracer, rays);
        let share = expected.iter().filter(|hit| !hit.is_miss()).count() as f64 / rays.len() as f64;
        assert!(share > 0.02, "{}: only {share} of the rays hit", scene.name);
        if let Some(at) = (0..rays.len()).find(|at| differing(&found[*at..=*at], &expected[*at..=*at]) > 0) {
            let count = differing(&found, expected);
            let (found, expected, ray) = (found[at], expected[at], rays::hex(&rays[at]));
            panic!("{}: {count} hits differ; ray {at}: {found:?}, expected {expected:?}\n{ray}", scene.name);
        }

        let mut occluded = vec![false; rays.len()];
        tracer.occlusions(rays, &mut occluded).expect("a working device");
        let wrong = occluded.iter().zip(expected).filter(|(occluded, hit)| **occluded == hit.is_miss()).count();
        assert_eq!(wrong, 0, "{}: occlusions differ", scene.name);

        let mut answers = vec![(Hit::MISS, Work::default()); rays.len()];
        tracer.closest_hits_with_work(rays, &mut answers).expect("a working device");
        for ((ray, (_, work)), expected) in rays.iter().zip(&answers).zip(work) {
            assert_eq!(work.cells, expected.cells, "{}: cells of {}", scene.name, rays::hex(ray));
            // Boxes are tested as the driver likes, with a margin.
            assert!(
                work.blocks.abs_diff(expected.blocks) <= 1 + expected.blocks / 8,
                "{}: {work:?}, {expected:?}",
                scene.name
            );
        }
        let again: Vec<Hit> = answers.into_iter().map(|(hit, _)| hit).collect();
        assert_eq!(differing(&again, expected), 0, "{}: hits with work differ", scene.name);
    }
    println!("{}: {rays_in_all} rays, 0 differing bits", gpu.adapter());
}

fn fast(gpu: &Gpu) {
    let self_test = SelfTest::of(gpu, Flavour::Fast).expect("a working device");
    println!("{}: fast: {self_test}", gpu.adapter());
    for (scene, seed) in scenes::ALL.iter().zip(200..) {
        let tracer = GpuTracer::on(gpu, &scene.octree, Flavour::Fast).expect("room for a small octree");
        for (kind, rays) in [("hard", scenes::hard(scene, RAYS, seed)), ("random", scenes::chords(scene, RAYS, seed))] {
            let (expected, found) = (hits(&scene.octree, &rays), hits(&tracer, &rays));
            let others = others(&found, &expected);
            let (bits, of) = (differing(&found, &expected), rays.len());
            println!(
                "{}: fast, {}: of {of} {kind} rays {bits} hits differ, {others} in the triangle",
                gpu.adapter(),
                scene.name
            );
            // Elsewhere rays or triangles are made to differ.
            let is_ordinary = scene.name == ORDINARY && kind == "random";
            assert!(!is_ordinary || others as f64 <= MOST_OTHERS * of as f64, "{}: {others} of {of}", scene.name);
        }
    }
}

fn unguarded(gpu: &Gpu) {
    let scene = Scene::new("needles", meshes::shards(1500, 1e-3..4.0, 1e6, 12));
    let rays = scenes::hard(&scene, RAYS, 300);
    let tracer = unguarded_tracer(gpu, &scene.octree).expect("room for a small octree");
    let count = differing(&hits(&tracer, &rays), &hits(&scene.octree, &rays));
    let self_test = self_test_of(gpu, &checks(Arithmetic::Unguarded)).expect("a working device");
    assert_eq!(&self_test, tracer.self_test());
    let exactness = self_test.exactness();
    println!("{}: without guards {count} hits differ; self-test: {exactness}", gpu.adapter());
    // A driver that keeps to the text does not distinguish the mutant; then the self-test says so, too.
    assert_eq!(count > 0, exactness != Exactness::Exact, "{count} hits differ, and the self-test says {exactness}");
}

/// A tracer's closest hits.
pub(crate) fn hits<T: Tracer>(tracer: &T, rays: &[Ray]) -> Vec<Hit> {
    let mut hits = vec![Hit::MISS; rays.len()];
    tracer.closest_hits(rays, &mut hits).expect("equal lengths, and a working device");
    hits
}
