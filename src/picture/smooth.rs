//! The pixels of a path-traced picture, and the filter that smooths the noise of few rays.
//!
//! Light from other surfaces, and the share of the light that arrives in penumbras, vary slowly over a surface. Both
//! are averaged over neighbouring pixels, with small weights for those that see another surface; colours and edges stay
//! sharp.

use glam::DVec3;
use rayon::prelude::*;

use super::PictureError;
use super::sampling::SAMPLES;
use super::surface::Surface;
use crate::camera::Size;

/// What the samples of a pixel saw, until it is shown.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pixel {
    /// The mean radiance that the surfaces of the samples emit.
    emitted: DVec3,
    /// The mean radiance that they would reflect of the light if nothing were in between.
    unshadowed: DVec3,
    /// The mean of their diffuse reflectances.
    diffuse: DVec3,
    /// The light that the shadow rays of all samples found, and what they would have found if nothing were in between.
    light: [f64; 2],
    /// What a white surface would reflect of the light from other surfaces, where the first sample hit.
    pub(crate) bounced: DVec3,
    /// The normal where the first sample hit. A mean of all samples would resemble no neighbour on an edge.
    normal: DVec3,
    /// The point where the first sample hit.
    point: DVec3,
    /// Whether the samples see different surfaces.
    is_edge: bool,
}

impl Pixel {
    /// Adds a sample: its hit, what a white surface there would reflect of the light if nothing were in between, and
    /// the light that its shadow ray found and might have found.
    pub(crate) fn add(&mut self, surface: &Surface, unshadowed: DVec3, light: [f64; 2]) {
        let share = 1.0 / SAMPLES as f64;
        let (diffuse, emission) = (surface.material.diffuse.as_dvec3(), surface.material.emission.as_dvec3());
        let emission = if surface.is_front { emission } else { DVec3::ZERO };
        self.emitted += emission * share;
        self.unshadowed += diffuse * unshadowed * share;
        self.diffuse += diffuse * share;
        self.light = [self.light[0] + light[0], self.light[1] + light[1]];
        if self.normal == DVec3::ZERO {
            (self.normal, self.point) = (surface.normal, surface.lifted);
        }
        let this = Self { normal: surface.normal, point: surface.lifted, ..Self::default() };
        self.is_edge |= likeness(self, &this) < ALIKE;
    }

    /// The radiance that reaches the camera.
    pub(crate) fn radiance(&self) -> DVec3 {
        let direct = self.unshadowed * self.visibility();
        self.emitted + (direct + self.diffuse * self.bounced)
    }

    /// The share of the light that arrives, from 0 to 1.
    fn visibility(&self) -> f64 {
        let [found, possible] = self.light;
        if possible > 0.0 { found / possible } else { 0.0 }
    }
}

/// All pixels of a picture, row by row from the top.
#[derive(Debug)]
pub(crate) struct Film {
    size: Size,
    pub(crate) pixels: Vec<Pixel>,
}

/// How many passes smooth the bounced light, which varies slowly. Each reaches twice as far as the one before; together
/// they reach 62 pixels.
const BOUNCED_PASSES: u32 = 5;
/// How many passes smooth the share of the light that arrives, within penumbras; together they reach 14 pixels.
const VISIBILITY_PASSES: u32 = 3;
/// The weights that a pass gives to neighbours 0, 1 and 2 of its steps away: those of the cubic B-spline.
const SPLINE: [f64; 3] = [0.375, 0.25, 0.0625];
/// The difference in direct light, as radiance, that counts as the edge of a shadow. Chosen by eye, as the next two.
const SHADOW_EDGE: f64 = 0.9;
/// The distance from a pixel's plane, in scene units, that counts as another surface.
const STEP_IN_DEPTH: f64 = 0.05;
/// The likeness below which two samples show different surfaces.
const ALIKE: f64 = 0.5;

impl Film {
    pub(crate) fn with_capacity<E>(size: Size) -> Result<Self, PictureError<E>> {
        let mut pixels = Vec::new();
        pixels.try_reserve_exact(size.pixels()).map_err(|_| PictureError::OutOfMemory { size })?;
        Ok(Self { size, pixels })
    }

