//! Batches of any size, in chunks: while the device traces one, the CPU prepares the next and reads the last.

use core::ops::Range;
use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

use bytemuck::Pod;
use leafwalk_core::{Clock, Frame, LengthMismatch, Ray};

use crate::chunk::{CHUNK_RAYS, pieces};
use crate::device_rays::canonical;
use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::kernel::{Kernel, Module};
use crate::ray::{DeviceAnswer, DeviceRay};

/// Chunks on their way at a time.
const IN_FLIGHT: usize = 2;
/// Smallest room for rays worth keeping.
const LEAST_ROOM: usize = 1 << 12;

/// Buffers for a chunk of rays, of `room` rays or fewer.
struct Slot {
    room: usize,
    rays: wgpu::Buffer,
    answers: wgpu::Buffer,
    staging: wgpu::Buffer,
}

impl Slot {
    fn new(gpu: &Gpu, room: usize) -> Result<Self, GpuError> {
        use wgpu::BufferUsages as Usage;
        // The longest answer there is.
        let bytes = room * size_of::<DeviceAnswer>();
        Ok(Self {
            room,
            rays: gpu.buffer("rays", room * size_of::<DeviceRay>(), Usage::STORAGE | Usage::COPY_DST)?,
            answers: gpu.buffer("answers", bytes, Usage::STORAGE | Usage::COPY_SRC)?,
            staging: gpu.buffer("staging", bytes, Usage::MAP_READ | Usage::COPY_DST)?,
        })
    }
}

/// A chunk on its way.
struct Flight {
    range: Range<usize>,
    clocks: Vec<Clock>,
    slot: Slot,
    submission: wgpu::SubmissionIndex,
}

/// Answers batches with a module's kernels.
pub(crate) struct Batch<'a> {
    pub(crate) gpu: &'a Gpu,
    pub(crate) frame: Frame,
    pub(crate) module: &'a Module,
    pub(crate) structure: &'a wgpu::BindGroup,
    pub(crate) slots: &'a Slots,
}

/// Buffers kept for the next chunk.
#[derive(Default)]
pub(crate) struct Slots(Mutex<Vec<Slot>>);

impl Slots {
    fn take(&self, gpu: &Gpu, rays: usize) -> Result<Slot, GpuError> {
        let kept = self.0.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let room = rays.next_power_of_two().max(LEAST_ROOM);
        kept.filter(|slot| slot.room >= rays).map_or_else(|| Slot::new(gpu, room), Ok)
    }

    fn put(&self, slot: Slot) {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if kept.len() < IN_FLIGHT {
            kept.push(slot);
        }
    }
}

impl Batch<'_> {
    /// Answers each ray by a kernel's answer `D` and the ray's clock.
    pub(crate) fn run<D: Pod, A>(
        &self,
        kernel: &Kernel,
        rays: &[Ray],
        answers: &mut [A],
        finish: impl Fn(D, &Clock) -> A,
    ) -> Result<(), GpuError> {
        LengthMismatch::check(rays.len(), answers.len())?;
        let mut flights = VecDeque::with_capacity(IN_FLIGHT);
        for range in pieces(rays.len(), CHUNK_RAYS) {
            if flights.len() == IN_FLIGHT {
                self.land(flights.pop_front(), answers, &finish)?;
            }
            flights.push_back(self.launch::<D>(kernel, rays, range)?);
        }
        while !flights.is_empty() {
            self.land(flights.pop_front(), answers, &finish)?;
        }
        Ok(())
    }

    fn launch<D: Pod>(&self, kernel: &Kernel, rays: &[Ray], range: Range<usize>) -> Result<Flight, GpuError> {
        let count = range.len();
        let (canonical, clocks) = canonical(&self.frame, rays[range.clone()].iter().map(|ray| Some(*ray)));
        let slot = self.slots.take(self.gpu, count)?;
        self.gpu.queue.write_buffer(&slot.rays, 0, bytemuck::cast_slice(&canonical));
        let bytes = count * size_of::<D>();
        let group = [(&slot.rays, count * size_of::<DeviceRay>()), (&slot.answers, bytes)];
        let group = self.module.bind(self.gpu, 1, &group);
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        kernel.record(&mut encoder, [self.structure, &group], count, None);
        encoder.copy_buffer_to_buffer(&slot.answers, 0, &slot.staging, 0, bytes as u64);
        let submission = self.gpu.queue.submit([encoder.finish()]);
        self.gpu.check().map(|()| Flight { range, clocks, slot, submission })
    }

    fn land<D: Pod, A>(
        &self,
        flight: Option<Flight>,
        answers: &mut [A],
        finish: impl Fn(D, &Clock) -> A,
    ) -> Result<(), GpuError> {
        let Some(Flight { range, clocks, slot, submission }) = flight else { return Ok(()) };
        let bytes = range.len() * size_of::<D>();
        self.gpu.read(&slot.staging, bytes, submission, |bytes| {
            let found = bytes.chunks_exact(size_of::<D>()).map(bytemuck::pod_read_unaligned);
            for ((answer, found), clock) in answers[range].iter_mut().zip(found).zip(&clocks) {
                *answer = finish(found, clock);
            }
        })?;
        self.slots.put(slot);
        Ok(())
    }
}
