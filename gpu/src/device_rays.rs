//! Rays that stay on the device: uploaded, or made there.

use core::fmt;
use std::sync::Arc;

use bytemuck::Zeroable;
use leafwalk_core::{Clock, Frame, Ray};

use crate::chunk::{BUFFER_RAYS, pieces};
use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::pinhole::{DeviceCamera, Pinhole};
use crate::ray::DeviceRay;
use crate::structure::Setup;
use crate::tracer::GpuTracer;

/// Canonical rays on the device, for any number of submissions.
pub struct DeviceRays {
    pub(crate) buffers: Vec<(wgpu::Buffer, usize)>,
    pub(crate) clocks: Arc<Clocks>,
}

/// How each ray's t' becomes the caller's t.
pub(crate) enum Clocks {
    Uploaded(Vec<Clock>),
    Made(Frame, Pinhole),
}

impl Clocks {
    pub(crate) fn of(&self, number: usize) -> Clock {
        match self {
            Self::Uploaded(clocks) => clocks[number],
            Self::Made(frame, camera) => {
                let ray = camera.pixel(number).and_then(|(x, y)| frame.canonical(&camera.ray(x, y)));
                ray.map_or(NO_CLOCK, |ray| ray.clock)
            }
        }
    }
}

/// Of rays that miss.
const NO_CLOCK: Clock = Clock { entry: 0.0, unit: 1.0 };

/// Rays as the device traces them, and their clocks.
pub(crate) fn canonical(frame: &Frame, rays: impl IntoIterator<Item = Option<Ray>>) -> (Vec<DeviceRay>, Vec<Clock>) {
    let canonical = rays.into_iter().map(|ray| ray.and_then(|ray| frame.canonical(&ray)));
    canonical.map(|ray| ray.map_or((DeviceRay::NEVER, NO_CLOCK), |ray| (DeviceRay::new(&ray), ray.clock))).unzip()
}

const USAGE: wgpu::BufferUsages = wgpu::BufferUsages::STORAGE.union(wgpu::BufferUsages::COPY_SRC);

impl GpuTracer {
    /// Uploads rays, once for any number of submissions.
    ///
    /// # Errors
    /// When the device has no room for them, or fails.
    pub fn upload(&self, rays: &[Ray]) -> Result<DeviceRays, GpuError> {
        self.upload_some(rays.iter().map(|ray| Some(*ray)))
    }

    /// A camera's rays, made on the device, tile by tile: ray `number` is that of [`Pinhole::pixel`]. Where the camera
    /// is more than a root edge outside, or its numbers are extreme, the same rays are made here and uploaded.
    ///
    /// # Errors
    /// When the device has no room for them, or fails; [`GpuError::CameraTooLarge`] for 2^32 rays or more.
    pub fn camera_rays(&self, camera: &Pinhole) -> Result<DeviceRays, GpuError> {
        let Pinhole { width, height, .. } = *camera;
        if u32::try_from(camera.rays()).is_err() {
            return Err(GpuError::CameraTooLarge { width, height });
        }
        let ranges = pieces(camera.rays(), BUFFER_RAYS);
        let cameras: Option<Vec<_>> =
            ranges.map(|range| Some((camera.to_device(&self.frame, range.start)?, range.len()))).collect();
        let Some(cameras) = cameras else {
            let ray = |number| camera.pixel(number).map(|(x, y)| camera.ray(x, y));
            return self.upload_some((0..camera.rays()).map(ray));
        };
        let buffers = cameras.iter().map(|(camera, count)| self.make(camera, *count)).collect::<Result<_, _>>()?;
        Ok(DeviceRays { buffers, clocks: Arc::new(Clocks::Made(self.frame, *camera)) })
    }

    fn upload_some(&self, rays: impl Iterator<Item = Option<Ray>>) -> Result<DeviceRays, GpuError> {
        let (rays, clocks) = canonical(&self.frame, rays);
        let chunk = |range| {
            let rays: &[DeviceRay] = &rays[range];
            Ok((self.gpu.filled("rays", bytemuck::cast_slice(rays), USAGE)?, rays.len()))
        };
        let buffers = pieces(rays.len(), BUFFER_RAYS).map(chunk).collect::<Result<_, GpuError>>()?;
        Ok(DeviceRays { buffers, clocks: Arc::new(Clocks::Uploaded(clocks)) })
    }

    fn make(&self, camera: &DeviceCamera, count: usize) -> Result<(wgpu::Buffer, usize), GpuError> {
        let (gpu, (module, kernel)) = (&self.gpu, &self.camera);
        let bytes = count * size_of::<DeviceRay>();
        let rays = gpu.buffer("rays", bytes, USAGE)?;
        let setup = Setup::zeroed().upload(gpu)?;
        let camera_buffer = gpu.filled("camera", bytemuck::bytes_of(camera), wgpu::BufferUsages::STORAGE)?;
        let setup = module.bind(gpu, 0, &[(&setup, size_of::<Setup>())]);
        let group = module.bind(gpu, 1, &[(&camera_buffer, size_of::<DeviceCamera>()), (&rays, bytes)]);
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        kernel.record(&mut encoder, [&setup, &group], count, None);
        gpu.queue.submit([encoder.finish()]);
        gpu.check().map(|()| (rays, count))
    }
}

impl DeviceRays {
    /// How many.
    pub fn len(&self) -> usize {
        self.buffers.iter().map(|(_, count)| count).sum()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.buffers.is_empty()
    }

    /// The rays as the device has them, for tests.
    #[doc(hidden)]
    pub fn read(&self, gpu: &Gpu) -> Result<Vec<DeviceRay>, GpuError> {
        let mut rays = Vec::with_capacity(self.len());
        for (buffer, count) in &self.buffers {
            rays.extend(gpu.copied::<DeviceRay>(buffer, *count)?);
        }
        Ok(rays)
    }
}

impl fmt::Debug for DeviceRays {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DeviceRays").field("len", &self.len()).finish_non_exhaustive()
    }
}
