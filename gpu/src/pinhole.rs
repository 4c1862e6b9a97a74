//! A pinhole camera whose rays are made on the device.

use bytemuck::{Pod, Zeroable};
use leafwalk_core::{Frame, Ray};

use crate::ray::DeviceRay;

/// Pixels along a tile's side. A tile's rays are traced together.
pub(crate) const TILE: u32 = 8;

/// A camera in the caller's units. The ray of pixel (x, y) starts at `eye` and has the direction
/// `corner + x * right + y * down`, in f32, of whatever length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pinhole {
    /// Where all rays start.
    pub eye: [f32; 3],
    /// Direction of the upper left pixel.
    pub corner: [f32; 3],
    /// From a pixel's direction to that of the next one to the right.
    pub right: [f32; 3],
    /// From a pixel's direction to that of the next one below.
    pub down: [f32; 3],
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
}

impl Pinhole {
    /// The ray of a pixel: the device makes the same one.
    pub fn ray(&self, x: u32, y: u32) -> Ray {
        let direction = |k: usize| (self.corner[k] + x as f32 * self.right[k]) + y as f32 * self.down[k];
        Ray::new(self.eye, core::array::from_fn(direction))
    }

    /// How many rays the picture's tiles hold, those beyond its right and lower edge included.
    pub fn rays(&self) -> usize {
        let tiles = self.tiles_across() as usize * self.height.div_ceil(TILE) as usize;
        tiles.saturating_mul((TILE * TILE) as usize)
    }

    /// The pixel of a ray by its number: tiles of 8 x 8 row by row, in Morton order inside. `None` beyond the picture.
    pub fn pixel(&self, number: usize) -> Option<(u32, u32)> {
        const SIDE: usize = TILE as usize;
        let (tile, within) = (number / (SIDE * SIDE), number % (SIDE * SIDE));
        let across = self.tiles_across() as usize;
        let every_other = |bits: usize| (bits & 1) | (bits >> 1 & 2) | (bits >> 2 & 4);
        let x = tile.checked_rem(across)? * SIDE + every_other(within);
        let y = tile / across * SIDE + every_other(within >> 1);
        (x < self.width as usize && y < self.height as usize).then_some((x as u32, y as u32))
    }

    fn tiles_across(&self) -> u32 {
        self.width.div_ceil(TILE)
    }

    /// What the device makes rays from, beginning with ray number `first`; `None` where only the CPU can: the eye is so
    /// far outside that its rays move, or a number so small or large that f32 loses it.
    pub(crate) fn to_device(self, frame: &Frame, first: usize) -> Option<DeviceCamera> {
        // Products and sums of such numbers are multiples of 2^-84, and normal.
        let is_moderate = |c: &f32| *c == 0.0 || (c.abs() > SMALL && c.abs() < 1.0 / SMALL);
        let excess = |k: usize| {
            let at = (f64::from(self.eye[k]) - frame.origin[k]) / frame.scale();
            (at - 1.0).max(-at)
        };
        let is_counted = self.width.max(self.height) <= 1 << f32::MANTISSA_DIGITS;
        let is_near = (0..3).all(|k| excess(k) <= 1.0);
        let is_normal = [self.corner, self.right, self.down].as_flattened().iter().all(is_moderate);
        // Not moved, an origin depends on no direction.
        let canonical =
            frame.canonical(&Ray::new(self.eye, [1.0, 0.0, 0.0])).filter(|_| is_counted && is_near && is_normal)?;
        let DeviceRay { origin, t_min, t_max, .. } = DeviceRay::new(&canonical);
        let Self { corner, right, down, width, height, .. } = self;
        let [tiles_across, first] = [self.tiles_across(), u32::try_from(first).ok()?];
        let unused = DeviceCamera::zeroed();
        Some(DeviceCamera { origin, t_min, corner, t_max, right, width, down, height, tiles_across, first, ..unused })
    }
}

/// Components nearer to 0 are for the CPU.
const SMALL: f32 = 1.0 / (1u64 << 60) as f32;

/// A camera whose eye is in lattice units.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct DeviceCamera {
    /// The canonical origin of all rays.
    pub origin: [f32; 3],
    /// Canonical limit of all rays.
    pub t_min: f32,
    /// As [`Pinhole::corner`].
    pub corner: [f32; 3],
    /// Canonical limit of all rays.
    pub t_max: f32,
    /// As [`Pinhole::right`].
    pub right: [f32; 3],
    /// Pixels across.
    pub width: u32,
    /// As [`Pinhole::down`].
    pub down: [f32; 3],
    /// Pixels down.
    pub height: u32,
    /// Tiles a row.
    pub tiles_across: u32,
    /// Number of the first ray.
    pub first: u32,
    /// Zero.
    pub unused_0: u32,
    /// Zero.
    pub unused_1: u32,
}
