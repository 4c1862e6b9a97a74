//! Answers that stay on the device until they are read, and the time that the device took for them.

use core::fmt;
use core::marker::PhantomData;
use core::time::Duration;
use std::sync::Arc;

use bytemuck::Pod;
use leafwalk_core::Hit;

use crate::device_rays::{Clocks, DeviceRays};
use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::kernel::Kernel;
use crate::ray::{DeviceHit, DeviceRay};
use crate::tracer::GpuTracer;

/// Closest hits on the device: `t` in units of t', `primitive` `u32::MAX` for a miss.
pub type DeviceHits = Submission<DeviceHit>;
/// One word a ray on the device: 1 where something is hit.
pub type DeviceOcclusions = Submission<u32>;

/// Answers of a batch under way, one `D` a ray.
pub struct Submission<D> {
    gpu: Gpu,
    buffers: Vec<(wgpu::Buffer, usize)>,
    clocks: Arc<Clocks>,
    timestamps: Vec<wgpu::Buffer>,
    kind: PhantomData<D>,
}

/// A time stamp before a dispatch, and one after it.
const STAMPS: u32 = 2;

impl GpuTracer {
    /// Finds the closest hits of rays on the device, and leaves them there. Does not wait.
    ///
    /// # Errors
    /// When the device has no room for the hits, or fails.
    pub fn submit(&self, rays: &DeviceRays) -> Result<DeviceHits, GpuError> {
        self.submit_to(&self.closest_hits, rays)
    }

    /// Finds whether anything is hit by rays on the device, and leaves the answers there. Does not wait.
    ///
    /// # Errors
    /// When the device has no room for the answers, or fails.
    pub fn submit_occlusions(&self, rays: &DeviceRays) -> Result<DeviceOcclusions, GpuError> {
        self.submit_to(&self.occlusions, rays)
    }

    fn submit_to<D: Pod>(&self, kernel: &Kernel, rays: &DeviceRays) -> Result<Submission<D>, GpuError> {
        let gpu = &self.gpu;
        let (mut buffers, mut timestamps) = (Vec::new(), Vec::new());
        for (rays, count) in &rays.buffers {
            let bytes = count * size_of::<D>();
            let answers = gpu.buffer("answers", bytes, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC)?;
            let group = [(rays, count * size_of::<DeviceRay>()), (&answers, bytes)];
            let group = self.module.bind(gpu, 1, &group);
            let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let stamps = gpu.stamps();
            let writes = stamps.as_ref().map(|query_set| wgpu::ComputePassTimestampWrites {
                query_set,
                beginning_of_pass_write_index: Some(0),
                end_of_pass_write_index: Some(1),
            });
            kernel.record(&mut encoder, [&self.structure, &group], *count, writes);
            if let Some(stamps) = stamps {
                let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
                let resolved = gpu.buffer("timestamps", STAMPS as usize * size_of::<u64>(), usage)?;
                encoder.resolve_query_set(&stamps, 0..STAMPS, &resolved, 0);
                timestamps.push(resolved);
            }
            gpu.queue.submit([encoder.finish()]);
            gpu.check()?;
            buffers.push((answers, *count));
        }
        let clocks = Arc::clone(&rays.clocks);
        Ok(Submission { gpu: gpu.clone(), buffers, clocks, timestamps, kind: PhantomData })
    }
}

impl<D: Pod> Submission<D> {
    /// Waits until the device is done.
    ///
    /// # Errors
    /// When the device fails.
    pub fn wait(&self) -> Result<(), GpuError> {
        self.gpu.wait(None)
    }

    /// Waits, and gives the time that the device took for the kernels alone; `None` where it cannot tell.
    ///
    /// # Errors
    /// When the device fails.
    pub fn device_time(&self) -> Result<Option<Duration>, GpuError> {
        self.wait()?;
        if self.timestamps.len() < self.buffers.len() {
            return Ok(None);
        }
        let mut ticks = 0;
        for stamps in &self.timestamps {
            if let [before, after] = self.gpu.copied::<u64>(stamps, STAMPS as usize)?[..] {
                ticks += after.saturating_sub(before);
            }
        }
        let nanoseconds = ticks as f64 * f64::from(self.gpu.queue.get_timestamp_period());
        Ok(Some(Duration::from_nanos(nanoseconds as u64)))
    }

    fn answers<A>(&self, finish: impl Fn(usize, D) -> A) -> Result<Vec<A>, GpuError> {
        let mut answers = Vec::with_capacity(self.buffers.iter().map(|(_, count)| count).sum());
        for (buffer, count) in &self.buffers {
            let found = self.gpu.copied::<D>(buffer, *count)?;
            answers.extend((answers.len()..).zip(found).map(|(number, found)| finish(number, found)));
        }
        Ok(answers)
    }
}

impl DeviceHits {
    /// The hits in the caller's units, in the order of the rays.
    ///
    /// # Errors
    /// When the device fails.
    pub fn read(&self) -> Result<Vec<Hit>, GpuError> {
        self.answers(|number, hit| hit.reported(&self.clocks.of(number)))
    }
}

impl DeviceOcclusions {
    /// The answers in the order of the rays.
    ///
    /// # Errors
    /// When the device fails.
    pub fn read(&self) -> Result<Vec<bool>, GpuError> {
        self.answers(|_, is_hit| is_hit != 0)
    }
}

impl<D> fmt::Debug for Submission<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Submission").field("gpu", &self.gpu).finish_non_exhaustive()
    }
}
