//! Whether every backend gives the same bits: each scene, each kind of rays, each way to trace them, beside the scalar walk.
//!
//! `cargo bench --bench equivalence [--features gpu] [-- MESH ...]`; without a mesh, the scenes are made in code. Paths are
//! absolute, since Cargo runs benches in the folder of their package. With the feature, every adapter traces in both
//! flavours, or the one that LEAFWALK_ADAPTER picks. Ends with exit code 1 where an answer differs that docs/contract.md
//! promises; `--flip` breaks a bit, to see that it does.

mod backend;
mod cpu;
#[cfg(feature = "gpu")]
mod gpu;
mod report;
mod scene;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use leafwalk_testing::workloads;

use backend::{Backend, Pools};
use cpu::Tracers;
use report::Report;
use scene::{Expected, Scene};

/// Compares backends, bit by bit.
#[derive(Parser)]
struct Arguments {
    /// Meshes seen from outside.
    meshes: Vec<PathBuf>,
    /// A mesh seen from inside, such as a room.
    #[arg(long, value_name = "MESH")]
    inside: Vec<PathBuf>,
    /// Rays of each kind are at most this many squared; a multiple of 8.
    #[arg(long, default_value_t = 96, value_parser = workloads::side)]
    side: u32,
    /// Flips a bit of a hit of the first backend whose name contains this: the bench must fail.
    #[arg(long, value_name = "BACKEND")]
    flip: Option<String>,
    /// Cargo passes it.
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let pools = Pools::new();
    #[cfg(feature = "gpu")]
    let devices = gpu::open_all();
    let mut report = Report::default();
    for scene in Scene::all(&arguments.meshes, &arguments.inside) {
        report.start(&scene);
        let tracers = Tracers::new(&scene);
        #[cfg(feature = "gpu")]
        let on_gpus = gpu::tracers(&devices, &scene.octree);
        #[allow(unused_mut, reason = "features add to it")]
        let mut backends = tracers.backends();
        #[cfg(feature = "gpu")]
        backends.extend(on_gpus.iter().map(|tracer| gpu::backend(tracer, scene.is_ordinary)));
        if let Some(name) = &arguments.flip {
            flip(&mut backends, name);
        }
        for workload in scene.workloads(arguments.side) {
            let expected = Expected::new(&scene.octree, &workload.rays);
            for backend in &backends {
                report.add(backend, backend.compare(&pools, &workload, &expected));
            }
        }
    }
    report.print_summary();
    ExitCode::from(u8::from(report.has_breaks()))
}

/// Spoils the first backend whose name contains a text.
fn flip(backends: &mut Vec<Backend<'_>>, name: &str) {
    let Some(at) = backends.iter().position(|backend| backend.name.contains(name)) else {
        let names: Vec<&str> = backends.iter().map(|backend| &*backend.name).collect();
        fail(&format!("no backend is called '{name}'; there are: {}", names.join("; ")));
    };
    let spoiled = backends.remove(at).flipped();
    backends.insert(at, spoiled);
}

/// Ends with another exit code than that of a difference.
fn fail(text: &str) -> ! {
    eprintln!("{text}");
    std::process::exit(2)
}
