//! Rays a second of the octree and its rivals, on the same rays, interleaved in one process, one thread.
//!
//! `cargo bench --bench trace [-- SCENE ...]`; LEAFWALK_SCENES names the folder of real scenes, without it the default
//! is made in code.

mod support;

use leafwalk::{Builder, Mesh};
use leafwalk_benches::{Binary, Cwbvh, Parry, Rival, Scalar, timed};
use support::workloads::{self, Workload};

/// Rounds of each measurement; the median counts.
const ROUNDS: usize = 9;
/// Primary rays are this many squared.
const SIDE: u32 = 512;

fn main() {
    // Cargo passes `--bench`.
    let names: Vec<String> = std::env::args().skip(1).filter(|arg| !arg.starts_with('-')).collect();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    pool.install(|| {
        for (name, mesh, inside) in scenes(&names) {
            measure(&name, &mesh, inside);
        }
    });
}

/// Real scenes by the name of their file, or a sphere where there are none.
fn scenes(names: &[String]) -> Vec<(String, Mesh, bool)> {
    let files = [
        ("bunny", "bunny.ply.gz", false),
        ("armadillo", "armadillo_346k_resampled.ply.gz", false),
        ("dragon", "dragon.ply.gz", false),
        ("conference", "conference.obj.gz", true),
    ];
    let wanted = |name: &str| names.is_empty() || names.iter().any(|n| n == name);
    let mut scenes: Vec<_> = files
        .into_iter()
        .filter(|(name, ..)| wanted(name))
        .filter_map(|(name, file, inside)| {
            let path = support::scenes::real(file, name)?;
            let mesh = leafwalk::mesh_file::load(&path).expect("a readable scene").mesh;
            Some((name.to_string(), mesh, inside))
        })
        .collect();
    if scenes.is_empty() {
        scenes.push(("bumpy sphere".into(), support::meshes::bumpy_sphere(6, 1), false));
    }
    scenes
}

fn measure(name: &str, mesh: &Mesh, inside: bool) {
    let octree = Builder::new().build(mesh).expect("a mesh that builds");
    let workloads = workloads::all(&octree, mesh, inside, SIDE);
    let bytes = size_of_val(octree.as_words()) as f64 / mesh.triangles.len() as f64;
    let stats = octree.stats();
    println!(
        "\n{name}: {} triangles, {bytes:.1} bytes a triangle, {:.2} references a triangle, {} leaves",
        mesh.triangles.len(),
        f64::from(stats.references) / mesh.triangles.len() as f64,
        stats.leaves
    );
    builds(mesh);
    let rivals: [Box<dyn Rival + '_>; 4] = [
        Box::new(Scalar(octree.view())),
        Box::new(Cwbvh::new(mesh)),
        Box::new(Binary::new(mesh)),
        Box::new(Parry::new(mesh)),
    ];
    println!("{:>4} {:>20} {:>9} {:>9} {:>9}", "", "", "Mrays/s", "hit share", "ours / it");
    for workload in &workloads {
        race(workload, &rivals);
    }
}

/// Build time on one thread, beside parry3d's.
fn builds(mesh: &Mesh) {
    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    for _ in 0..3 {
        ours.push(timed(|| Builder::new().build(mesh).is_ok()).1.as_secs_f64());
        theirs.push(timed(|| Parry::new(mesh)).1.as_secs_f64());
    }
    let (ours, theirs) = (median(&mut ours), median(&mut theirs));
    println!("build: {ours:.3} s, parry3d {theirs:.3} s, ratio {:.2}", ours / theirs);
}

fn race(workload: &Workload, rivals: &[Box<dyn Rival + '_>]) {
    let mut times = vec![Vec::new(); rivals.len()];
    let mut hits = vec![0; rivals.len()];
    for _ in 0..ROUNDS {
        for (i, rival) in rivals.iter().enumerate() {
            let trace = || match workload.is_occlusion {
                true => rival.occluded(&workload.rays),
                false => rival.closest(&workload.rays),
            };
            let (count, time) = timed(trace);
            hits[i] = count;
            times[i].push(time.as_secs_f64());
        }
    }
    let rays = workload.rays.len() as f64;
    let medians: Vec<f64> = times.iter_mut().map(|times| median(times)).collect();
    for (i, rival) in rivals.iter().enumerate() {
        println!(
            "{:>4} {:>20} {:>9.3} {:>9.5} {:>9.2}",
            workload.name,
            rival.name(),
            rays / medians[i] / 1e6,
            hits[i] as f64 / rays,
            medians[i] / medians[0]
        );
    }
}

fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
