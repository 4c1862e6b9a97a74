//! Rays a second of our shader in both flavours, and of a compressed wide BVH on the same adapter: the same rays,
//! interleaved in one process, by the device's timestamps, each answer compared with the CPU's.
//!
//! `cargo bench --bench gpu --features gpu [-- MESH ...]`; the program that `--no-run` names can be carried to another
//! machine, and needs nothing there but the driver and the meshes. The table is also written as CSV, to
//! target/bench/gpu.csv or where LEAFWALK_BENCH_CSV says.

mod contender;
mod cwbvh;
mod judge;
mod report;

use std::path::PathBuf;

use clap::Parser;
use leafwalk::{Builder, Hit, Mesh, Octree, Ray, Work};
use leafwalk_gpu::{AdapterChoice, AdapterKind, Flavour, Gpu, GpuTracer, SelfTest};
use leafwalk_testing::{meshes, scenes, workloads};

use contender::{Contender, Ours};
use cwbvh::Cwbvh;
use judge::Judge;
use report::{EXACT, FAST, Report, Row};

/// Rays of each kind whose cells and blocks are counted.
const COUNTED: usize = 1 << 16;

/// Measures kernels beside each other.
#[derive(Parser)]
struct Arguments {
    /// Meshes seen from outside; without any, those of LEAFWALK_SCENES, or a sphere.
    meshes: Vec<PathBuf>,
    /// A mesh seen from inside, such as a room.
    #[arg(long, value_name = "MESH")]
    inside: Vec<PathBuf>,
    /// auto, software, or a part of an adapter's name; by default what LEAFWALK_ADAPTER says, else auto.
    #[arg(long)]
    adapter: Option<String>,
    /// A frame's primary rays are this many squared; a multiple of 8.
    #[arg(long, default_value_t = 1024, value_parser = workloads::side)]
    side: u32,
    /// A batch's likewise: 16 M rays, or on software adapters none, unless told otherwise.
    #[arg(long, value_parser = workloads::side)]
    batch_side: Option<u32>,
    /// Rounds of each measurement: 9, or on software adapters, whose speed says nothing, none unless told otherwise.
    #[arg(long)]
    rounds: Option<u32>,
    /// Cost of a step over that of a triangle test, for the octree: lower makes smaller leaves. By default as suits walks.
    #[arg(long)]
    step_cost: Option<f32>,
    /// Cargo passes it.
    #[arg(long, hide = true)]
    bench: bool,
}

/// A batch of 16 M primary rays.
const BATCH_SIDE: u32 = 4096;
/// On hardware.
const ROUNDS: u32 = 9;

fn main() {
    let arguments = Arguments::parse();
    let choice = arguments.adapter.clone().map_or_else(AdapterChoice::from_environment, AdapterChoice::from);
    let gpu = Gpu::open(&choice).unwrap_or_else(|error| fail(&error.to_string()));
    let adapter = gpu.adapter();
    println!("{adapter}, {}; wgpu tells no registers, occupancy or cache hits", adapter.driver);
    for flavour in [Flavour::Exact, Flavour::Fast] {
        println!("self-test, {flavour}: {}", SelfTest::of(&gpu, flavour).expect("a working device"));
    }
    let is_software = adapter.kind == AdapterKind::Software;
    let rounds = arguments.rounds.unwrap_or(if is_software { 0 } else { ROUNDS });
    let clock = if adapter.has_timestamps { "the device's timestamps" } else { "the clock on the wall" };
    let kind = if is_software { "a software adapter, whose speed says nothing; " } else { "" };
    println!("{kind}{rounds} rounds, by {clock}");
    println!(
        "wrong: against the CPU's answer. bits: answers that differ from it in any. exact/it above 1: ours is faster"
    );
    let frame = Some(("frame", arguments.side));
    let batch = arguments.batch_side.or((!is_software).then_some(BATCH_SIDE)).map(|side| ("batch", side));
    let sizes: Vec<(&str, u32)> = frame.into_iter().chain(batch).collect();
    let path = std::env::var_os("LEAFWALK_BENCH_CSV").map_or_else(default_path, PathBuf::from);
    let mut report = Report::new(adapter.to_string());
    let builder = arguments.step_cost.map_or_else(Builder::for_walks, |cost| Builder::new().step_cost(cost));
    for (name, mesh, inside) in all_scenes(&arguments) {
        let scene = Scene { octree: builder.build(&mesh).expect("a mesh that builds"), name, mesh, inside };
        measure(&gpu, &scene, &sizes, rounds, &mut report);
        if let Err(error) = report.write(&path) {
            fail(&format!("cannot write {}: {error}", path.display()));
        }
    }
    println!("\nwritten to {}", path.display());
}

