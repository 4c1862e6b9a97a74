//! Random numbers keyed by seed and index, so that a case depends on neither threads nor order.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// The random numbers of one case: those of the stream `index` of ChaCha8 under `seed`.
pub struct Random {
    rng: ChaCha8Rng,
    seed: u64,
    index: u64,
}

impl Random {
    /// The numbers of the case `index` under `seed`.
    pub fn new(seed: u64, index: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(index);
        Self { rng, seed, index }
    }

    /// Numbers that all cases of a run share, when each run has `length` cases in a row.
    pub fn of_run(&self, length: u64) -> Self {
        Self::new(self.seed.wrapping_add(1 << 32), self.index / length)
    }

    /// 32 random bits.
    pub fn bits(&mut self) -> u32 {
        self.rng.next_u32()
    }

    /// A number in 0..1, a multiple of 2^-24.
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / (1 << 24) as f32
    }

    /// A number in -1..1.
    pub fn signed(&mut self) -> f32 {
        2.0 * self.unit() - 1.0
    }

    /// An integer in 0..n.
    pub fn below(&mut self, n: usize) -> usize {
        ((u64::from(self.bits()) * n as u64) >> 32) as usize
    }

    /// A point in the cube -1..1.
    pub fn vector(&mut self) -> [f32; 3] {
        core::array::from_fn(|_| self.signed())
    }

    /// A direction whose length is between 0.1 and 1.
    pub fn direction(&mut self) -> [f32; 3] {
        loop {
            let d = self.vector();
            let squared: f32 = d.iter().map(|c| c * c).sum();
            if squared > 0.01 && squared <= 1.0 {
                return d;
            }
        }
    }

    /// `x` or one of the two floats next to it.
    pub fn nudge(&mut self, x: f32) -> f32 {
        match self.below(3) {
            0 => x.next_down(),
            1 => x,
            _ => x.next_up(),
        }
    }
}
