//! The backends on GPUs: both flavours of the shader on each adapter.

use leafwalk::{Hit, Octree, Work};
use leafwalk_gpu::testing::choices;
use leafwalk_gpu::{Exactness, Flavour, Gpu, GpuTracer};

use crate::backend::{Backend, Promise};
use crate::fail;

/// Opens every adapter, or the one that the environment picks.
pub(crate) fn open_all() -> Vec<Gpu> {
    let open = |choice| Gpu::open(&choice).unwrap_or_else(|error| fail(&error.to_string()));
    let devices: Vec<Gpu> = choices().into_iter().map(open).collect();
    for gpu in &devices {
        println!("{}, {}", gpu.adapter(), gpu.adapter().driver);
    }
    if devices.is_empty() {
        println!("skipped: GPUs: this machine has no adapter");
    }
    devices
}

/// An octree on each device, for each flavour.
pub(crate) fn tracers(devices: &[Gpu], octree: &Octree<Vec<u32>>) -> Vec<GpuTracer> {
    let on = |gpu, flavour| GpuTracer::on(gpu, octree, flavour).unwrap_or_else(|error| fail(&error.to_string()));
    devices.iter().flat_map(|gpu| [Flavour::Exact, Flavour::Fast].map(|flavour| on(gpu, flavour))).collect()
}

/// A device's tracer as a backend. The flavour `exact` keeps its promise where the self-test of the device says so.
pub(crate) fn backend(tracer: &GpuTracer, is_ordinary: bool) -> Backend<'_> {
    let promise = match (tracer.flavour(), tracer.exactness()) {
        (Flavour::Exact, Exactness::Exact) => Promise::Bits,
        (Flavour::Fast, _) if is_ordinary => Promise::Triangles,
        _ => Promise::Nothing,
    };
    let name = format!("{} on {}", tracer.flavour(), tracer.adapter());
    Backend::new(name, promise, tracer).counting(|rays| {
        let mut answers = vec![(Hit::MISS, Work::default()); rays.len()];
        tracer.closest_hits_with_work(rays, &mut answers).unwrap_or_else(|error| fail(&error.to_string()));
        answers.into_iter().map(|(hit, work)| (hit, work.cells)).unzip()
    })
}
