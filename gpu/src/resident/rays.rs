//! `DeviceRays`: rays that stay on the device, for any number of submissions.

use core::fmt;
use core::ops::Range;
use std::sync::Arc;

use leafwalk_core::{Clock, Frame, Ray};

use crate::device::{DeviceError, Gpu};
use crate::shader::WORKGROUP;
use crate::walk::{DeviceRay, NO_CLOCK, canonical};

/// Rays of a buffer: one dispatch of as many workgroups as WebGPU promises along an axis.
const BUFFER_RAYS: usize = 65535 * WORKGROUP as usize;

/// Rays on the device, in the frame of the octree that they were made for.
pub struct DeviceRays {
    pub(super) gpu: Gpu,
    pub(super) frame: Frame,
    /// Each with the number of its rays, which is not 0.
    pub(super) buffers: Vec<(wgpu::Buffer, usize)>,
    pub(super) clocks: Arc<Clocks>,
}

/// Where the clock of a ray is known from, which turns its t' into the caller's t.
pub(super) enum Clocks {
    /// The clocks of rays that were uploaded.
    Uploaded(Vec<Clock>),
    /// The frame, and the function that gives the rays which a shader made.
    Generated(Frame, Box<RayOfNumber>),
}

/// The ray of a number, in the caller's units; `None` for one that misses.
pub(super) type RayOfNumber = dyn Fn(usize) -> Option<Ray> + Send + Sync;

impl Clocks {
    /// The clock of the ray of that number.
    pub(super) fn of(&self, number: usize) -> Clock {
        match self {
            Self::Uploaded(clocks) => clocks[number],
            Self::Generated(frame, ray) => {
                let ray = ray(number).and_then(|ray| frame.canonical(&ray));
                ray.map_or(NO_CLOCK, |ray| ray.clock)
            }
        }
    }
}

impl DeviceRays {
    /// Makes rays canonical and uploads them.
    pub(crate) fn upload(gpu: &Gpu, frame: Frame, rays: &[Ray]) -> Result<Self, DeviceError> {
        let (rays, clocks) = canonical(&frame, rays);
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        let upload = |rays: &[DeviceRay]| Ok((gpu.filled("rays", bytemuck::cast_slice(rays), usage)?, rays.len()));
        let buffers = rays.chunks(BUFFER_RAYS).map(upload).collect::<Result<_, DeviceError>>()?;
        Ok(Self { gpu: gpu.clone(), frame, buffers, clocks: Arc::new(Clocks::Uploaded(clocks)) })
    }

    /// The numbers of `count` rays, a buffer at a time.
    pub(super) fn buffer_ranges(count: usize) -> impl Iterator<Item = Range<usize>> {
        (0..count).step_by(BUFFER_RAYS).map(move |start| start..count.min(start + BUFFER_RAYS))
    }

    /// How many rays there are.
    pub fn len(&self) -> usize {
        self.buffers.iter().map(|(_, count)| count).sum()
    }

    /// Whether there are no rays.
    pub fn is_empty(&self) -> bool {
        self.buffers.is_empty()
    }

    /// Whether a tracer in this frame on this device may trace them.
    pub(super) fn belongs_to(&self, gpu: &Gpu, frame: &Frame) -> bool {
        self.gpu.is_same(gpu) && self.frame == *frame
    }

    /// Copies the rays from the device.
    pub(crate) fn read(&self) -> Result<Vec<DeviceRay>, DeviceError> {
        let mut rays = Vec::with_capacity(self.len());
        for (buffer, count) in &self.buffers {
            rays.extend(self.gpu.copied::<DeviceRay>(buffer, *count)?);
        }
        Ok(rays)
    }
}

impl fmt::Debug for DeviceRays {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DeviceRays").field("len", &self.len()).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_buffer_fits_into_a_binding_and_a_dispatch() {
        let limits = wgpu::Limits::defaults();
        assert!(BUFFER_RAYS as u64 * size_of::<DeviceRay>() as u64 <= limits.max_storage_buffer_binding_size);
        assert!(BUFFER_RAYS / WORKGROUP as usize <= limits.max_compute_workgroups_per_dimension as usize);
    }

    #[test]
    fn buffers_are_full_but_for_the_last() {
        let lengths = |count| DeviceRays::buffer_ranges(count).map(|range| range.len()).collect::<Vec<_>>();
        assert_eq!(lengths(0), []);
        assert_eq!(lengths(5), [5]);
        assert_eq!(lengths(BUFFER_RAYS), [BUFFER_RAYS]);
        assert_eq!(lengths(2 * BUFFER_RAYS + 1), [BUFFER_RAYS, BUFFER_RAYS, 1]);
    }
}
