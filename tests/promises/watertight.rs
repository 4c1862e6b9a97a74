//! P1: a ray from inside a closed mesh hits it, also where it is aimed at an edge or a vertex.

use glam::DVec3;
use leafwalk::{CpuTracer, Hit, Mesh, Ray};
use leafwalk_core::contract::ROUNDOFF;
use leafwalk_core::step::Pluecker;
use leafwalk_core::testing::Standard;
use leafwalk_testing::meshes;
use leafwalk_testing::random::Random;
use leafwalk_testing::rays::{self, Target, hex};
use leafwalk_testing::tally::{Tally, scaled, tally};
use leafwalk_testing::tracers::{Named, OneByOne, Stepping};
use rayon::prelude::*;

use crate::geometry::{corners, distance_to_triangle, point, winding};
use crate::scenes::{self, Scene};

/// Rays of each kind at each mesh; LEAFWALK_RAYS=50 makes 1e7 of each at the four meshes made in code.
const RAYS: u64 = 50_000;
/// Origins that the rays of a mesh share.
const ORIGINS: u64 = 1024;
/// Origins closer to a triangle than this share of the distance to its farthest corner may find it behind themselves: its
/// lateral error and its depth error, on the axes where they count (docs/contract.md, "Of one triangle").
const SAFE: f64 = (1.415 * 6.0 + 1.733 * 21.0) * ROUNDOFF as f64;

/// Which origins are tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Depth {
    /// Those for which the promise holds.
    Safe,
    /// Those nearer to the surface, but inside.
    Unsafe,
}

/// A point inside a closed mesh, and the triangle next to it.
#[derive(Clone, Copy)]
pub(crate) struct Inside {
    origin: [f32; 3],
    primitive: usize,
}

/// Points inside, at all depths below the surface, one a candidate that proves to be inside and at such a distance.
///
/// A turned-over mesh goes around its inside -1 times.
pub(crate) fn inside(mesh: &Mesh, depth: Depth, candidates: u64, seed: u64) -> Vec<Inside> {
    let (_, size) = rays::extent(mesh);
    let triangles: Vec<[DVec3; 3]> = (0..mesh.triangles.len()).map(|i| corners(mesh, i)).collect();
    let try_one = |index| {
        let mut random = Random::new(seed, index);
        let primitive = random.below(triangles.len());
        let [a, b, c] = triangles[primitive];
        let normal = (b - a).cross(c - a).try_normalize()?;
        let (u, v) = (f64::from(random.unit()), f64::from(random.unit()));
        let surface = a + u * (1.0 - v) * (b - a) + v * (c - a);
        // From the least safe distance of this triangle, or from a hundredth of that, upward.
        let safe = SAFE * farthest([a, b, c], surface);
        let height = match depth {
            Depth::Safe => safe * (f64::from(size) / (4.0 * safe)).powf(f64::from(random.unit())),
            Depth::Unsafe => safe * 0.01f64.powf(f64::from(random.unit())),
        };
        let origin = (surface - height * normal).as_vec3().to_array();
        let p = point(origin);
        let is_far = |triangle: &[DVec3; 3]| distance_to_triangle(triangle, p) > SAFE * farthest(*triangle, p);
        let is_safe = triangles.iter().all(is_far) == (depth == Depth::Safe);
        let turns: f64 = triangles.iter().map(|triangle| winding(triangle, p)).sum();
        (is_safe && (turns.abs() - 1.0).abs() < 0.01).then_some(Inside { origin, primitive })
    };
    (0..candidates).into_par_iter().filter_map(try_one).collect()
}

/// How far the farthest corner of a triangle is, along the axis where it is.
fn farthest(triangle: [DVec3; 3], from: DVec3) -> f64 {
    triangle.iter().fold(0.0, |farthest, corner| (*corner - from).abs().max_element().max(farthest))
}

/// A way to aim rays from points inside.
pub(crate) type Aim = fn(&Mesh, &[Inside], Target, &mut Random) -> Ray;

/// A ray from inside at a vertex or an edge near where the others of its run aim from the same origin.
fn aimed_together(mesh: &Mesh, inside: &[Inside], target: Target, random: &mut Random) -> Ray {
    let mut run = random.of_run(rays::RUN);
    let Inside { origin, primitive } = inside[run.below(inside.len())];
    let first = if run.below(2) == 0 { primitive } else { run.below(mesh.triangles.len()) };
    at((first + random.below(6)) % mesh.triangles.len(), mesh, origin, target, random)
}

/// A ray from inside at a vertex or an edge, half of them through the floats next to the exact direction.
pub(crate) fn aimed(mesh: &Mesh, inside: &[Inside], target: Target, random: &mut Random) -> Ray {
    let Inside { origin, primitive } = inside[random.below(inside.len())];
    // Half of them graze the surface near the origin.
    let primitive = if random.below(2) == 0 { primitive } else { random.below(mesh.triangles.len()) };
    at(primitive, mesh, origin, target, random)
}

