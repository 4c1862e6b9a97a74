//! `Batch`: the answers to any number of rays, in chunks. While the device traces one chunk, the CPU makes the rays of the
//! next one canonical and reads the answers to the last.
//!
//! ```text
//! for each chunk of 2^20 rays:
//!     if two chunks are under way:
//!         wait for the older one, and copy its answers out
//!     make the rays canonical, in f64 where f32 does not give the same bits
//!     take buffers from the pool, write the rays, and submit the walk and the copy of its answers
//! wait for the chunks that are under way, and copy their answers out
//! ```

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

use bytemuck::Pod;
use leafwalk_core::{Clock, LengthMismatch, Ray};

use crate::device::{DeviceError, Gpu, Kernel};
use crate::error::GpuError;
use crate::walk::{DeviceAnswer, DeviceRay, WalkKernels, canonical};

/// Rays of a chunk: 32 MiB of them, so that copies overlap with tracing and nothing waits long.
const CHUNK_RAYS: usize = 1 << 20;
/// Chunks that are under way at a time: one is traced while the next one is written.
const CHUNKS_UNDER_WAY: usize = 2;
/// Rays that the smallest buffers worth keeping have room for.
const LEAST_ROOM: usize = 1 << 12;

/// The buffers of a chunk of up to `room` rays.
struct ChunkBuffers {
    room: usize,
    rays: wgpu::Buffer,
    answers: wgpu::Buffer,
    staging: wgpu::Buffer,
}

impl ChunkBuffers {
    fn new(gpu: &Gpu, room: usize) -> Result<Self, DeviceError> {
        use wgpu::BufferUsages as Usage;
        // The longest answer that there is.
        let bytes = room * size_of::<DeviceAnswer>();
        Ok(Self {
            room,
            rays: gpu.buffer("rays", room * size_of::<DeviceRay>(), Usage::STORAGE | Usage::COPY_DST)?,
            answers: gpu.buffer("answers", bytes, Usage::STORAGE | Usage::COPY_SRC)?,
            staging: gpu.buffer("staging", bytes, Usage::MAP_READ | Usage::COPY_DST)?,
        })
    }
}

/// Buffers that are kept for the next chunks.
#[derive(Default)]
pub(crate) struct BufferPool(Mutex<Vec<ChunkBuffers>>);

impl BufferPool {
    fn take(&self, gpu: &Gpu, rays: usize) -> Result<ChunkBuffers, DeviceError> {
        let kept = self.0.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let room = rays.next_power_of_two().max(LEAST_ROOM);
        kept.filter(|buffers| buffers.room >= rays).map_or_else(|| ChunkBuffers::new(gpu, room), Ok)
    }

    fn put(&self, buffers: ChunkBuffers) {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if kept.len() < CHUNKS_UNDER_WAY {
            kept.push(buffers);
        }
    }
}

/// A chunk that is under way, and where its answers go.
struct PendingChunk<'a, A> {
    answers: &'a mut [A],
    clocks: Vec<Clock>,
    buffers: ChunkBuffers,
    submission: wgpu::SubmissionIndex,
}

/// Answers batches of rays with the kernels of an octree.
pub(crate) struct Batch<'a> {
    pub(crate) kernels: &'a WalkKernels,
    pub(crate) pool: &'a BufferPool,
}

impl Batch<'_> {
    /// Answers each ray: `finish` makes the answer of what the kernel gives, a `D`, and of the ray's clock.
    pub(crate) fn run<D: Pod, A>(
        &self,
        kernel: &Kernel,
        rays: &[Ray],
        answers: &mut [A],
        finish: impl Fn(D, &Clock) -> A,
    ) -> Result<(), GpuError> {
        LengthMismatch::check(rays.len(), answers.len())?;
        let mut pending = VecDeque::with_capacity(CHUNKS_UNDER_WAY);
        for (rays, answers) in rays.chunks(CHUNK_RAYS).zip(answers.chunks_mut(CHUNK_RAYS)) {
            if pending.len() == CHUNKS_UNDER_WAY
                && let Some(oldest) = pending.pop_front()
            {
                self.finish(oldest, &finish)?;
            }
            pending.push_back(self.submit::<D, A>(kernel, rays, answers)?);
        }
        pending.into_iter().try_for_each(|chunk| self.finish(chunk, &finish))?;
        Ok(())
    }

    fn submit<'a, D: Pod, A>(
        &self,
        kernel: &Kernel,
        rays: &[Ray],
        answers: &'a mut [A],
    ) -> Result<PendingChunk<'a, A>, DeviceError> {
        let WalkKernels { gpu, frame, .. } = self.kernels;
        let (count, answer_bytes) = (rays.len(), size_of::<D>());
        let (rays, clocks) = canonical(frame, rays);
        let buffers = self.pool.take(gpu, count)?;
        gpu.queue.write_buffer(&buffers.rays, 0, bytemuck::cast_slice(&rays));
        let submission = gpu.submit(|encoder| {
            let ChunkBuffers { rays, answers, staging, .. } = &buffers;
            self.kernels.record(encoder, kernel, rays, answers, (count, answer_bytes), None);
            encoder.copy_buffer_to_buffer(answers, 0, staging, 0, (count * answer_bytes) as u64);
        })?;
        Ok(PendingChunk { answers, clocks, buffers, submission })
    }

    fn finish<D: Pod, A>(
        &self,
        chunk: PendingChunk<'_, A>,
        finish: impl Fn(D, &Clock) -> A,
    ) -> Result<(), DeviceError> {
        let PendingChunk { answers, clocks, buffers, submission } = chunk;
        let bytes = answers.len() * size_of::<D>();
        self.kernels.gpu.read(&buffers.staging, bytes, submission, |bytes| {
            let found = bytes.chunks_exact(size_of::<D>()).map(bytemuck::pod_read_unaligned);
            for ((answer, found), clock) in answers.iter_mut().zip(found).zip(&clocks) {
                *answer = finish(found, clock);
            }
        })?;
        self.pool.put(buffers);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shader::WORKGROUP;

    #[test]
    fn a_chunk_fits_into_a_binding_and_a_dispatch() {
        let limits = wgpu::Limits::defaults();
        let bytes = CHUNK_RAYS as u64 * size_of::<DeviceAnswer>().max(size_of::<DeviceRay>()) as u64;
        assert!(bytes <= limits.max_storage_buffer_binding_size);
        assert!(CHUNK_RAYS / WORKGROUP as usize <= limits.max_compute_workgroups_per_dimension as usize);
        assert!(WORKGROUP <= limits.max_compute_invocations_per_workgroup);
    }
}
