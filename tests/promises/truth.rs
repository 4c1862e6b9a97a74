//! P8: answers are the truth on the caller's own mesh, but for what the contract grants to rounding; and that is a share
//! of how far away the triangle is, not of the scene's size.

use core::fmt::Debug;
use core::sync::atomic::{AtomicU64, Ordering::Relaxed};

use leafwalk::{Builder, CpuTracer, Hit, HitF64, Mesh, Octree, Ray, RayF64};
use leafwalk_core::contract::SMALLEST_SHEARED;
use leafwalk_core::layout::LATTICE;
use leafwalk_testing::differences::Source;
use leafwalk_testing::random::Random;
use leafwalk_testing::tally::{Tally, scaled, tally};
use leafwalk_testing::tracers::Any;
use leafwalk_testing::truth::{Distance, Excess, Oracle, Slack, Verdict};
use leafwalk_testing::utm::{self, Utm};
use leafwalk_testing::{meshes, rays, wide, workloads};

use crate::geometry::{corners, point};
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
    /// Takes note of an answer, as if nothing had been rounded, and says how far it is from the truth.
    fn judge<R, T>(&self, oracle: &Oracle, ray: &R, answer: Option<(T, u32)>, slack: &Slack) -> Excess
    where
        R: Copy + Into<RayF64>,
        T: Distance,
    {
        let excess = oracle.excess(ray, answer, &Slack { anchor: None, ..*slack });
        self.lateral.fetch_max((1000.0 * excess.lateral) as u64, Relaxed);
        self.depth.fetch_max((1000.0 * excess.depth) as u64, Relaxed);
        let (t, primitive) = answer.map_or((f64::INFINITY, u32::MAX), |(t, primitive)| (t.into(), primitive));
        let verdict = oracle.judge(ray, oracle.closest(ray).as_ref(), t, primitive);
        let is_misjudged = !matches!(verdict, Verdict::Right | Verdict::Neighbour | Verdict::Off);
        self.misjudged.fetch_add(u64::from(is_misjudged), Relaxed);
        if slack.anchor.is_some() { oracle.excess(ray, answer, slack) } else { excess }
    }

    fn line(&self) -> String {
        let [lateral, depth] = [&self.lateral, &self.depth].map(|ratio| ratio.load(Relaxed) as f64 / 1000.0);
        format!("{} misjudged; {lateral} of e2, {depth} of t's bound at worst", self.misjudged.load(Relaxed))
    }
}

/// What any length in a frame may be off by: sheared coordinates below a number are taken for 0.
fn slack<W: AsRef<[u32]>>(octree: &Octree<W>) -> Slack {
    Slack { least: f64::from(SMALLEST_SHEARED) / f64::from(LATTICE) * octree.frame().scale(), anchor: None }
}

/// Rays whose answers are further from the truth than granted.
pub(crate) fn faults(
    tracer: Any<'_>,
    oracle: &Oracle,
    slack: Slack,
    source: Source<'_>,
    count: u64,
    seed: u64,
) -> (Tally, Report) {
    let trace = |rays: &[Ray]| {
        let mut hits = vec![Hit::MISS; rays.len()];
        tracer.closest_hits(rays, &mut hits).expect("equal lengths");
        hits.into_iter().map(|hit| hit.ok().map(|hit| (hit.t, hit.primitive))).collect()
    };
    faults_of(trace, oracle, slack, source, count, seed)
}

/// As [`faults`], of what traces many rays.
fn faults_of<R: Copy + Debug + Into<RayF64>, T: Debug + Distance>(
    trace: impl Fn(&[R]) -> Vec<Option<(T, u32)>> + Sync,
    oracle: &Oracle,
    slack: Slack,
    source: &(dyn Fn(&mut Random) -> R + Sync),
    count: u64,
    seed: u64,
) -> (Tally, Report) {
    let report = Report::default();
    let tally = tally(count, |indices, tally| {
        let rays: Vec<R> = indices.clone().map(|index| source(&mut Random::new(seed, index))).collect();
        for ((index, ray), answer) in indices.zip(&rays).zip(trace(&rays)) {
            tally.hit(answer.is_some());
            let excess = report.judge(oracle, ray, answer, &slack);
            if excess.is_fault() {
                tally.fault(index, || {
                    let Excess { lateral, depth } = excess;
                    let place = format!("seed {seed}, ray {index}: {lateral} of e2, {depth} of t's bound");
                    format!("{place}: {answer:?}, in truth {:?}\n{ray:?}", oracle.closest(ray))
                });
            }
        }
    });
    (tally, report)
}

