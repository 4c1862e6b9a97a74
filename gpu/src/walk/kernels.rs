//! `WalkKernels`: an octree on a device with the kernels that walk it.

use leafwalk_core::{Frame, Octree};

use super::octree;
use super::ray::DeviceRay;
use crate::device::{Gpu, Kernel, Module};
use crate::error::GpuError;
use crate::shader::{self, Arithmetic, WordBindings};

/// An octree on a device with the kernels that walk it.
pub(crate) struct WalkKernels {
    pub(crate) gpu: Gpu,
    pub(crate) frame: Frame,
    module: Module,
    octree: wgpu::BindGroup,
    pub(crate) closest_hits: Kernel,
    pub(crate) occlusions: Kernel,
    pub(crate) closest_hits_with_work: Kernel,
}

impl WalkKernels {
    /// Compiles the kernels and uploads the octree, in storage buffers of at most `binding_bytes` each.
    pub(crate) fn new<W: AsRef<[u32]>>(
        gpu: &Gpu,
        octree: &Octree<W>,
        arithmetic: Arithmetic,
        binding_bytes: u64,
    ) -> Result<Self, GpuError> {
        if octree.is_compact() {
            return Err(GpuError::CompactOctree);
        }
        let bytes = size_of_val(octree.as_words()) as u64;
        let words = WordBindings::new(bytes, binding_bytes).map_err(|most| GpuError::OctreeTooLarge { bytes, most })?;
        let module = Module::new(gpu, "tracing", &shader::tracing(arithmetic, words), words.count)?;
        let flag = |flag: bool| f64::from(u8::from(flag));
        let is_wide = flag(!octree.lattices().is_empty());
        let kernel = |name, any_hit| module.kernel(gpu, name, &[("ANY_HIT", flag(any_hit)), ("IS_WIDE", is_wide)]);
        let closest_hits = kernel("closest_hits", false)?;
        let occlusions = kernel("occlusions", true)?;
        let closest_hits_with_work = kernel("closest_hits_with_work", false)?;
        let frame = octree.parts().frame;
        let octree = octree::upload(gpu, octree, words, &module)?;
        gpu.check()?;
        Ok(Self { gpu: gpu.clone(), frame, module, octree, closest_hits, occlusions, closest_hits_with_work })
    }

    /// Records the walks of the first `count` rays of a buffer, whose answers of `answer_bytes` each go into another.
    pub(crate) fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        kernel: &Kernel,
        rays: &wgpu::Buffer,
        answers: &wgpu::Buffer,
        (count, answer_bytes): (usize, usize),
        timestamps: Option<wgpu::ComputePassTimestampWrites<'_>>,
    ) {
        let buffers = [(rays, count * size_of::<DeviceRay>()), (answers, count * answer_bytes)];
        let group = self.module.bind(&self.gpu, 1, &buffers);
        kernel.record(encoder, [&self.octree, &group], count, timestamps);
    }
}
