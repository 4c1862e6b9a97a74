//! `Submission`: answers that stay on the device until they are read, and the time that the device took for them.

use core::fmt;
use core::marker::PhantomData;
use core::time::Duration;
use std::sync::Arc;

use bytemuck::Pod;
use leafwalk_core::Hit;

use super::rays::{Clocks, DeviceRays};
use crate::device::{DeviceError, Gpu, Kernel};
use crate::error::GpuError;
use crate::walk::{DeviceHit, WalkKernels};

/// A time stamp before a dispatch, and one after it.
const STAMPS: u32 = 2;

/// The answers to rays on the device, one `A` a ray, under way or done.
pub struct Submission<A> {
    gpu: Gpu,
    /// Each with the number of its answers.
    buffers: Vec<(wgpu::Buffer, usize)>,
    clocks: Arc<Clocks>,
    /// The two stamps of each buffer, where the device has any.
    timestamps: Vec<wgpu::Buffer>,
    answer: PhantomData<fn() -> A>,
}

/// Closest hits on the device.
pub type DeviceHits = Submission<Hit>;
/// Whether anything is hit, on the device.
pub type DeviceOcclusions = Submission<bool>;

/// What the kernel `occlusions` writes: 1 where anything is hit.
type DeviceOcclusion = u32;

impl Submission<Hit> {
    pub(crate) fn closest_hits(kernels: &WalkKernels, rays: &DeviceRays) -> Result<Self, GpuError> {
        Self::submit(kernels, &kernels.closest_hits, rays, size_of::<DeviceHit>())
    }

    /// Waits for the hits, and gives them in the caller's units, in the order of the rays.
    ///
    /// # Errors
    /// When the device fails.
    pub fn read(&self) -> Result<Vec<Hit>, GpuError> {
        self.answers(|number, hit: DeviceHit| hit.reported(&self.clocks.of(number)))
    }
}

impl Submission<bool> {
    pub(crate) fn occlusions(kernels: &WalkKernels, rays: &DeviceRays) -> Result<Self, GpuError> {
        Self::submit(kernels, &kernels.occlusions, rays, size_of::<DeviceOcclusion>())
    }

    /// Waits for the answers, and gives them in the order of the rays.
    ///
    /// # Errors
    /// When the device fails.
    pub fn read(&self) -> Result<Vec<bool>, GpuError> {
        self.answers(|_, is_hit: DeviceOcclusion| is_hit != 0)
    }
}

impl<A> Submission<A> {
    fn submit(
        kernels: &WalkKernels,
        kernel: &Kernel,
        rays: &DeviceRays,
        answer_bytes: usize,
    ) -> Result<Self, GpuError> {
        let gpu = &kernels.gpu;
        if !rays.belongs_to(gpu, &kernels.frame) {
            return Err(GpuError::ForeignRays);
        }
        let (mut buffers, mut timestamps) = (Vec::new(), Vec::new());
        for (rays, count) in &rays.buffers {
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
            let answers = gpu.buffer("answers", count * answer_bytes, usage)?;
            let stamps = Stamps::new(gpu)?;
            gpu.submit(|encoder| {
                let writes = stamps.as_ref().map(Stamps::writes);
                kernels.record(encoder, kernel, rays, &answers, (*count, answer_bytes), writes);
                if let Some(Stamps { set, resolved }) = &stamps {
                    encoder.resolve_query_set(set, 0..STAMPS, resolved, 0);
                }
            })?;
            timestamps.extend(stamps.map(|stamps| stamps.resolved));
            buffers.push((answers, *count));
        }
        let clocks = Arc::clone(&rays.clocks);
        Ok(Self { gpu: gpu.clone(), buffers, clocks, timestamps, answer: PhantomData })
    }

    /// Waits until the device is done.
    ///
    /// # Errors
    /// When the device fails.
    pub fn wait(&self) -> Result<(), GpuError> {
        Ok(self.gpu.wait(None)?)
    }

    /// Waits, and gives the time that the device took for the kernels alone; `None` where the device cannot tell.
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

    /// The answers in the order of the rays: `finish` makes each of the ray's number and what the kernel gave.
    fn answers<D: Pod>(&self, finish: impl Fn(usize, D) -> A) -> Result<Vec<A>, GpuError> {
        let mut answers = Vec::with_capacity(self.buffers.iter().map(|(_, count)| count).sum());
        for (buffer, count) in &self.buffers {
            let found = self.gpu.copied::<D>(buffer, *count)?;
            answers.extend((answers.len()..).zip(found).map(|(number, found)| finish(number, found)));
        }
        Ok(answers)
    }
}

/// The time stamps of a dispatch, and the buffer from which they are read.
struct Stamps {
    set: wgpu::QuerySet,
    resolved: wgpu::Buffer,
}

impl Stamps {
    /// `None` where the device has no time stamps.
    fn new(gpu: &Gpu) -> Result<Option<Self>, DeviceError> {
        let Some(set) = gpu.timestamps(STAMPS) else { return Ok(None) };
        let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        let resolved = gpu.buffer("timestamps", STAMPS as usize * size_of::<u64>(), usage)?;
        Ok(Some(Self { set, resolved }))
    }

    fn writes(&self) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.set,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: Some(1),
        }
    }
}

impl<A> fmt::Debug for Submission<A> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Submission").field("gpu", &self.gpu).finish_non_exhaustive()
    }
}