fn fail(text: &str) -> ! {
    eprintln!("{text}");
    std::process::exit(1)
}

fn default_path() -> PathBuf {
    // Cargo runs benches in the folder of their package.
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../target/bench/gpu.csv")
}

/// Names, meshes, and whether they are seen from inside.
fn all_scenes(arguments: &Arguments) -> Vec<(String, Mesh, bool)> {
    let outside = arguments.meshes.iter().map(|path| (path.clone(), false));
    let mut files: Vec<_> = outside.chain(arguments.inside.iter().map(|path| (path.clone(), true))).collect();
    if files.is_empty() {
        let real = [("bunny.ply.gz", false), ("dragon.ply.gz", false), ("conference.obj.gz", true)];
        files = real.into_iter().filter_map(|(file, inside)| Some((scenes::real(file, file)?, inside))).collect();
    }
    if files.is_empty() {
        return vec![("bumpy sphere".into(), meshes::bumpy_sphere(6, 1), false)];
    }
    let load = |(path, inside): (PathBuf, bool)| {
        let loaded = leafwalk::load_mesh(&path);
        let mesh = loaded.unwrap_or_else(|error| fail(&format!("{}: {error}", path.display()))).mesh.into_f32();
        (scenes::name_of(&path), mesh, inside)
    };
    files.into_iter().map(load).collect()
}

struct Scene {
    name: String,
    mesh: Mesh,
    inside: bool,
    octree: Octree<Vec<u32>>,
}

fn measure(gpu: &Gpu, scene: &Scene, sizes: &[(&str, u32)], rounds: u32, report: &mut Report) {
    let Scene { name, mesh, inside, octree } = scene;
    let [exact, fast] = [Flavour::Exact, Flavour::Fast]
        .map(|flavour| GpuTracer::on(gpu, octree, flavour).unwrap_or_else(|error| fail(&error.to_string())));
    let cwbvh = Cwbvh::new(mesh, &gpu.adapter().to_string());
    println!("\n{name}: {} triangles", mesh.triangles.len());
    Report::print_head();
    for (size, side) in sizes {
        for workload in workloads::all(octree, mesh, *inside, *side) {
            let on_device = exact.upload(&workload.rays).expect("room on the device");
            let mut contenders: [Box<dyn Contender>; 3] = [
                Box::new(Ours::new(EXACT, &exact, &on_device, workload.is_occlusion)),
                Box::new(Ours::new(FAST, &fast, &on_device, workload.is_occlusion)),
                cwbvh.contender(&workload.rays, workload.is_occlusion),
            ];
            let judge = Judge::new(octree, &workload);
            let times = race(&mut contenders, rounds);
            for (contender, times) in contenders.iter().zip(times) {
                let found = contender.answers();
                let is_ours = contender.name() != report::CWBVH;
                report.add(Row {
                    scene: name.clone(),
                    triangles: mesh.triangles.len(),
                    rays_of: format!("{} {size}", workload.name),
                    tracer: contender.name(),
                    times,
                    rays: workload.rays.len(),
                    hits: found.iter().filter(|hit| !hit.is_miss()).count(),
                    wrong: judge.wrong(&found),
                    differing: is_ours.then(|| judge.differing(&found)),
                    bytes: if is_ours { size_of_val(octree.as_words()) } else { cwbvh.bytes() },
                });
            }
            report.print_last(contenders.len());
            print_work(&exact, &workload.rays);
        }
    }
}

/// Times of each contender, one a round, in turns.
fn race(contenders: &mut [Box<dyn Contender + '_>], rounds: u32) -> Vec<Vec<core::time::Duration>> {
    // The round that warms up, and whose answers are compared where there is no other.
    for contender in &mut *contenders {
        contender.trace();
    }
    let mut times = vec![Vec::new(); contenders.len()];
    for _ in 0..rounds {
        for (contender, times) in contenders.iter_mut().zip(&mut times) {
            times.push(contender.trace());
        }
    }
    times
}

/// What rays take, on average over some.
fn print_work(tracer: &GpuTracer, rays: &[Ray]) {
    let some: Vec<Ray> = rays.iter().step_by(rays.len().div_ceil(COUNTED).max(1)).copied().collect();
    let mut answers = vec![(Hit::MISS, Work::default()); some.len()];
    tracer.closest_hits_with_work(&some, &mut answers).expect("a working device");
    let mean = |of: fn(&Work) -> u32| {
        answers.iter().map(|(_, work)| f64::from(of(work))).sum::<f64>() / some.len().max(1) as f64
    };
    println!(
        "{:>8} closest hits: {:.1} cells, {:.1} blocks a ray",
        "",
        mean(|work| work.cells),
        mean(|work| work.blocks)
    );
}
