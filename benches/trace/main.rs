//! Rays a second of ours and of other tracers: the same rays, interleaved in one process, on one thread, each answer
//! judged.
//!
//! `cargo bench --bench trace [--features embree,tinybvh] [-- SCENE ...]`; LEAFWALK_SCENES names the folder of real
//! scenes, without it the default is made in code. The table is also written as CSV, to target/bench/trace.csv or where
//! LEAFWALK_BENCH_CSV says: scenes that are not measured keep their rows there, so a run may be of one scene.

mod bars;
mod builds;
mod race;
mod report;
mod table;

use std::path::{Path, PathBuf};

use clap::Parser;
use leafwalk::{Builder, Mesh};
use leafwalk_rivals::ours;
use leafwalk_testing::truth::Oracle;
use leafwalk_testing::{scenes::REAL, workloads};

use race::Judge;
use report::{Measure, Report, Row};
use table::Table;

/// Measures tracers beside each other.
#[derive(Parser)]
struct Arguments {
    /// bunny, armadillo, dragon, conference, sponza; all by default.
    scenes: Vec<String>,
    /// Only rivals with one of these in their names, comma-separated; ours run always.
    #[arg(long, value_delimiter = ',')]
    rivals: Vec<String>,
    /// Rounds of each measurement.
    #[arg(long, default_value_t = 9, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
    /// Rounds of each build; 0: none is timed.
    #[arg(long, default_value_t = 3)]
    build_rounds: u32,
    /// Primary rays are this many squared; a multiple of 8.
    #[arg(long, default_value_t = 1024, value_parser = workloads::side)]
    side: u32,
    /// Measures nothing: prints the bars from what is in the CSV.
    #[arg(long)]
    report: bool,
    /// The CSV of a run that was built with RUSTFLAGS='-C target-cpu=native', to compare ours with.
    #[arg(long, value_name = "CSV")]
    native: Option<PathBuf>,
    /// Cargo passes it.
    #[arg(long, hide = true)]
    bench: bool,
}

impl Arguments {
    fn wants(&self, rival: &str) -> bool {
        self.rivals.is_empty() || self.rivals.iter().any(|part| rival.contains(part))
    }
}

fn main() {
    let arguments = Arguments::parse();
    let native = arguments.native.as_deref().map(read);
    let path = std::env::var_os("LEAFWALK_BENCH_CSV").map_or_else(default_path, PathBuf::from);
    let mut table = if path.exists() { read(&path) } else { Table::default() };
    if !arguments.report {
        measure_all(&arguments, &path, &mut table);
    }
    bars::print(&table, native.as_ref());
}

fn read(path: &Path) -> Table {
    Table::read(path).unwrap_or_else(|error| fail(2, &format!("cannot read {}: {error}", path.display())))
}

/// Measures scene by scene, each of which is in the CSV at once.
fn measure_all(arguments: &Arguments, path: &Path, table: &mut Table) {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let build = if cfg!(target_feature = "avx2") { "for CPUs with AVX2" } else { "without flags" };
    println!("{} rounds on one thread, by CPU time; {cores} cores; built {build}", arguments.rounds);
    println!("ours / it above 1: ours is faster");
    #[cfg(feature = "embree")]
    println!("Embree {}", leafwalk_rivals::embree::version());
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    pool.install(|| {
        for (name, mesh, inside) in scenes(&arguments.scenes) {
            table.update(measure(arguments, &name, &mesh, inside).table());
            if let Err(error) = table.write(path) {
                fail(1, &format!("cannot write {}: {error}", path.display()));
            }
        }
    });
    println!("\nwritten to {}", path.display());
}

fn fail(code: i32, text: &str) -> ! {
    eprintln!("{text}");
    std::process::exit(code)
}

fn default_path() -> PathBuf {
    // Cargo runs benches in the folder of their package.
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../target/bench/trace.csv")
}

/// Real scenes by the name of their file, or a sphere where there are none.
fn scenes(names: &[String]) -> Vec<(String, Mesh, bool)> {
    for name in names {
        if !REAL.iter().any(|real| real.name.starts_with(name)) {
            fail(2, &format!("no scene is called {name}: give one of {}", REAL.map(|real| real.name).join(", ")));
        }
    }
    let mut scenes: Vec<_> = REAL
        .into_iter()
        .filter(|real| names.is_empty() || names.iter().any(|name| real.name.starts_with(name)))
        .filter_map(|real| {
            let path = leafwalk_testing::scenes::real(real.file, real.name)?;
            let mesh = leafwalk::load_mesh(&path).expect("a readable scene").mesh.into_f32();
            Some((real.name.to_string(), mesh, real.inside))
        })
        .collect();
    if scenes.is_empty() {
        scenes.push(("bumpy sphere".into(), leafwalk_testing::meshes::bumpy_sphere(6, 1), false));
    }
    scenes
}

fn measure(arguments: &Arguments, scene: &str, mesh: &Mesh, inside: bool) -> Report {
    let mut report = Report::default();
    let octree = Builder::new().build(mesh).expect("a mesh that builds");
    let compact = Builder::new().compact().build(mesh).expect("a mesh that builds");
    let triangles = mesh.triangles.len();
    let stats = octree.stats();
    println!(
        "\n{scene}: {triangles} triangles; ours: {:.2} triangles a block, {} leaves",
        triangles as f64 / f64::from(stats.blocks),
        stats.leaves
    );
    let mut tracers = ours::all(&octree, &compact);
    tracers.extend(leafwalk_rivals::all(mesh).into_iter().filter(|rival| arguments.wants(rival.name())));
    for row in builds::run(arguments.build_rounds, scene, mesh, &tracers) {
        report.add(row);
    }
    report.print(Measure::is_build);
    let oracle = Oracle::new(mesh);
    for workload in workloads::all(&octree, mesh, inside, arguments.side) {
        let rays = &workload.rays;
        let judge = Judge { truths: oracle.closest_hits(rays), oracle: &oracle, rays };
        let runs = match workload.is_occlusion {
            true => race::run(arguments.rounds, &tracers, &judge, |rival| rival.occluded(rays)),
            false => race::run(arguments.rounds, &tracers, &judge, |rival| rival.closest(rays)),
        };
        for (rival, run) in tracers.iter().zip(runs) {
            report.add(Row {
                scene: scene.into(),
                triangles,
                measure: Measure::Rays(workload.name),
                tracer: rival.name().into(),
                is_ours: rival.is_ours(),
                seconds: run.seconds,
                hits: run.hits,
                counts: run.counts,
                bytes: None,
            });
        }
        report.print(|measure| measure == Measure::Rays(workload.name));
    }
    report
}
