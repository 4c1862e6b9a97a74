//! An open device: its buffers, waiting for it, and what went wrong.

use core::fmt;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, ThreadId};

use bytemuck::Pod;
use leafwalk_core::Octree;

use crate::adapter::{self, Adapter, Pick};
use crate::error::GpuError;
use crate::flavour::Flavour;
use crate::prelude::QUAD_BYTES;
use crate::self_test::{self, SelfTest};
use crate::shader;
use crate::tracer::GpuTracer;

/// An open device with WebGPU's default limits; clones share it.
// Nothing it does panics: faults are kept until `check` hands them on.
#[derive(Clone)]
pub struct Gpu {
    adapter: Adapter,
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    faults: Arc<Faults>,
}

/// Of each thread the first fault that it was not told of yet, and whether the device is lost. A fault is kept by the
/// thread whose call failed: taken by another one, it would leave that call's answers for good ones.
#[derive(Default)]
struct Faults {
    first: Mutex<HashMap<ThreadId, GpuError>>,
    lost: Mutex<Option<GpuError>>,
}

impl Gpu {
    /// Opens an adapter.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`] says what there is instead, [`GpuError::NoDevice`] why the driver refuses.
    pub fn open(pick: &Pick) -> Result<Self, GpuError> {
        let _opening = adapter::opening();
        let (source, adapter) = adapter::pick(pick)?;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("leafwalk"),
            required_features: source.features() & wgpu::Features::TIMESTAMP_QUERY,
            required_limits: wgpu::Limits::defaults(),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(source.request_device(&descriptor))
            .map_err(|error| GpuError::NoDevice { adapter: adapter.clone(), reason: error.to_string() })?;
        let faults = Arc::new(Faults::default());
        let (errors, losses) = (Arc::clone(&faults), Arc::clone(&faults));
        device.on_uncaptured_error(Arc::new(move |error| {
            // The others follow from the first one.
            lock(&errors.first).entry(thread::current().id()).or_insert_with(|| of_driver(&error));
        }));
        device.set_device_lost_callback(move |_, reason| {
            lock(&losses.lost).get_or_insert(GpuError::DeviceLost { reason });
        });
        Ok(Self { adapter, device, queue, faults })
    }

    /// The adapter that was opened.
    pub fn adapter(&self) -> &Adapter {
        &self.adapter
    }

    /// What the device makes of a flavour's arithmetic.
    ///
    /// # Errors
    /// When the device fails.
    pub fn self_test(&self, flavour: Flavour) -> Result<SelfTest, GpuError> {
        self.self_test_of(&shader::checks(flavour))
    }

    /// What the device makes of a text's arithmetic, for tests that spoil it.
    #[doc(hidden)]
    pub fn self_test_of(&self, checks: &str) -> Result<SelfTest, GpuError> {
        SelfTest::run(self, checks)
    }

    /// A tracer over an octree, whose words are uploaded as they are.
    ///
    /// # Errors
    /// As [`GpuTracer::new`], but for the adapter.
    pub fn tracer<W: AsRef<[u32]>>(&self, octree: &Octree<W>, flavour: Flavour) -> Result<GpuTracer, GpuError> {
        GpuTracer::split(self, octree, flavour, self.device.limits().max_storage_buffer_binding_size)
    }

    /// Every entry of the tables as the device reads them: exit faces, then sub-faces.
    #[doc(hidden)]
    pub fn table_entries(&self) -> Result<Vec<u32>, GpuError> {
        self_test::table_entries(self)
    }

    /// Loses the device, as if it were unplugged.
    #[doc(hidden)]
    pub fn lose(&self) {
        self.device.destroy();
    }

    /// Hands on what went wrong in this thread since its last check. A lost device stays lost.
    pub(crate) fn check(&self) -> Result<(), GpuError> {
        let fault = lock(&self.faults.first).remove(&thread::current().id());
        // A loss shows in other faults first, and is told when the device has nothing more to do.
        let poll = if fault.is_some() { wgpu::PollType::wait_indefinitely() } else { wgpu::PollType::Poll };
        let polled = self.device.poll(poll);
        lock(&self.faults.lost).clone().or(fault).map_or(Ok(()), Err)?;
        polled.map(|_| ()).map_err(|error| GpuError::Driver { reason: error.to_string() })
    }

