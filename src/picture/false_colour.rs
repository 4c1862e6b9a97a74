//! Pictures whose colours are data: normals, depths, primitives, or cells. Each pixel shows one primary ray.

use glam::DVec3;
use leafwalk::{Hit, Octree, Ray, Tracer};
use rayon::prelude::*;

use super::drawing::Drawing;
use super::meter::Meter;
use super::primary::PrimaryRays;
use super::vector::mix;
use super::{Image, PictureError};
use crate::camera::Size;

/// The smallest and the largest value of a picture's scale.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    pub(crate) lowest: f32,
    pub(crate) highest: f32,
}

impl<'m, T: Tracer> Drawing<'_, 'm, T> {
    /// Shows the unit normal on the side that is seen: its x, y and z are red, green and blue, from -1 (dark) to 1
    /// (bright).
    pub(crate) fn normals(self) -> Result<Image, PictureError<T::Error>> {
        let (size, surfaces) = (self.camera.size(), self.surfaces);
        let colour = |ray: &Ray, hit: &Hit| {
            let normal = surfaces.at(hit, ray.direction).map(|surface| surface.normal);
            normal.map_or(BACKGROUND, |normal| normal.to_array().map(|c| to_byte(0.5 + 0.5 * c)))
        };
        Ok(Image { size, pixels: self.each(Meter::primary_hits, colour)? })
    }

    /// Shows each primitive in a colour of its own.
    pub(crate) fn primitives(self) -> Result<Image, PictureError<T::Error>> {
        let size = self.camera.size();
        let colour = |_: &Ray, hit: &Hit| if hit.is_miss() { BACKGROUND } else { primitive_colour(hit.primitive) };
        Ok(Image { size, pixels: self.each(Meter::primary_hits, colour)? })
    }

    /// Shows the distance to the hit: what is near is bright, what is far is dark.
    pub(crate) fn depths(self) -> Result<(Image, Option<Scale>), PictureError<T::Error>> {
        let size = self.camera.size();
        let depths = self.each(Meter::primary_hits, |_, hit| hit.t)?;
        scaled(size, &depths, |depth, scale| [to_byte(1.0 - 0.9 * scale.share(depth)); 3])
    }

    /// Shows how many cells a ray visits, from none (black) to the most (light yellow). They are the cells of the
    /// counted walk, which here takes the place of the tracer.
    pub(crate) fn cells<W: AsRef<[u32]> + Sync>(
        self,
        octree: &Octree<W>,
    ) -> Result<(Image, Option<Scale>), PictureError<T::Error>> {
        let size = self.camera.size();
        let walk = |meter: &mut Meter<'m, T>, rays: &[Ray]| Ok(meter.primary_walks(octree, rays));
        let cells = self.each(walk, |_, (_, work)| work.cells as f32)?;
        scaled(size, &cells, |cells, scale| heat(f64::from(cells / scale.highest)))
    }

    /// The value of each pixel, made of the answer that `trace` gives to the ray through its middle.
    fn each<A: Sync, V: Send>(
        self,
        trace: impl Fn(&mut Meter<'m, T>, &[Ray]) -> Result<Vec<A>, T::Error>,
        value: impl Fn(&Ray, &A) -> V + Sync,
    ) -> Result<Vec<V>, PictureError<T::Error>> {
        let size = self.camera.size();
        let mut values = Vec::new();
        values.try_reserve_exact(size.pixels()).map_err(|_| PictureError::OutOfMemory { size })?;
        let primary = PrimaryRays::through_middles(self.camera);
        for pixels in primary.batches() {
            if (self.progress)(pixels.start).is_break() {
                return Err(PictureError::Cancelled);
            }
            let rays = primary.through(&pixels);
            let answers = trace(self.meter, &rays).map_err(PictureError::Tracer)?;
            values.par_extend(rays.par_iter().zip(&answers).map(|(ray, answer)| value(ray, answer)));
        }
        Ok(values)
    }
}

/// A picture that shows a value of each pixel on the scale of them all. The background has a value that is not finite.
fn scaled<E>(
    size: Size,
    values: &[f32],
    colour: impl Fn(f32, &Scale) -> [u8; 3] + Sync,
) -> Result<(Image, Option<Scale>), PictureError<E>> {
    let finite = values.iter().copied().filter(|value| value.is_finite());
    let lowest = finite.clone().fold(f32::INFINITY, f32::min);
    let highest = finite.fold(f32::NEG_INFINITY, f32::max);
    let scale = (lowest <= highest).then_some(Scale { lowest, highest });
    let mut image = Image::with_capacity(size)?;
    image.pixels.par_extend(values.par_iter().map(|value| match &scale {
        Some(scale) if value.is_finite() => colour(*value, scale),
        _ => BACKGROUND,
    }));
    Ok((image, scale))
}

impl Scale {
    /// Where a value lies between the ends of the scale, from 0 to 1.
    fn share(&self, value: f32) -> f64 {
        let span = f64::from(self.highest) - f64::from(self.lowest);
        if span > 0.0 { (f64::from(value) - f64::from(self.lowest)) / span } else { 0.0 }
    }
}

const BACKGROUND: [u8; 3] = [0; 3];

/// The byte of a display value from 0 to 1.
fn to_byte(value: f64) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// A colour that is not dark and depends on the primitive alone.
fn primitive_colour(primitive: u32) -> [u8; 3] {
    // The finaliser of MurmurHash3 (Appleby, public domain): every bit of the number changes half the colour's bits.
    let mut hash = primitive.wrapping_add(1);
    hash = (hash ^ hash >> 16).wrapping_mul(0x85eb_ca6b);
    hash = (hash ^ hash >> 13).wrapping_mul(0xc2b2_ae35);
    let [red, green, blue, _] = (hash ^ hash >> 16).to_le_bytes();
    [red, green, blue].map(|c| 64 + c / 4 * 3)
}

/// Ten colours in even steps of lightness: the map `inferno` of N. Smith and S. van der Walt (2015, public domain,
/// <https://bids.github.io/colormap/>).
const INFERNO: [[u8; 3]; 10] = [
    [0, 0, 4],
    [27, 12, 66],
    [75, 12, 107],
    [120, 28, 109],
    [165, 44, 96],
    [207, 68, 70],
    [237, 105, 37],
    [251, 154, 6],
    [247, 208, 60],
    [252, 255, 164],
];

/// The colour of a share from 0 (black) to 1 (light yellow).
fn heat(share: f64) -> [u8; 3] {
    let place = share.clamp(0.0, 1.0) * (INFERNO.len() - 1) as f64;
    let below = (place as usize).min(INFERNO.len() - 2);
    let [low, high] = [INFERNO[below], INFERNO[below + 1]].map(|colour| DVec3::from(colour.map(f64::from)));
    mix(low, high, place - below as f64).to_array().map(|c| (c + 0.5) as u8)
}
