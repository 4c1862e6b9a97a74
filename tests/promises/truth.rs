//! P8: answers are the truth on the caller's own mesh, but for what the contract grants to rounding; and that is a share
//! of how far away the triangle is, not of the scene's size.

use core::sync::atomic::{AtomicU64, Ordering::Relaxed};

use leafwalk::{Builder, CpuTracer, Hit, Mesh, Octree, Ray};
use leafwalk_core::contract::SMALLEST_SHEARED;
use leafwalk_core::layout::LATTICE;
use leafwalk_testing::random::Random;
use leafwalk_testing::tally::{Tally, scaled, tally};
use leafwalk_testing::tracers::Any;
use leafwalk_testing::truth::{Excess, Oracle, Verdict};
use leafwalk_testing::{meshes, rays, wide, workloads};

use crate::same_answer::Source;
use crate::scenes;

/// What is only counted.
#[derive(Default)]
pub(crate) struct Report {
    /// Answers on another surface than the truth.
    misjudged: AtomicU64,
    /// The most of what the contract grants that was needed, in thousandths: across rays, and along them.
    lateral: AtomicU64,
    depth: AtomicU64,
}

impl Report {
    fn line(&self) -> String {
        let [lateral, depth] = [&self.lateral, &self.depth].map(|ratio| ratio.load(Relaxed) as f64 / 1000.0);
        format!("{} misjudged; {lateral} of e2, {depth} of t's bound at worst", self.misjudged.load(Relaxed))
    }
}

/// What any length in a frame may be off by: sheared coordinates below a number are taken for 0.
fn least_error<W: AsRef<[u32]>>(octree: &Octree<W>) -> f64 {
    f64::from(SMALLEST_SHEARED) / f64::from(LATTICE) * octree.frame().scale()
}

/// Rays whose answers are further from the truth than granted.
pub(crate) fn faults(
    tracer: Any<'_>,
    oracle: &Oracle,
    least: f64,
    source: Source<'_>,
    count: u64,
    seed: u64,
) -> (Tally, Report) {
    let report = Report::default();
    let tally = tally(count, |indices, tally| {
        let rays: Vec<Ray> = indices.clone().map(|index| source(&mut Random::new(seed, index))).collect();
        let mut hits = vec![Hit::MISS; rays.len()];
        tracer.closest_hits(&rays, &mut hits).expect("equal lengths");
        for ((index, ray), hit) in indices.zip(&rays).zip(&hits) {
            tally.hit(!hit.is_miss());
            let Excess { lateral, depth } = oracle.excess(ray, hit.ok().map(|hit| (hit.t, hit.primitive)), least);
            report.lateral.fetch_max((1000.0 * lateral) as u64, Relaxed);
            report.depth.fetch_max((1000.0 * depth) as u64, Relaxed);
            let truth = oracle.closest(ray);
            let verdict = oracle.judge(ray, truth.as_ref(), hit.t, hit.primitive);
            let is_misjudged = !matches!(verdict, Verdict::Right | Verdict::Neighbour | Verdict::Off);
            report.misjudged.fetch_add(u64::from(is_misjudged), Relaxed);
            if lateral.max(depth) > 1.0 {
                tally.fault(index, || {
                    let ray = rays::hex(ray);
                    let place = format!("seed {seed}, ray {index}: {lateral} of e2, {depth} of t's bound");
                    format!("{place}: {hit:?}, in truth {truth:?}\n{ray}")
                });
            }
        }
    });
    (tally, report)
}

fn check(name: &str, octree: &Octree<Vec<u32>>, oracle: &Oracle, source: Source<'_>, count: u64, least_hits: f64) {
    let tracer = CpuTracer::new(octree.view());
    let (tally, report) = faults(&tracer, oracle, least_error(octree), source, scaled(count), 91);
    let name = format!("truth, {name}");
    println!("{name}: {}", report.line());
    tally.passes(&name, least_hits);
}

fn build(mesh: &Mesh) -> Octree<Vec<u32>> {
    Builder::new().build(mesh).expect("a mesh that builds")
}

/// Rays of the four kinds of the benches.
fn check_workloads(name: &str, mesh: &Mesh, inside: bool, side: u32) {
    let (octree, oracle) = (build(mesh), Oracle::new(mesh));
    let rays: Vec<Ray> =
        workloads::all(&octree, mesh, inside, side).into_iter().flat_map(|workload| workload.rays).collect();
    let source = |random: &mut Random| rays[random.below(rays.len())];
    check(&format!("{name}, P S D R"), &octree, &oracle, &source, rays.len() as u64, 0.05);
}

#[test]
fn rays_of_scenes_made_in_code_hit_the_truth() {
    let scenes = [
        ("icosphere", meshes::icosphere(5)),
        ("bumpy sphere", meshes::bumpy_sphere(5, 92)),
        ("needle box", meshes::needle_box(30)),
        ("soup", meshes::soup(5000, 93)),
        ("needles", meshes::shards(5000, 1e-3..4.0, 1e6, 94)),
        ("walls", meshes::walls(100, 95)),
    ];
    for (name, mesh) in &scenes {
        check_workloads(name, mesh, false, 64);
        let (centre, size) = rays::extent(mesh);
        let hard = |random: &mut Random| rays::hard(mesh, centre, size, random);
        check(&format!("{name}, hard rays"), &build(mesh), &Oracle::new(mesh), &hard, 10_000, 0.05);
    }
}

#[test]
fn rays_of_real_scenes_hit_the_truth() {
    for (scene, inside) in [(scenes::dragon("truth"), false), (scenes::conference("truth"), true)] {
        if let Some((mesh, _)) = scene {
            check_workloads(if inside { "conference" } else { "dragon" }, mesh, inside, 128);
        }
    }
}

#[test]
fn rays_of_wide_scenes_hit_the_truth() {
    for scene in wide::all() {
        let source = |random: &mut Random| scene.ray(random);
        check(&scene.name, &build(&scene.mesh), &Oracle::new(&scene.mesh), &source, 4000, 0.01);
    }
}