    /// # Errors
    /// Where the device has no room for it.
    pub(crate) fn buffer(
        &self,
        label: &str,
        bytes: usize,
        usage: wgpu::BufferUsages,
    ) -> Result<wgpu::Buffer, GpuError> {
        let descriptor =
            wgpu::BufferDescriptor { label: Some(label), size: bytes as u64, usage, mapped_at_creation: false };
        let buffer = self.device.create_buffer(&descriptor);
        self.check().map(|()| buffer)
    }

    /// A buffer that shaders read, with its contents and, up to a whole quad, zeros.
    pub(crate) fn filled(
        &self,
        label: &str,
        bytes: &[u8],
        usage: wgpu::BufferUsages,
    ) -> Result<wgpu::Buffer, GpuError> {
        let room = bytes.len().next_multiple_of(QUAD_BYTES);
        let buffer = self.buffer(label, room, usage | wgpu::BufferUsages::COPY_DST)?;
        self.queue.write_buffer(&buffer, 0, bytes);
        self.check().map(|()| buffer)
    }

    /// Waits until a submission is done, or all of them.
    pub(crate) fn wait(&self, submission: Option<wgpu::SubmissionIndex>) -> Result<(), GpuError> {
        let waited = self.device.poll(wgpu::PollType::Wait { submission_index: submission, timeout: None });
        self.check()?;
        waited.map(|_| ()).map_err(|error| GpuError::Driver { reason: error.to_string() })
    }

    /// Two time stamps, where the device has any.
    pub(crate) fn stamps(&self) -> Option<wgpu::QuerySet> {
        let descriptor =
            wgpu::QuerySetDescriptor { label: Some("timestamps"), ty: wgpu::QueryType::Timestamp, count: 2 };
        let has_timestamps = self.device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        has_timestamps.then(|| self.device.create_query_set(&descriptor))
    }

    /// The first `count` values of a buffer on the device.
    pub(crate) fn copied<D: Pod>(&self, buffer: &wgpu::Buffer, count: usize) -> Result<Vec<D>, GpuError> {
        let bytes = count * size_of::<D>();
        let staging = self.buffer("staging", bytes, wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST)?;
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, bytes as u64);
        let submission = self.queue.submit([encoder.finish()]);
        self.read(&staging, bytes, submission, bytemuck::pod_collect_to_vec)
    }

    /// The contents of a buffer that can be mapped, once `submission`, which fills it, is done.
    pub(crate) fn read<R>(
        &self,
        buffer: &wgpu::Buffer,
        bytes: usize,
        submission: wgpu::SubmissionIndex,
        take: impl FnOnce(&[u8]) -> R,
    ) -> Result<R, GpuError> {
        let failure = Arc::new(Mutex::new(None));
        let seen = Arc::clone(&failure);
        buffer.map_async(wgpu::MapMode::Read, 0..bytes as u64, move |mapped| {
            if let Err(error) = mapped {
                *lock(&seen) = Some(GpuError::Driver { reason: error.to_string() });
            }
        });
        self.wait(Some(submission))?;
        if let Some(error) = lock(&failure).take() {
            return Err(error);
        }
        let view = buffer.get_mapped_range(0..bytes as u64);
        let taken = view.map(|view| take(&view)).map_err(|error| GpuError::Driver { reason: error.to_string() });
        buffer.unmap();
        taken
    }
}

impl fmt::Debug for Gpu {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Gpu").field(&self.adapter).finish()
    }
}

fn of_driver(error: &wgpu::Error) -> GpuError {
    let reason = error.to_string();
    match error {
        wgpu::Error::OutOfMemory { .. } => GpuError::OutOfMemory { reason },
        wgpu::Error::Validation { .. } | wgpu::Error::Internal { .. } => GpuError::Driver { reason },
    }
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_device_out_of_memory_is_told_from_one_that_fails() {
        let source = || Box::<dyn core::error::Error + Send + Sync>::from("words");
        let full = of_driver(&wgpu::Error::OutOfMemory { source: source() });
        assert!(matches!(full, GpuError::OutOfMemory { .. }), "{full:?}");
        let failed = of_driver(&wgpu::Error::Internal { source: source(), description: "words".to_owned() });
        assert_eq!(failed, GpuError::Driver { reason: "words".to_owned() });
    }
}
