//! P2: an octree gives what testing every triangle gives, all bits.

use leafwalk::{Builder, CpuTracer, Hit, Leaf, Mesh, Octree, Ray, Tracer, Walk};
use leafwalk_core::step::{Pluecker, Slab};
use leafwalk_core::testing::Standard;
use leafwalk_cpu::testing;
use leafwalk_testing::differences::{differences, hard};
use leafwalk_testing::random::Random;
use leafwalk_testing::rays::Shared;
use leafwalk_testing::tally::{bits, scaled};
use leafwalk_testing::tracers::{LanesFrom, Named, OneByOne, Stepping, SteppingFrom, told};
use leafwalk_testing::{meshes, rays};

use crate::scenes::{self, Scene};

/// The octree, walked by both kinds of step and descended in all ways, against testing every triangle.
fn compare(name: &str, mesh: &Mesh, count: u64, seed: u64) {
    compare_scene(name, &Scene::new(mesh), mesh, count, seed);
}

/// The rays are aimed at a mesh, which may be a part of the scene.
pub(crate) fn compare_scene(name: &str, scene: &Scene, mesh: &Mesh, count: u64, seed: u64) {
    let parts = scene.octree.parts();
    let slab = Stepping::<Slab, Standard>::new(&parts);
    let pluecker = Stepping::<Pluecker, Standard>::new(&parts);
    let (slab_from, pluecker_from) =
        (SteppingFrom::<Slab, Standard>::new(&parts), SteppingFrom::<Pluecker, Standard>::new(&parts));
    let batches = CpuTracer::new(scene.octree.view());
    let portable = testing::portable(batches.clone());
    let (singles, portable_singles) = (OneByOne(&batches), OneByOne(&portable));
    let (streamed, portable_streamed) = (testing::streamed(batches.clone()), testing::streamed(portable.clone()));
    let interleaved = testing::interleaved(batches.clone());
    let (walked, portable_walked) = (testing::walked(batches.clone()), testing::walked(portable.clone()));
    let tracers: [Named<'_>; 16] = [
        ("the octree", &scene.octree),
        ("the walk with slab steps", &slab),
        ("the walk with Plücker steps", &pluecker),
        ("the walk with slab steps from leaves", &slab_from),
        ("the walk with Plücker steps from leaves", &pluecker_from),
        ("batches", &batches),
        ("single rays", &singles),
        ("streams", &streamed),
        ("interleaved rays", &interleaved),
        ("walks in lanes", &walked),
        ("walks in lanes from leaves", &LanesFrom(&batches)),
        ("portable batches", &portable),
        ("portable single rays", &portable_singles),
        ("portable streams", &portable_streamed),
        ("portable walks in lanes", &portable_walked),
        ("portable walks in lanes from leaves", &LanesFrom(&portable)),
    ];
    differences(&tracers, &scene.brute_force, &hard(mesh), scaled(count), seed).passes(name, 0.05);
    // What is right by now is the oracle for the compact octree.
    let compact = CpuTracer::new(scene.compact.view());
    let (streamed, interleaved) = (testing::streamed(compact.clone()), testing::interleaved(compact.clone()));
    let walked = testing::walked(compact.clone());
    let tracers: [Named<'_>; 7] = [
        ("the compact octree", &scene.compact),
        ("compact batches", &compact),
        ("compact single rays", &OneByOne(&compact)),
        ("compact streams", &streamed),
        ("compact interleaved rays", &interleaved),
        ("compact walks in lanes", &walked),
        ("compact walks in lanes from leaves", &LanesFrom(&compact)),
    ];
    differences(&tracers, &scene.octree, &hard(mesh), scaled(count / 8), seed + 700)
        .passes(&format!("{name}, compact"), 0.05);
    let (centre, size) = rays::extent(mesh);
    for (shares, seed) in Shared::ALL.into_iter().zip(seed + 500..) {
        let coherent = |random: &mut Random| rays::coherent(shares, mesh, centre, size, random);
        let name = format!("{name}, runs that share {shares:?}");
        let batches: [Named<'_>; 3] =
            [("batches", &batches), ("portable batches", &portable), ("compact batches", &compact)];
        differences(&batches, &scene.brute_force, &coherent, scaled(count / 12), seed).passes(&name, 0.1);
    }
}

#[test]
fn healthy_meshes() {
    compare("icosphere", &meshes::icosphere(3), 20_000, 1);
    compare("bumpy sphere", &meshes::bumpy_sphere(3, 7), 20_000, 2);
}

#[test]
fn nasty_meshes() {
    compare("needle box", &meshes::needle_box(30), 20_000, 3);
    compare("turned needle box", &meshes::turned(&meshes::needle_box(30)), 20_000, 3);
    compare("soup", &meshes::soup(1500, 4), 20_000, 4);
    compare("walls", &meshes::walls(200, 5), 20_000, 5);
}

#[test]
fn small_huge_and_needle_triangles() {
    compare("specks", &meshes::shards(2000, 1e-7..1e-5, 1.0, 10), 20_000, 10);
    compare("giants", &meshes::shards(500, 1.0..4.0, 1.0, 11), 20_000, 11);
    compare("needles", &meshes::shards(1500, 1e-3..4.0, 1e6, 12), 20_000, 12);
}

#[test]
fn scaled_and_moved_meshes() {
    for (scale, offset) in [(1e-3, 0.0), (1e3, 0.0), (1.0, 1e4), (1e-3, 10.0)] {
        let mesh = meshes::placed(&meshes::soup(1000, 8), scale, offset);
        compare(&format!("soup x {scale} + {offset}"), &mesh, 20_000, 8);
    }
}

#[test]
fn real_scenes() {
    if let Some((mesh, scene)) = scenes::dragon("P2 on the dragon") {
        compare_scene("dragon", scene, mesh, 200, 21);
    }
    if let Some((mesh, scene)) = scenes::conference("P2 in the conference room") {
        compare_scene("conference room", scene, mesh, 200, 22);
    }
}

#[test]
fn batches_give_what_single_calls_give() {
    let mesh = meshes::soup(300, 9);
    let octree = Builder::new().build(&mesh).expect("a mesh that builds");
    let tracer = CpuTracer::new(octree.view());
    let source = hard(&mesh);
    let rays: Vec<Ray> = (0..10_000).map(|i| source(&mut Random::new(9, i))).collect();
    let mut hits = vec![Hit::MISS; rays.len()];
    let mut occluded = vec![false; rays.len()];
    tracer.closest_hits(&rays, &mut hits).expect("equal lengths");
    tracer.occlusions(&rays, &mut occluded).expect("equal lengths");
    for (i, ray) in rays.iter().enumerate() {
        let single = bits(&Hit::from(octree.closest_hit(ray)));
        assert_eq!(single, bits(&hits[i]), "{}", rays::hex(ray));
        assert_eq!(single, bits(&Hit::from(octree.closest_hit_with_work(ray).0)), "{}", rays::hex(ray));
        assert_eq!(octree.occluded(ray), occluded[i], "{}", rays::hex(ray));
    }
    assert!(hits.iter().any(|hit| !hit.is_miss()));
}

/// The leaves in which the walk of a ray begins and ends.
fn ends(octree: &Octree<Vec<u32>>, ray: &Ray) -> [Leaf; 2] {
    let parts = octree.parts();
    let mut ends = [Leaf::UNKNOWN; 2];
    Walk::new(&parts).visit(ray, |record, _| {
        ends = [if ends[0] == Leaf::UNKNOWN { Leaf(record) } else { ends[0] }, Leaf(record)];
    });
    ends
}

/// The scalar walk and lanes tell where they end, whatever they are told, and how many rays they are told of; and what leaves
/// a hit mostly begins there.
#[test]
fn walks_end_where_what_leaves_their_hits_begins() {
    let mesh = meshes::soup(300, 29);
    let octree = Builder::for_walks().build(&mesh).expect("a mesh that builds");
    let (tracer, parts, frame) = (CpuTracer::new(octree.view()), octree.parts(), octree.frame());
    let source = hard(&mesh);
    let rays: Vec<Ray> = (0..10_000).map(|i| source(&mut Random::new(29, i))).collect();
    let expected: Vec<Leaf> = rays.iter().map(|ray| ends(&octree, ray)[1]).collect();
    let known: Vec<Leaf> = rays.iter().map(|ray| told(&parts, ray)).collect();
    let mut hits = vec![Hit::MISS; rays.len()];
    for known in [&known[..], &known[..5_000], &[]] {
        let mut found = vec![Leaf(0); rays.len()];
        tracer.closest_hits_from(&rays, known, &mut hits, &mut found).expect("equal lengths");
        assert!(found == expected, "in lanes, told {} leaves", known.len());
    }
    let (mut spawned, mut served) = (0, 0);
    for (i, ray) in rays.iter().enumerate() {
        let (hit, end) = octree.closest_hit_from(ray, known[i]);
        assert_eq!((bits(&hit.into()), end), (bits(&hits[i]), expected[i]), "{}", rays::hex(ray));
        let Some(hit) = hit else { continue };
        let corners = mesh.corners(hit.primitive as usize);
        let next = hit.spawn(&frame, &corners, Random::new(30, i as u64).direction());
        spawned += 1;
        served += u32::from(ends(&octree, &next)[0] == end);
    }
    println!("{served} of {spawned} rays that left a hit began where the walk to it ended");
    assert!(spawned > 500 && 10 * served > 9 * spawned, "{served} of {spawned}");
}
