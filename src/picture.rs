//! Pictures: pixels, and the batches of rays that they are made of.

pub(crate) mod drawing;
pub(crate) mod false_colour;
mod lit;
pub(crate) mod meter;
pub(crate) mod path;
mod smooth;
pub(crate) mod surface;
pub(crate) mod vector;

use core::ops::Range;
use std::io::{self, Write};

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use crate::camera::{Camera, Size};
use leafwalk::Ray;
use vector::Vector;

/// Primary rays of a pixel, in as many cells of a square grid.
pub(crate) const SAMPLES: usize = GRID * GRID;
const GRID: usize = 2;
/// Primary rays of a batch, about: enough for every thread, few enough for the memory of a small machine.
const BATCH_RAYS: usize = 1 << 17;

/// A finished picture: rows from the top, sRGB with 8 bits a channel.
#[derive(Debug)]
pub(crate) struct Image {
    size: Size,
    pixels: Vec<[u8; 3]>,
}

impl Image {
    /// Room for the pixels of a size, none set yet.
    pub(crate) fn with_capacity<E>(size: Size) -> Result<Self, PictureError<E>> {
        let mut pixels = Vec::new();
        pixels.try_reserve_exact(size.pixels()).map_err(|_| PictureError::OutOfMemory { size })?;
        Ok(Self { size, pixels })
    }

    /// Writes the picture as PNG.
    ///
    /// # Errors
    /// Those of the writer.
    pub(crate) fn write_png(&self, writer: impl Write) -> io::Result<()> {
        let mut encoder = png::Encoder::new(writer, self.size.width, self.size.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(self.pixels.as_flattened())?;
        Ok(writer.finish()?)
    }
}

/// Why there is no picture.
#[derive(Debug)]
pub(crate) enum PictureError<E> {
    /// The tracer failed.
    Tracer(E),
    /// The pixels do not fit into memory.
    OutOfMemory {
        /// Of the picture.
        size: Size,
    },
    /// The caller asked to stop.
    Cancelled,
}

/// The pixels of each batch of a picture: whole rows, from the top.
pub(crate) fn batches(size: Size, samples: usize) -> impl ExactSizeIterator<Item = Range<usize>> {
    let width = size.width as usize;
    let rows = (BATCH_RAYS / (width * samples)).max(1);
    let batches = (size.height as usize).div_ceil(rows);
    (0..batches).map(move |batch| batch * rows * width..((batch + 1) * rows * width).min(size.pixels()))
}

/// The primary ray of a pixel through a point of its square, each coordinate 0 to 1.
pub(crate) fn primary_ray(camera: &Camera, pixel: usize, [x, y]: [f64; 2]) -> Ray {
    let width = camera.size().width as usize;
    camera.ray((pixel % width) as f64 + x, (pixel / width) as f64 + y)
}

/// Random numbers of a pixel in a wave: the same wherever and whenever they are drawn.
pub(crate) struct Draws(ChaCha8Rng);

impl Draws {
    const SEED: [u8; 32] = *b"leafwalk walks from leaf to leaf";
    /// More than a pixel draws in a wave: a block of ChaCha.
    const WORDS: u128 = 16;

    pub(crate) fn new(pixel: usize, wave: u32) -> Self {
        let mut generator = ChaCha8Rng::from_seed(Self::SEED);
        generator.set_stream(pixel as u64);
        generator.set_word_pos(u128::from(wave) * Self::WORDS);
        Self(generator)
    }

    /// A point of the unit square.
    pub(crate) fn point(&mut self) -> [f64; 2] {
        [(); 2].map(|()| f64::from(self.0.next_u32()) / 2f64.powi(32))
    }
}

/// The place of a sample in the unit square: jittered so that each cell of the grid has one, and so has each of as many
/// columns and rows as there are samples (Chiu, Shirley & Wang, Multi-Jittered Sampling, 1994).
pub(crate) fn in_cell(jitter: [f64; 2], sample: usize) -> [f64; 2] {
    let cell = [sample % GRID, sample / GRID % GRID];
    let finer = |k: usize| (cell[1 - k] as f64 + jitter[k]) / GRID as f64;
    core::array::from_fn(|k| (cell[k] as f64 + finer(k)) / GRID as f64)
}

/// The point of a sequence that covers the unit square evenly, shifted on the torus: the R2 sequence of Roberts (2018),
/// whose steps are powers of the plastic number.
pub(crate) fn spread([x, y]: [f64; 2], index: usize) -> [f64; 2] {
    const PLASTIC: f64 = 1.324_717_957_244_746;
    let steps = index as f64 / PLASTIC;
    [x + steps, y + steps / PLASTIC].map(f64::fract)
}

/// Display value of a linear radiance: sRGB, 8 bits.
pub(crate) fn to_display(colour: Vector) -> [u8; 3] {
    colour.map(|linear| {
        let linear = linear.clamp(0.0, 1.0);
        let encoded = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
        (encoded * 255.0 + 0.5) as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_cover_rows_columns_and_cells() {
        for pixel in 0..100 {
            let jitter = Draws::new(pixel, 0).point();
            let places = [0, 1, 2, 3].map(|sample| in_cell(jitter, sample));
            let taken =
                |bin: &dyn Fn([f64; 2]) -> usize| places.iter().fold(0, |taken, place| taken | 1 << bin(*place));
            assert_eq!(taken(&|[x, _]| (x * 4.0) as usize), 0b1111, "columns of {places:?}");
            assert_eq!(taken(&|[_, y]| (y * 4.0) as usize), 0b1111, "rows of {places:?}");
            assert_eq!(taken(&|[x, y]| (x * 2.0) as usize + 2 * (y * 2.0) as usize), 0b1111, "cells of {places:?}");
        }
    }

    #[test]
    fn draws_differ_between_pixels_and_waves_and_repeat() {
        let point = |pixel, wave| Draws::new(pixel, wave).point();
        assert_eq!(point(5, 1), point(5, 1));
        assert_ne!(point(5, 1), point(5, 2));
        assert_ne!(point(5, 1), point(6, 1));
        let count = 10_000;
        let sum = (0..count).fold([0.0; 2], |[x, y], pixel| {
            let [a, b] = point(pixel, 0);
            [x + a, y + b]
        });
        // The mean of so many has a deviation of 0.003.
        assert!(sum.iter().all(|sum| (sum / count as f64 - 0.5).abs() < 0.015), "{sum:?}");
    }

    #[test]
    fn batches_cover_every_pixel_once_in_whole_rows() {
        for (width, height, samples) in [(960, 720, 4), (1, 1, 4), (16384, 3, 4), (7, 16384, 1)] {
            let size = Size { width, height };
            let mut end = 0;
            for batch in batches(size, samples) {
                assert_eq!(batch.start, end);
                assert!(!batch.is_empty() && batch.end.is_multiple_of(width as usize));
                end = batch.end;
            }
            assert_eq!(end, size.pixels());
        }
    }

    #[test]
    fn linear_colours_are_encoded_as_srgb() {
        assert_eq!(to_display([0.0, 1.0, 2.0]), [0, 255, 255]);
        // Mid-grey, and one from the linear part of the curve.
        assert_eq!(to_display([0.215_861, 0.002, -1.0]), [128, 7, 0]);
    }
}
