//! Doors for this project's own tests: mutants of the shaders, texts, and what the device holds. No part of the public
//! interface, and free to change in any release.

use leafwalk_core::Octree;

use crate::device::{AdapterChoice, DeviceError, Gpu, MapKernel, SelfTest, adapters};
use crate::error::GpuError;
use crate::flavour::Flavour;
use crate::resident::DeviceRays;
use crate::tracer::GpuTracer;

pub use crate::device::MapSetup;
pub use crate::shader::{Arithmetic, MOST_BINDINGS, WordBindings, checks, generating, tracing};
pub use crate::walk::{DeviceAnswer, DeviceHit, DeviceRay, OctreeSetup};

/// What tests open: every adapter by its full name, or what the environment asks for.
pub fn choices() -> Vec<AdapterChoice> {
    if std::env::var_os(AdapterChoice::VARIABLE).is_some() {
        return vec![AdapterChoice::from_environment()];
    }
    adapters().into_iter().map(|adapter| AdapterChoice::Name(adapter.to_string())).collect()
}

/// A tracer of the flavour `exact` without its guards.
pub fn unguarded_tracer<W: AsRef<[u32]>>(gpu: &Gpu, octree: &Octree<W>) -> Result<GpuTracer, GpuError> {
    let binding_bytes = gpu.device.limits().max_storage_buffer_binding_size;
    GpuTracer::with_arithmetic(gpu, octree, Flavour::Exact, Arithmetic::Unguarded, binding_bytes)
}

/// A tracer of the flavour `exact` with bindings of at most `binding_bytes`, for octrees that need several.
pub fn split_tracer<W: AsRef<[u32]>>(gpu: &Gpu, octree: &Octree<W>, binding_bytes: u64) -> Result<GpuTracer, GpuError> {
    GpuTracer::with_arithmetic(gpu, octree, Flavour::Exact, Arithmetic::Exact, binding_bytes)
}

/// What the device makes of the arithmetic of a text like those of [`checks`], for tests that spoil it.
pub fn self_test_of(gpu: &Gpu, checks: &str) -> Result<SelfTest, DeviceError> {
    SelfTest::of_text(gpu, checks)
}

/// Every entry of the tables as the device reads them: exit faces, then sub-faces.
pub fn table_entries(gpu: &Gpu) -> Result<Vec<u32>, DeviceError> {
    const ENTRIES: usize = (8 + 6) * 8;
    let kernel = MapKernel::compile(gpu, &checks(Arithmetic::Exact), "table_entries")?;
    gpu.copied(&kernel.run(gpu, &[], 0, (ENTRIES, size_of::<u32>()))?, ENTRIES)
}

/// The rays as the device has them.
pub fn rays_on_device(rays: &DeviceRays) -> Result<Vec<DeviceRay>, DeviceError> {
    rays.read()
}

/// Loses the device, as if it were unplugged.
pub fn lose(gpu: &Gpu) {
    gpu.device.destroy();
}