    /// Averages over pixels that see the same smooth surface (H. Dammertz, D. Sewtz, J. Hanika and H. Lensch,
    /// Edge-Avoiding À-Trous Wavelet Transform for fast Global Illumination Filtering, High Performance Graphics 2010,
    /// <https://doi.org/10.2312/EGGH/HPG10/067-075>).
    pub(crate) fn smooth(&mut self) {
        let bounced = |pixel: &Pixel| pixel.bounced.to_array();
        for pass in 0..BOUNCED_PASSES {
            self.pass(1 << pass, bounced, |pixel, mean| pixel.bounced = mean.into(), likeness);
        }
        // On an edge, one sample stands for all four, which makes the edge ragged; a pass without regard to surfaces
        // mixes both sides there.
        let set_on_edge = |pixel: &mut Pixel, mean: [f64; 3]| {
            if pixel.is_edge {
                pixel.bounced = mean.into();
            }
        };
        self.pass(1, bounced, set_on_edge, |_, _| 1.0);
        let in_penumbra = |a: &Pixel, b: &Pixel| {
            let brightest = a.unshadowed.max_element().max(0.0);
            likeness(a, b) * falloff(brightest * (a.visibility() - b.visibility()) / SHADOW_EDGE)
        };
        for pass in 0..VISIBILITY_PASSES {
            self.pass(1 << pass, |pixel| pixel.light, |pixel, mean| pixel.light = mean, in_penumbra);
        }
    }

    /// Replaces a value of every pixel by its weighted mean over 5 x 5 pixels, `step` apart.
    fn pass<const N: usize>(
        &mut self,
        step: isize,
        value: impl Fn(&Pixel) -> [f64; N] + Sync,
        mut set: impl FnMut(&mut Pixel, [f64; N]),
        weight: impl Fn(&Pixel, &Pixel) -> f64 + Sync,
    ) {
        let (width, height) = (self.size.width as isize, self.size.height as isize);
        let mean = |index: usize| {
            let (x, y) = (index as isize % width, index as isize / width);
            let (mut sum, mut total) = ([0.0; N], 0.0);
            for (dx, dy) in (-2..=2isize).flat_map(|dy| (-2..=2isize).map(move |dx| (dx, dy))) {
                let (x, y) = (x + dx * step, y + dy * step);
                if (0..width).contains(&x) && (0..height).contains(&y) {
                    let other = &self.pixels[(y * width + x) as usize];
                    let share = SPLINE[dx.unsigned_abs()] * SPLINE[dy.unsigned_abs()];
                    let share = share * weight(&self.pixels[index], other);
                    let value = value(other);
                    sum = core::array::from_fn(|k| sum[k] + share * value[k]);
                    total += share;
                }
            }
            (total > 0.0).then(|| sum.map(|sum| sum / total))
        };
        let means: Vec<_> = (0..self.pixels.len()).into_par_iter().map(mean).collect();
        for (pixel, mean) in self.pixels.iter_mut().zip(means) {
            if let Some(mean) = mean {
                set(pixel, mean);
            }
        }
    }
}

/// How alike the surfaces of two pixels are: 1 where they lie in one plane, towards 0 as they differ.
fn likeness(a: &Pixel, b: &Pixel) -> f64 {
    let facing = a.normal.dot(b.normal).max(0.0).powi(16);
    facing * falloff(a.normal.dot(b.point - a.point) / STEP_IN_DEPTH)
}

/// A bell-shaped curve that is 1 at 0, and 0 from 1 on.
fn falloff(x: f64) -> f64 {
    (1.0 - x * x).max(0.0).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::sampling::Draws;

    /// Two walls that meet in the middle, noisy around 1 on the left and 3 on the right.
    fn corner() -> Film {
        let size = Size { width: 64, height: 48 };
        let pixels = (0..size.pixels()).map(|index| {
            let x = index % 64;
            let [noise, _] = Draws::new(index, 0).point();
            let level = if x < 32 { 1.0 } else { 3.0 };
            Pixel {
                bounced: DVec3::splat(level + noise - 0.5),
                light: [if x < 32 { noise } else { 0.0 }, 1.0],
                unshadowed: DVec3::splat(0.1),
                normal: if x < 32 { DVec3::X } else { DVec3::Z },
                ..Pixel::default()
            }
        });
        Film { size, pixels: pixels.collect() }
    }

    #[test]
    fn noise_is_smoothed_and_edges_stay() {
        let mut film = corner();
        film.smooth();
        for (index, pixel) in film.pixels.iter().enumerate() {
            let level = if index % 64 < 32 { 1.0 } else { 3.0 };
            assert!((pixel.bounced.x - level).abs() < 0.12, "pixel {index}: {} at {level}", pixel.bounced.x);
            let visibility = if index % 64 < 32 { 0.5 } else { 0.0 };
            assert!((pixel.visibility() - visibility).abs() < 0.25, "pixel {index}: {}", pixel.visibility());
        }
    }

    #[test]
    fn edge_pixels_show_both_sides() {
        let mut film = corner();
        let edge = 20 * 64 + 31;
        film.pixels[edge].is_edge = true;
        film.smooth();
        let mixed = film.pixels[edge].bounced.x;
        assert!((1.3..2.7).contains(&mixed), "{mixed} is not between 1 and 3");
    }
}
