//! Random numbers that are the same in every run of the program, and the ways in which they spread samples.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// How many samples a pixel has where edges are smoothed: one in each cell of a square grid.
pub(crate) const SAMPLES: usize = GRID * GRID;
const GRID: usize = 2;

/// The seed of every stream of random numbers here.
const SEED: [u8; 32] = *b"leafwalk walks from leaf to leaf";
/// The stream of [`stratified`]. No pixel draws from it, since pixels are numbered in 32 bits.
const STRATA_STREAM: u64 = u64::MAX;

/// Random numbers of a pixel in a wave of rays: the same wherever and whenever they are drawn.
pub(crate) struct Draws(ChaCha8Rng);

impl Draws {
    /// Words of the stream that each wave has for itself: a block of ChaCha, more than a pixel draws in a wave.
    const WORDS: u128 = 16;

    pub(crate) fn new(pixel: usize, wave: u32) -> Self {
        let mut generator = ChaCha8Rng::from_seed(SEED);
        generator.set_stream(pixel as u64);
        generator.set_word_pos(u128::from(wave) * Self::WORDS);
        Self(generator)
    }

    /// A point of the unit square.
    pub(crate) fn point(&mut self) -> [f64; 2] {
        [(); 2].map(|()| f64::from(self.0.next_u32()) / 2f64.powi(32))
    }
}

/// The place of a sample in the unit square, moved by a jitter that the samples of a pixel share. Each cell of the grid
/// holds one sample, and so does each of as many columns and rows as there are samples (K. Chiu, P. Shirley and C.
/// Wang, Multi-Jittered Sampling, Graphics Gems IV, 1994).
pub(crate) fn in_cell(jitter: [f64; 2], sample: usize) -> [f64; 2] {
    let cell = [sample % GRID, sample / GRID % GRID];
    let finer = |k: usize| (cell[1 - k] as f64 + jitter[k]) / GRID as f64;
    core::array::from_fn(|k| (cell[k] as f64 + finer(k)) / GRID as f64)
}

/// The point of a number in a sequence that covers the unit square evenly from any start: the R2 sequence, whose steps
/// are powers of the plastic number (M. Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018,
/// <https://extremelearning.com.au/unreasonable-effectiveness-of-quasirandom-sequences/>).
pub(crate) fn spread([x, y]: [f64; 2], index: usize) -> [f64; 2] {
    const PLASTIC: f64 = 1.324_717_957_244_746;
    let steps = index as f64 / PLASTIC;
    [x + steps, y + steps / PLASTIC].map(f64::fract)
}

/// A sample of `most` of the numbers below `total`, in order, or all of them where there are fewer. The numbers are cut
/// into as many runs of nearly equal length, and one number of each run is drawn.
pub(crate) fn stratified(total: usize, most: usize) -> impl ExactSizeIterator<Item = usize> {
    let runs = total.min(most);
    let mut generator = ChaCha8Rng::from_seed(SEED);
    generator.set_stream(STRATA_STREAM);
    let start = move |run: usize| (run as u128 * total as u128 / runs as u128) as usize;
    (0..runs).map(move |run| {
        let length = start(run + 1) - start(run);
        start(run) + ((u128::from(generator.next_u32()) * length as u128) >> 32) as usize
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
    fn every_run_of_numbers_has_one_in_the_sample() {
        for (total, most) in [(0, 4), (3, 4), (4, 4), (7, 4), (1 << 30, 4096), (691_200, 4096)] {
            let sample: Vec<usize> = stratified(total, most).collect();
            assert_eq!(sample, stratified(total, most).collect::<Vec<_>>(), "another sample in another run");
            let runs = total.min(most);
            assert_eq!(sample.len(), runs);
            for (run, number) in sample.into_iter().enumerate() {
                assert!((run * total / runs..(run + 1) * total / runs).contains(&number), "{number} of run {run}");
            }
        }
    }
}
