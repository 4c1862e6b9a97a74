//! `Gpu`: an open device with its buffers; it waits for the device and hands on what went wrong there.

use core::cmp::Reverse;
use core::fmt;
use std::sync::{Arc, Mutex};

use bytemuck::Pod;

use super::adapter::{self, Adapter};
use super::choice::AdapterChoice;
use super::error::DeviceError;
use super::faults::{Faults, lock};
use crate::shader::QUAD_BYTES;

/// An open device with WebGPU's default limits. Clones share the device.
// No method panics on a fault of the device: faults are kept until `check` hands them on.
#[derive(Clone)]
pub struct Gpu {
    adapter: Adapter,
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    faults: Arc<Faults>,
}

impl Gpu {
    /// Opens the adapter that is wanted most, the first of equals.
    ///
    /// # Errors
    /// [`DeviceError::NoAdapter`] says which adapters there are instead, [`DeviceError::NoDevice`] why the driver refuses.
    pub fn open(choice: &AdapterChoice) -> Result<Self, DeviceError> {
        let _lock = adapter::lock_adapters();
        let mut all: Vec<_> =
            adapter::enumerate().into_iter().map(|adapter| (Adapter::describe(&adapter), adapter)).collect();
        let ranked = all.iter().enumerate().filter_map(|(at, (adapter, _))| Some((choice.rank(adapter)?, Reverse(at))));
        let Some((_, Reverse(at))) = ranked.max() else {
            let tried = wgpu::Instance::enabled_backend_features().iter_names().map(|(name, _)| name).collect();
            let seen = all.into_iter().map(|(adapter, _)| adapter).collect();
            return Err(DeviceError::NoAdapter { choice: choice.clone(), tried, seen });
        };
        let (adapter, source) = all.swap_remove(at);
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("leafwalk"),
            required_features: source.features() & wgpu::Features::TIMESTAMP_QUERY,
            required_limits: wgpu::Limits::defaults(),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(source.request_device(&descriptor))
            .map_err(|error| DeviceError::NoDevice { adapter: Box::new(adapter.clone()), reason: error.to_string() })?;
        let faults = Faults::listen(&device);
        Ok(Self { adapter, device, queue, faults })
    }

    /// The adapter that was opened.
    pub fn adapter(&self) -> &Adapter {
        &self.adapter
    }

    /// Whether both are clones of one device.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.faults, &other.faults)
    }

    /// Hands on what went wrong in this thread since its last check. A lost device stays lost.
    pub(crate) fn check(&self) -> Result<(), DeviceError> {
        let fault = self.faults.take();
        // A loss shows in other faults first, and is reported when the device has nothing more to do.
        let poll = if fault.is_some() { wgpu::PollType::wait_indefinitely() } else { wgpu::PollType::Poll };
        let polled = self.device.poll(poll);
        self.faults.loss().or(fault).map_or(Ok(()), Err)?;
        polled.map(|_| ()).map_err(DeviceError::driver)
    }

    /// A buffer on the device.
    ///
    /// # Errors
    /// When the device has no room for it.
    pub(crate) fn buffer(
        &self,
        label: &str,
        bytes: usize,
        usage: wgpu::BufferUsages,
    ) -> Result<wgpu::Buffer, DeviceError> {
        let descriptor =
            wgpu::BufferDescriptor { label: Some(label), size: bytes as u64, usage, mapped_at_creation: false };
        let buffer = self.device.create_buffer(&descriptor);
        self.check().map(|()| buffer)
    }

    /// A buffer on the device with its contents. It ends with a whole quad, since shaders read nothing smaller; zeros
    /// fill that up.
    pub(crate) fn filled(
        &self,
        label: &str,
        bytes: &[u8],
        usage: wgpu::BufferUsages,
    ) -> Result<wgpu::Buffer, DeviceError> {
        let room = bytes.len().next_multiple_of(QUAD_BYTES);
        let buffer = self.buffer(label, room, usage | wgpu::BufferUsages::COPY_DST)?;
        // The queue takes whole words.
        let (words, rest) = bytes.split_at(bytes.len() - bytes.len() % size_of::<u32>());
        self.queue.write_buffer(&buffer, 0, words);
        if !rest.is_empty() {
            let mut last = [0; size_of::<u32>()];
            last[..rest.len()].copy_from_slice(rest);
            self.queue.write_buffer(&buffer, words.len() as u64, &last);
        }
        self.check().map(|()| buffer)
    }

    /// Records commands and hands them to the device. Does not wait.
    pub(crate) fn submit(
        &self,
        record: impl FnOnce(&mut wgpu::CommandEncoder),
    ) -> Result<wgpu::SubmissionIndex, DeviceError> {
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        record(&mut encoder);
        let submission = self.queue.submit([encoder.finish()]);
        self.check().map(|()| submission)
    }

    /// Waits until a submission is done, or all of them.
    pub(crate) fn wait(&self, submission: Option<wgpu::SubmissionIndex>) -> Result<(), DeviceError> {
        let waited = self.device.poll(wgpu::PollType::Wait { submission_index: submission, timeout: None });
        self.check()?;
        waited.map(|_| ()).map_err(DeviceError::driver)
    }

    /// Room for `count` time stamps, where the device has any.
    pub(crate) fn timestamps(&self, count: u32) -> Option<wgpu::QuerySet> {
        let descriptor = wgpu::QuerySetDescriptor { label: Some("timestamps"), ty: wgpu::QueryType::Timestamp, count };
        let has_timestamps = self.device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        has_timestamps.then(|| self.device.create_query_set(&descriptor))
    }

    /// Copies the first `count` values of a buffer from the device, and waits for them.
    pub(crate) fn copied<D: Pod>(&self, buffer: &wgpu::Buffer, count: usize) -> Result<Vec<D>, DeviceError> {
        let bytes = count * size_of::<D>();
        let staging = self.buffer("staging", bytes, wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST)?;
        let submission = self.submit(|encoder| encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, bytes as u64))?;
        self.read(&staging, bytes, submission, bytemuck::pod_collect_to_vec)
    }

    /// Waits for `submission`, which fills a buffer that can be mapped, and shows that buffer's first `bytes` to `take`.
    pub(crate) fn read<R>(
        &self,
        buffer: &wgpu::Buffer,
        bytes: usize,
        submission: wgpu::SubmissionIndex,
        take: impl FnOnce(&[u8]) -> R,
    ) -> Result<R, DeviceError> {
        let failure = Arc::new(Mutex::new(None));
        let seen = Arc::clone(&failure);
        buffer.map_async(wgpu::MapMode::Read, 0..bytes as u64, move |mapped| {
            if let Err(error) = mapped {
                *lock(&seen) = Some(DeviceError::driver(error));
            }
        });
        self.wait(Some(submission))?;
        if let Some(error) = lock(&failure).take() {
            return Err(error);
        }
        let view = buffer.get_mapped_range(0..bytes as u64);
        let taken = view.map(|view| take(&view)).map_err(DeviceError::driver);
        buffer.unmap();
        taken
    }
}

impl fmt::Debug for Gpu {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Gpu").field(&self.adapter).finish()
    }
}
