//! The primary rays of a picture: which rays leave the camera, numbered pixel by pixel.

use core::ops::Range;

use leafwalk::Ray;
use rayon::prelude::*;

use super::sampling::{Draws, SAMPLES, in_cell, stratified};
use crate::camera::Camera;

/// About how many primary rays a batch has: enough for every thread, few enough for the memory of a small machine.
const BATCH_RAYS: usize = 1 << 17;

/// The rays that leave the camera, numbered along the rows of pixels from the top, and within a pixel by its samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PrimaryRays<'a> {
    camera: &'a Camera,
    /// How many rays a pixel has: one, or [`SAMPLES`].
    samples: usize,
}

impl<'a> PrimaryRays<'a> {
    /// One ray through the middle of each pixel.
    pub(crate) fn through_middles(camera: &'a Camera) -> Self {
        Self { camera, samples: 1 }
    }

    /// [`SAMPLES`] rays through jittered places of each pixel.
    pub(crate) fn jittered(camera: &'a Camera) -> Self {
        Self { camera, samples: SAMPLES }
    }

    /// How many rays there are in all.
    pub(crate) fn count(&self) -> usize {
        self.camera.size().pixels() * self.samples
    }

    /// The ray of a number below [`PrimaryRays::count`].
    pub(crate) fn ray(&self, number: usize) -> Ray {
        let pixel = number / self.samples;
        let [x, y] = if self.samples == 1 { [0.5; 2] } else { in_cell(Draws::new(pixel, 0).point(), number) };
        let width = self.camera.size().width as usize;
        self.camera.ray((pixel % width) as f64 + x, (pixel / width) as f64 + y)
    }

    /// The rays of a range of pixels.
    pub(crate) fn through(&self, pixels: &Range<usize>) -> Vec<Ray> {
        let numbers = pixels.start * self.samples..pixels.end * self.samples;
        numbers.into_par_iter().map(|number| self.ray(number)).collect()
    }

    /// A sample of `most` rays, or all where there are fewer. It is spread evenly over the picture and always the same
    /// for the same camera.
    pub(crate) fn sample(&self, most: usize) -> Vec<Ray> {
        stratified(self.count(), most).map(|number| self.ray(number)).collect()
    }

    /// The pixels of each batch of rays. A batch is made of whole rows, and the first has the top row.
    pub(crate) fn batches(&self) -> impl ExactSizeIterator<Item = Range<usize>> + use<> {
        let size = self.camera.size();
        let width = size.width as usize;
        let rows = (BATCH_RAYS / (width * self.samples)).max(1);
        let batches = (size.height as usize).div_ceil(rows);
        (0..batches).map(move |batch| batch * rows * width..((batch + 1) * rows * width).min(size.pixels()))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::camera::{Size, View};

    fn camera(width: u32, height: u32) -> Camera {
        let view = View { eye: DVec3::new(0.0, 0.0, 5.0), at: DVec3::ZERO, up: View::UP, fov: 40.0 };
        Camera::new(&view, Size { width, height }).expect("a camera")
    }

    #[test]
    fn batches_cover_every_pixel_once_in_whole_rows() {
        for (width, height) in [(960, 720), (1, 1), (16384, 3), (7, 16384)] {
            let camera = camera(width, height);
            for primary in [PrimaryRays::through_middles(&camera), PrimaryRays::jittered(&camera)] {
                let mut end = 0;
                for batch in primary.batches() {
                    assert_eq!(batch.start, end);
                    assert!(!batch.is_empty() && batch.end.is_multiple_of(width as usize));
                    end = batch.end;
                }
                assert_eq!(end, camera.size().pixels());
            }
        }
    }

    #[test]
    fn batches_and_samples_are_made_of_the_numbered_rays() {
        let camera = camera(40, 30);
        for primary in [PrimaryRays::through_middles(&camera), PrimaryRays::jittered(&camera)] {
            let all: Vec<Ray> = (0..primary.count()).map(|number| primary.ray(number)).collect();
            let batches: Vec<Ray> = primary.batches().flat_map(|pixels| primary.through(&pixels)).collect();
            assert_eq!(batches, all);
            assert_eq!(primary.sample(all.len()), all, "a sample of all is all");
            let mut rest = all.iter();
            let sample = primary.sample(100);
            assert_eq!(sample.len(), 100);
            assert!(sample.iter().all(|ray| rest.any(|known| known == ray)), "a sample in order, without repetition");
        }
    }
}
