//! Pictures: a finished image and its PNG file. `path` renders the default scene; `lit` and `false_colour` draw any
//! octree.

pub(crate) mod drawing;
pub(crate) mod false_colour;
mod lit;
pub(crate) mod meter;
pub(crate) mod path;
pub(crate) mod primary;
mod sampling;
mod smooth;
pub(crate) mod surface;
pub(crate) mod vector;
pub(crate) mod walk;

use std::io::{self, Write};

use glam::DVec3;

use crate::camera::Size;

/// A finished picture, in sRGB with 8 bits a channel.
#[derive(Debug)]
pub(crate) struct Image {
    size: Size,
    /// Row by row, from the top.
    pixels: Vec<[u8; 3]>,
}

impl Image {
    /// An image without pixels yet, but with room for all of them.
    pub(crate) fn with_capacity<E>(size: Size) -> Result<Self, PictureError<E>> {
        let mut pixels = Vec::new();
        pixels.try_reserve_exact(size.pixels()).map_err(|_| PictureError::OutOfMemory { size })?;
        Ok(Self { size, pixels })
    }

    /// Writes the picture as PNG.
    ///
    /// # Errors
    /// The errors of the writer.
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
        /// The size of the picture.
        size: Size,
    },
    /// The caller asked to stop.
    Cancelled,
}

/// The sRGB value of a linear radiance, in 8 bits a channel.
pub(crate) fn to_display(colour: DVec3) -> [u8; 3] {
    colour.to_array().map(|linear| {
        let linear = linear.clamp(0.0, 1.0);
        let encoded = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
        (encoded * 255.0 + 0.5) as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_colours_are_encoded_as_srgb() {
        assert_eq!(to_display(DVec3::new(0.0, 1.0, 2.0)), [0, 255, 255]);
        // A mid-grey, and a value from the linear part of the curve.
        assert_eq!(to_display(DVec3::new(0.215_861, 0.002, -1.0)), [128, 7, 0]);
    }
}
