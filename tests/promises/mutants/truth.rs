//! Mutants of what answers may be off: vertices rounded to a lattice across the scene, as a frame would that counts from the
//! scene's corner, and short hits that are not met in the plane.

use leafwalk::{Builder, CpuTracer, Mesh};
use leafwalk_core::contract::ROUNDOFF;
use leafwalk_core::step::Slab;
use leafwalk_core::testing::{Policy, Standard};
use leafwalk_testing::random::Random;
use leafwalk_testing::tally::{Tally, scaled};
use leafwalk_testing::tracers::Stepping;
use leafwalk_testing::truth::{Oracle, Slack};
use leafwalk_testing::{meshes, rays, utm, wide};

use crate::truth::{faults, near_faults, utm_faults};

/// Vertices at whole roundoffs of the root's edge.
fn rounded(mesh: &Mesh) -> Mesh {
    let octree = Builder::new().build(mesh).expect("a mesh that builds");
    let step = f64::from(ROUNDOFF) * octree.frame().scale();
    let round = |c: f32| ((f64::from(c) / step).round() * step) as f32;
    Mesh { positions: mesh.positions.iter().map(|p| p.map(round)).collect(), ..mesh.clone() }
}

/// What the promise's check says of rays at a mesh that another one stands for.
fn against(mesh: &Mesh, traced: &Mesh, ray: impl Fn(&mut Random) -> leafwalk::Ray + Sync) -> Tally {
    let octree = Builder::new().build(traced).expect("a mesh that builds");
    faults(
        &CpuTracer::new(octree.view()),
        &Oracle::new(mesh),
        Slack { least: 0.0, anchor: None },
        &ray,
        scaled(4000),
        96,
    )
    .0
}

#[test]
fn vertices_rounded_across_the_scene() {
    let scene = wide::all().into_iter().find(|scene| scene.name.contains("stadium of 1e4")).expect("the stadium");
    let source = |random: &mut Random| scene.ray(random);
    against(&scene.mesh, &scene.mesh, source).passes("the stadium as it is, truth", 0.05);
    against(&scene.mesh, &rounded(&scene.mesh), source).catches("vertices rounded across the stadium");

    // Where the scene is no larger than what is looked at, close starts tell.
    let mesh = meshes::icosphere(4);
    let close = |random: &mut Random| {
        let at = rays::point_on(&mesh, rays::Target::Inside, random);
        leafwalk::Ray::new(at.map(|c| 1.001 * c), at.map(|c| -c))
    };
    against(&mesh, &mesh, close).passes("the sphere as it is, truth", 0.05);
    against(&mesh, &rounded(&mesh), close).catches("vertices rounded across the sphere");
}

/// Vertices of f64 as if the anchor were not where the detail is.
#[test]
fn vertices_of_f64_rounded_across_the_scene() {
    let scene = utm::all().into_iter().find(|scene| scene.name.contains("1e6 times as wide")).expect("the box");
    let octree = Builder::new().build(&scene.mesh).expect("a mesh that builds");
    let step = f64::from(ROUNDOFF) * octree.frame().scale();
    let positions = scene.mesh.positions.iter().map(|p| p.map(|c| (c / step).round() * step)).collect();
    let rounded = Mesh { positions, ..scene.mesh.clone() };
    utm_faults(&scene, &rounded).0.catches("vertices of f64 rounded across the scene");
}

#[derive(Clone, Copy)]
struct ByWeights;
impl Policy for ByWeights {
    const MEETS_PLANES: bool = false;
}

#[test]
fn short_hits_by_weights() {
    let mesh = meshes::bumpy_sphere(2, 98);
    let (octree, oracle) = (Builder::new().build(&mesh).expect("a mesh that builds"), Oracle::new(&mesh));
    let parts = octree.parts();
    let sound = Stepping::<Slab, Standard>::new(&parts);
    near_faults(&sound, &mesh, &oracle, scaled(4000), 98).passes("short hits of the walk, truth", 0.9);
    let by_weights = Stepping::<Slab, ByWeights>::new(&parts);
    near_faults(&by_weights, &mesh, &oracle, scaled(4000), 98).catches("short hits by the weights of their corners");
}