fn check(name: &str, octree: &Octree<Vec<u32>>, oracle: &Oracle, source: Source<'_>, count: u64, least_hits: f64) {
    let tracer = CpuTracer::new(octree.view());
    let (tally, report) = faults(&tracer, oracle, slack(octree), source, scaled(count), 91);
    let name = format!("truth, {name}");
    println!("{name}: {}", report.line());
    tally.passes(&name, least_hits);
}

fn build(mesh: &Mesh) -> Octree<Vec<u32>> {
    Builder::new().build(mesh).expect("a mesh that builds")
}

/// Rays that start 2^-20 to 2^-8 edges above a triangle of a mesh, lead to it at 45 degrees or more, and are answered with
/// another t than the truth.
pub(crate) fn near_faults(tracer: Any<'_>, mesh: &Mesh, oracle: &Oracle, count: u64, seed: u64) -> Tally {
    tally(count, |indices, tally| {
        for index in indices {
            let random = &mut Random::new(seed, index);
            let [a, b, c] = corners(mesh, random.below(mesh.triangles.len()));
            let normal = (b - a).cross(c - a).normalize();
            let at = a.lerp(b.lerp(c, 0.5), f64::from(0.25 + 0.5 * random.unit()));
            let beside = point(random.direction()).reject_from(normal).normalize_or_zero();
            let direction = f64::from(random.unit()) * beside - normal;
            let away = (b - a).length() * (-8.0 - 12.0 * f64::from(random.unit())).exp2();
            let ray = Ray::new((at - away * direction).as_vec3().to_array(), direction.as_vec3().to_array());
            let mut hits = [Hit::MISS];
            tracer.closest_hits(&[ray], &mut hits).expect("equal lengths");
            let ([Hit { t, primitive, .. }], truth) = (hits, oracle.closest(&ray));
            tally.hit(truth.is_some());
            if oracle.judge(&ray, truth.as_ref(), t, primitive) != Verdict::Right {
                tally.fault(index, || format!("{hits:?}, in truth {truth:?}\n{}", rays::hex(&ray)));
            }
        }
    })
}

#[test]
fn short_hits_of_large_triangles_are_right() {
    let mesh = meshes::bumpy_sphere(2, 98);
    let (octree, oracle) = (build(&mesh), Oracle::new(&mesh));
    let tracer = CpuTracer::new(octree.view());
    near_faults(&tracer, &mesh, &oracle, scaled(20_000), 98).passes("short hits, truth", 0.9);
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

/// Rays at a scene in UTM coordinates whose answers are further from the truth than granted, where this mesh is traced for
/// it. Vertices and rays are rounded once, after the anchor was subtracted; the truth is of f64.
pub(crate) fn utm_faults(scene: &Utm, traced: &Mesh<f64>) -> (Tally, Report) {
    let octree = Builder::new().build(traced).expect("a mesh that builds");
    let tracer = CpuTracer::new(octree.view());
    let trace = |rays: &[RayF64]| {
        let mut hits = vec![HitF64::MISS; rays.len()];
        tracer.closest_hits_f64(rays, &mut hits).expect("equal lengths");
        hits.into_iter().map(|hit| hit.ok().map(|hit| (hit.t, hit.primitive))).collect()
    };
    let slack = Slack { anchor: Some(octree.frame().anchor), ..slack(&octree) };
    let source = |random: &mut Random| scene.ray(random);
    faults_of(trace, &Oracle::new(&scene.mesh), slack, &source, scaled(10_000), 97)
}

#[test]
fn rays_of_utm_scenes_hit_the_truth() {
    for scene in utm::all() {
        let (tally, report) = utm_faults(&scene, &scene.mesh);
        println!("truth, {}: {}", scene.name, report.line());
        tally.passes(&format!("truth, {}", scene.name), 0.2);
    }
}