fn at(primitive: usize, mesh: &Mesh, origin: [f32; 3], target: Target, random: &mut Random) -> Ray {
    let mut corners = mesh.corners(primitive);
    corners.rotate_left(random.below(3));
    let w = if target == Target::Vertex { 0.0 } else { random.unit() };
    let aim: [f32; 3] = core::array::from_fn(|k| corners[0][k] + w * (corners[1][k] - corners[0][k]));
    let direction = core::array::from_fn(|k| aim[k] - origin[k]);
    Ray::new(origin, if random.below(2) == 0 { direction } else { direction.map(|c| random.nudge(c)) })
}

/// The rays from inside that a tracer lets through.
pub(crate) fn misses(
    aim: Aim,
    tracers: &[Named<'_>],
    mesh: &Mesh,
    inside: &[Inside],
    target: Target,
    count: u64,
    seed: u64,
) -> Tally {
    tally(count, |indices, tally| {
        let ray = |index| aim(mesh, inside, target, &mut Random::new(seed, index));
        let rays: Vec<Ray> = indices.clone().map(ray).collect();
        let mut hits = vec![Hit::MISS; rays.len()];
        let mut occluded = vec![false; rays.len()];
        for (name, tracer) in tracers {
            tracer.closest_hits(&rays, &mut hits).expect("equal lengths");
            tracer.occlusions(&rays, &mut occluded).expect("equal lengths");
            for (i, index) in indices.clone().enumerate() {
                if hits[i].is_miss() || !occluded[i] {
                    tally.fault(index, || {
                        let ray = hex(&rays[i]);
                        format!(
                            "{name}, {target:?}, seed {seed}, ray {index}: {:?}, occluded {}\n{ray}",
                            hits[i], occluded[i]
                        )
                    });
                }
            }
        }
        hits.iter().for_each(|hit| tally.hit(!hit.is_miss()));
    })
}

fn check(name: &str, mesh: &Mesh, scene: &Scene, origins: u64, rays: u64, seed: u64) {
    assert!(meshes::is_closed(mesh), "{name} is not closed, so that its rays prove nothing");
    let near = inside(mesh, Depth::Unsafe, origins, seed);
    let inside = inside(mesh, Depth::Safe, origins, seed);
    assert!(inside.len() as u64 >= origins / 4, "{name}: only {} origins inside", inside.len());
    let parts = scene.octree.parts();
    let threads = CpuTracer::new(scene.octree.view());
    let compact = CpuTracer::new(scene.compact.view());
    let pluecker = Stepping::<Pluecker, Standard>::new(&parts);
    for target in [Target::Edge, Target::Vertex] {
        if !near.is_empty() {
            // Not promised, only counted.
            let tally = misses(aimed, &[("batches", &threads)], mesh, &near, target, scaled(rays / 10), seed + 4000);
            println!(
                "P1, {name}, {target:?}, {} origins nearer than promised: {} of {} rays miss",
                near.len(),
                tally.faults,
                tally.rays
            );
        }
        let check = |tracers: &[Named<'_>], name: &str, rays: u64, seed: u64| {
            let tally = misses(aimed, tracers, mesh, &inside, target, scaled(rays), seed);
            tally.passes(&format!("P1, {name}, {target:?}, {} origins", inside.len()), 1.0);
        };
        check(&[("batches", &threads)], name, rays, seed);
        let batches: [Named<'_>; 2] = [("batches", &threads), ("compact batches", &compact)];
        let together = misses(aimed_together, &batches, mesh, &inside, target, scaled(rays / 5), seed + 2000);
        together.passes(&format!("P1, {name}, {target:?}, coherent rays"), 1.0);
        // What P2 compares anyway takes a sample.
        let others: [Named<'_>; 3] = [
            ("the octree", &scene.octree),
            ("the walk with Plücker steps", &pluecker),
            ("single rays", &OneByOne(&threads)),
        ];
        check(&others, &format!("{name}, in other ways"), rays / 10, seed + 1000);
        let compact: [Named<'_>; 3] = [
            ("the compact octree", &scene.compact),
            ("compact batches", &compact),
            ("compact single rays", &OneByOne(&compact)),
        ];
        check(&compact, &format!("{name}, compact"), rays / 20, seed + 3000);
    }
}

#[test]
fn rays_from_inside_smooth_meshes_hit() {
    for (name, mesh, seed) in
        [("icosphere", meshes::icosphere(3), 31), ("bumpy sphere", meshes::bumpy_sphere(3, 3), 32)]
    {
        check(name, &mesh, &Scene::new(&mesh), ORIGINS, RAYS, seed);
    }
}

#[test]
fn rays_from_inside_meshes_of_needles_and_collinear_triangles_hit() {
    let straight = meshes::needle_box(30);
    let turned = meshes::turned(&straight);
    for (name, mesh, seed) in [("needle box", straight, 33), ("turned needle box", turned, 34)] {
        check(name, &mesh, &Scene::new(&mesh), ORIGINS, RAYS, seed);
    }
}

#[test]
fn rays_from_inside_the_dragon_hit() {
    if let Some((mesh, scene)) = scenes::dragon("P1 in the dragon") {
        check("dragon", mesh, scene, 64, 5_000, 35);
    }
}
