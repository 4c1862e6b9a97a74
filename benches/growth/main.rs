//! How ours and Embree grow with the mesh: time a ray, bytes and build time a triangle, from a thousand triangles to
//! more than ten million, on one thread, interleaved.
//!
//! `cargo bench --bench growth [--features embree] [-- --out docs]`; the mesh is the dragon of LEAFWALK_SCENES, coarser
//! and finer ([`sizes`]), or a sphere made in code. Writes growth.csv and growth.svg.

mod chart;
mod sizes;

use std::path::{Path, PathBuf};

use clap::Parser;
use leafwalk::{Builder, Mesh};
use leafwalk_rivals::{Prepared, Rival, ours, timed};
use leafwalk_testing::{meshes, scenes, workloads};

/// Primary rays are this many squared.
const SIDE: u32 = 512;
/// Builds of a structure that are timed.
const BUILDS: u32 = 3;
/// Above so many triangles one build is timed: noise is small, and memory for another structure large.
const MANY: usize = 2_000_000;

/// Measures sizes of one mesh.
#[derive(Parser)]
struct Arguments {
    /// The folder to write to, from the root of the repository.
    #[arg(long, default_value = "target/bench")]
    out: PathBuf,
    /// Sizes above so many triangles are left out.
    #[arg(long, default_value_t = usize::MAX)]
    most: usize,
    /// Rounds of each measurement.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
    /// Cargo passes it.
    #[arg(long, hide = true)]
    bench: bool,
}

/// What is measured, and of which unit, in the order of the chart.
pub(crate) const MEASURES: [(&str, &str); 6] = [
    ("primary rays", "ns a ray"),
    ("shadow rays", "ns a ray"),
    ("bounce rays", "ns a ray"),
    ("random rays", "ns a ray"),
    ("memory", "bytes a triangle"),
    ("build", "ns a triangle"),
];

/// One measure at one size.
pub(crate) struct Point {
    pub(crate) triangles: usize,
    pub(crate) measure: &'static str,
    unit: &'static str,
    pub(crate) ours: f64,
    /// Embree's smallest, and the way to call it.
    pub(crate) embree: Option<(f64, String)>,
}

fn main() {
    let arguments = Arguments::parse();
    let mesh = scenes::real("dragon.ply.gz", "the dragon, for a sphere").map_or_else(
        || meshes::bumpy_sphere(7, 1),
        |path| leafwalk::load_mesh(&path).expect("a readable scene").mesh.into_f32(),
    );
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    let sizes = sizes::all(&mesh).take_while(|mesh| mesh.triangles.len() <= arguments.most);
    let points: Vec<Point> = pool.install(|| sizes.flat_map(|mesh| measure(&mesh, arguments.rounds)).collect());
    // Cargo runs benches in the folder of their package.
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(&arguments.out);
    std::fs::create_dir_all(&folder).expect("a folder to write to");
    let (csv, svg) = (folder.join("growth.csv"), folder.join("growth.svg"));
    std::fs::write(&csv, table(&points)).expect("a folder to write to");
    chart::draw(&points, &svg).expect("a folder to write to");
    println!("written to {} and {}", csv.display(), svg.display());
}

fn measure(mesh: &Mesh, rounds: u32) -> Vec<Point> {
    let triangles = mesh.triangles.len();
    let octree = Builder::new().build(mesh).expect("a mesh that builds");
    #[allow(unused_mut, reason = "features add to it")]
    let mut tracers = vec![ours::default(&octree)];
    #[cfg(feature = "embree")]
    tracers.extend(leafwalk_rivals::embree::all(mesh, &leafwalk_rivals::embree::SETTINGS[..1]));
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for workload in workloads::all(&octree, mesh, false, SIDE) {
        let seconds = match workload.is_occlusion {
            true => race(rounds, &tracers, |rival| rival.occluded(&workload.rays)),
            false => race(rounds, &tracers, |rival| rival.closest(&workload.rays)),
        };
        rows.push(seconds.into_iter().map(|seconds| 1e9 * seconds / workload.rays.len() as f64).collect());
    }
    let a_triangle = |rival: &dyn Rival| rival.bytes().map_or(f64::NAN, |bytes| bytes as f64 / triangles as f64);
    rows.push(tracers.iter().map(|rival| a_triangle(&**rival)).collect());
    let builds = if triangles > MANY { 1 } else { BUILDS };
    let build = |rival: &dyn Rival| {
        let seconds: Vec<f64> = (0..builds).filter_map(|_| Some(rival.rebuild(mesh)?.as_secs_f64())).collect();
        1e9 * median(seconds) / triangles as f64
    };
    rows.push(tracers.iter().map(|rival| build(&**rival)).collect());
    let point = |((measure, unit), values): ((&'static str, &'static str), Vec<f64>)| {
        let embree = tracers.iter().zip(&values).filter(|(rival, value)| !rival.is_ours() && !value.is_nan());
        let embree = embree.min_by(|a, b| a.1.total_cmp(b.1)).map(|(rival, value)| (*value, rival.name().into()));
        Point { triangles, measure, unit, ours: values[0], embree }
    };
    let points: Vec<Point> = MEASURES.into_iter().zip(rows).map(point).collect();
    print!("{}", points.iter().map(|point| line(point) + "\n").collect::<String>());
    points
}

/// The median seconds of each tracer.
fn race<'a, A>(
    rounds: u32,
    tracers: &'a [Box<dyn Rival + '_>],
    prepare: impl Fn(&'a dyn Rival) -> Box<dyn Prepared<A> + 'a>,
) -> Vec<f64> {
    let mut prepared: Vec<_> = tracers.iter().map(|rival| prepare(&**rival)).collect();
    let mut seconds = vec![Vec::new(); tracers.len()];
    // The first round warms up.
    for round in 0..=rounds {
        for (batch, seconds) in prepared.iter_mut().zip(&mut seconds) {
            batch.reset();
            let ((), time) = timed(|| batch.trace());
            seconds.extend((round > 0).then_some(time.as_secs_f64()));
        }
    }
    seconds.into_iter().map(median).collect()
}

/// NaN of nothing.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

fn table(points: &[Point]) -> String {
    let head = "triangles,measure,unit,leafwalk,embree,embree_way".to_string();
    core::iter::once(head).chain(points.iter().map(line)).map(|line| line + "\n").collect()
}

fn line(point: &Point) -> String {
    let Point { triangles, measure, unit, ours, embree } = point;
    let (value, way) =
        embree.as_ref().map_or_else(Default::default, |(value, way)| (format!("{value:.1}"), way.as_str()));
    format!("{triangles},{measure},{unit},{ours:.1},{value},{way}")
}
