//! A pinhole camera whose rays are made on the device: what these tests use ray generation shaders for.

use bytemuck::{Pod, Zeroable};
use leafwalk_core::layout::LATTICE;
use leafwalk_core::{Frame, Ray};
use leafwalk_gpu::{DeviceRay, DeviceRays, GpuError, GpuTracer};

/// The ray generation shader.
const TEXT: &str = include_str!("camera.wgsl");
/// A ray that misses, since its direction is zero.
const INVALID: Ray = Ray { origin: [0.0; 3], t_min: 0.0, direction: [0.0; 3], t_max: 0.0 };
/// Pixels along a tile's side. The 64 rays of a tile are traced together.
const TILE: u32 = 8;

/// A camera in the caller's units. The ray of pixel (x, y) starts at `eye` and has the direction
/// `corner + x * right + y * down`, in f32, of whatever length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pinhole {
    /// Where all rays start.
    pub(crate) eye: [f32; 3],
    /// Direction of the upper left pixel.
    pub(crate) corner: [f32; 3],
    /// From a pixel's direction to that of the next one to the right.
    pub(crate) right: [f32; 3],
    /// From a pixel's direction to that of the next one below.
    pub(crate) down: [f32; 3],
    /// Pixels across.
    pub(crate) width: u32,
    /// Pixels down.
    pub(crate) height: u32,
}

impl Pinhole {
    /// The ray of a pixel: the device makes the same one.
    pub(crate) fn ray(&self, x: u32, y: u32) -> Ray {
        let direction = |k: usize| (self.corner[k] + x as f32 * self.right[k]) + y as f32 * self.down[k];
        Ray::new(self.eye, core::array::from_fn(direction))
    }

    /// How many rays the picture's tiles hold, those beyond its right and lower edge included.
    pub(crate) fn rays(&self) -> usize {
        let tiles = self.tiles_across() as usize * self.height.div_ceil(TILE) as usize;
        tiles.saturating_mul((TILE * TILE) as usize)
    }

    /// The pixel of a ray by its number: tiles of 8 x 8 row by row, in Morton order inside. `None` beyond the picture.
    pub(crate) fn pixel(&self, number: usize) -> Option<(u32, u32)> {
        const SIDE: usize = TILE as usize;
        let (tile, within) = (number / (SIDE * SIDE), number % (SIDE * SIDE));
        let across = self.tiles_across() as usize;
        let x = tile.checked_rem(across)? * SIDE + every_other(within);
        let y = tile / across * SIDE + every_other(within >> 1);
        (x < self.width as usize && y < self.height as usize).then_some((x as u32, y as u32))
    }

    fn tiles_across(&self) -> u32 {
        self.width.div_ceil(TILE)
    }

    /// All rays in the order of the device.
    pub(crate) fn numbered_rays(&self) -> Vec<Option<Ray>> {
        (0..self.rays()).map(|number| self.numbered_ray(number)).collect()
    }

    fn numbered_ray(&self, number: usize) -> Option<Ray> {
        self.pixel(number).map(|(x, y)| self.ray(x, y))
    }

    /// The rays on the device: made there, or, where only the CPU can make them, uploaded.
    pub(crate) fn on_device(self, tracer: &GpuTracer, frame: &Frame) -> Result<DeviceRays, GpuError> {
        let Some(camera) = self.to_device(frame) else {
            let rays: Vec<Ray> = self.numbered_rays().into_iter().map(|ray| ray.unwrap_or(INVALID)).collect();
            return tracer.upload(&rays);
        };
        let generator = tracer.ray_generator(TEXT)?;
        let ray = move |number| self.numbered_ray(number);
        generator.generate(self.rays(), bytemuck::bytes_of(&camera), ray)
    }

    /// What the device makes rays from; `None` where only the CPU can: the eye is so far outside that its rays move, or a
    /// number so small or large that f32 loses it.
    pub(crate) fn to_device(self, frame: &Frame) -> Option<DeviceCamera> {
        // Products and sums of such numbers are multiples of 2^-84, and normal.
        let is_moderate = |c: &f32| *c == 0.0 || (c.abs() > SMALL && c.abs() < 1.0 / SMALL);
        let excess = |k: usize| {
            let step = frame.scale() / f64::from(LATTICE);
            let lattice = (f64::from(self.eye[k]) - frame.anchor[k]) / step;
            let at = (lattice - f64::from(frame.corner[k])) / f64::from(LATTICE);
            (at - 1.0).max(-at)
        };
        let is_counted = self.width.max(self.height) <= 1 << f32::MANTISSA_DIGITS;
        let is_near = (0..3).all(|k| excess(k) <= 1.0);
        let is_normal = [self.corner, self.right, self.down].as_flattened().iter().all(is_moderate);
        if !(is_counted && is_near && is_normal) {
            return None;
        }
        // Not moved, an origin depends on no direction.
        let DeviceRay { origin, t_min, t_max, .. } = DeviceRay::new(frame, &Ray::new(self.eye, [1.0, 0.0, 0.0]));
        let Self { corner, right, down, width, height, .. } = self;
        let (tiles_across, unused) = (self.tiles_across(), DeviceCamera::zeroed());
        Some(DeviceCamera { origin, t_min, corner, t_max, right, width, down, height, tiles_across, ..unused })
    }
}

/// The bits of even place, put together.
fn every_other(bits: usize) -> usize {
    (bits & 1) | (bits >> 1 & 2) | (bits >> 2 & 4)
}

/// Components nearer to 0 are for the CPU.
const SMALL: f32 = 1.0 / (1u64 << 60) as f32;

/// A camera whose eye is in lattice coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct DeviceCamera {
    /// The canonical origin of all rays.
    pub(crate) origin: [f32; 3],
    /// Canonical limit of all rays.
    pub(crate) t_min: f32,
    /// As [`Pinhole::corner`].
    pub(crate) corner: [f32; 3],
    /// Canonical limit of all rays.
    pub(crate) t_max: f32,
    /// As [`Pinhole::right`].
    pub(crate) right: [f32; 3],
    /// Pixels across.
    pub(crate) width: u32,
    /// As [`Pinhole::down`].
    pub(crate) down: [f32; 3],
    /// Pixels down.
    pub(crate) height: u32,
    /// Tiles a row.
    pub(crate) tiles_across: u32,
    /// Zero.
    pub(crate) unused_0: u32,
    /// Zero.
    pub(crate) unused_1: u32,
    /// Zero.
    pub(crate) unused_2: u32,
}
