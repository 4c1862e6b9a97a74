//! The loops that everything else waits for, and whole batches beside them, on one thread.
//!
//! `cargo bench --bench kernels [-- FILTER]`; `-- --test` runs each once, to see that it does. Criterion compares with the
//! run before, whose figures are in target/criterion. Speeds of other tracers are in the bench `trace`.

mod inner;
mod whole;

use core::time::Duration;

use criterion::{BenchmarkGroup, Criterion, Throughput, measurement::WallTime};
use leafwalk::{Builder, CpuTracer, Mesh, Octree};
use leafwalk_cpu::testing;
use leafwalk_testing::meshes;
use leafwalk_testing::workloads::{self, Workload};

/// Primary rays are this many squared.
const SIDE: u32 = 128;
/// What a loop gets unless arguments say otherwise: all of them take two minutes.
const WARM_UP: Duration = Duration::from_secs(1);
const MEASUREMENT: Duration = Duration::from_secs(2);

/// What is measured on: 20,480 triangles of about equal size.
pub(crate) struct Scene {
    pub(crate) octree: Octree<Vec<u32>>,
    /// One batch of each kind of rays.
    pub(crate) workloads: Vec<Workload>,
}

impl Scene {
    fn new(mesh: &Mesh) -> Self {
        let octree = Builder::new().build(mesh).expect("a mesh that builds");
        let workloads = workloads::all(&octree, mesh, false, SIDE);
        Self { octree, workloads }
    }

    /// The tracer, in each kind of registers that this machine has.
    pub(crate) fn tracers(&self) -> Vec<(&'static str, CpuTracer<&[u32]>)> {
        testing::in_all_registers(&CpuTracer::new(self.octree.view()))
    }
}

/// A group whose speeds are elements a second.
pub(crate) fn group<'a>(criterion: &'a mut Criterion, name: &str, elements: usize) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group.throughput(Throughput::Elements(elements as u64));
    group
}

fn main() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    pool.install(|| {
        let criterion = Criterion::default().warm_up_time(WARM_UP).measurement_time(MEASUREMENT);
        let mut criterion = criterion.configure_from_args();
        let scene = Scene::new(&meshes::bumpy_sphere(5, 1));
        inner::measure(&mut criterion, &scene);
        whole::measure(&mut criterion, &scene);
        criterion.final_summary();
    });
}
