//! What a check of many rays found, and how many rays it takes. The same checks judge the real tracers and the mutants.

use core::ops::Range;

use leafwalk_core::Hit;
use rayon::prelude::*;

/// How many rays were checked, and what was wrong.
#[derive(Default)]
pub struct Tally {
    /// Rays that were checked.
    pub rays: u64,
    /// The rays that hit something.
    pub hits: u64,
    /// What was wrong, over all rays.
    pub faults: u64,
    /// The fault of the smallest index: all it takes to see it again.
    pub first: Option<(u64, String)>,
}

impl Tally {
    /// Counts a ray, and whether it hit something.
    pub fn hit(&mut self, is_hit: bool) {
        self.rays += 1;
        self.hits += u64::from(is_hit);
    }

    /// Counts a fault of the ray `index`; `what` describes it.
    pub fn fault(&mut self, index: u64, what: impl FnOnce() -> String) {
        self.faults += 1;
        if self.first.as_ref().is_none_or(|(first, _)| index < *first) {
            self.first = Some((index, what()));
        }
    }

    fn join(self, other: Self) -> Self {
        let first = self.first.into_iter().chain(other.first).min_by_key(|(index, _)| *index);
        Self { rays: self.rays + other.rays, hits: self.hits + other.hits, faults: self.faults + other.faults, first }
    }

    /// Prints the counts; fails with the first fault, or when fewer than a share of the rays hit anything.
    #[track_caller]
    pub fn passes(&self, name: &str, least_hits: f64) {
        println!("{name}: {} rays, {} hits, {} faults", self.rays, self.hits, self.faults);
        if let Some((_, first)) = &self.first {
            panic!("{name}: {} faults in {} rays; the first: {first}", self.faults, self.rays);
        }
        let enough = self.rays > 0 && self.hits as f64 >= least_hits * self.rays as f64;
        assert!(enough, "{name}: {} hits in {} rays test too little", self.hits, self.rays);
    }

    /// Prints the counts; fails when the check let a mutant through.
    #[track_caller]
    pub fn catches(&self, mutant: &str) {
        println!("mutant, {mutant}: {} faults in {} rays", self.faults, self.rays);
        assert!(self.faults > 0, "the check does not notice: {mutant}");
    }
}

/// `count` times the factor that the environment variable LEAFWALK_RAYS holds, which is 1 when it is unset; at least 1.
///
/// # Panics
/// When the variable holds no number.
pub fn scaled(count: u64) -> u64 {
    let factor = std::env::var("LEAFWALK_RAYS").map_or(1.0, |factor| {
        factor.parse::<f64>().unwrap_or_else(|_| panic!("LEAFWALK_RAYS is '{factor}': give a factor such as 50"))
    });
    ((count as f64 * factor) as u64).max(1)
}

/// Rays a batch at most.
const BATCH: u64 = 4096;

/// Checks the rays of the indices below `count` in batches, on every core.
pub fn tally(count: u64, check: impl Fn(Range<u64>, &mut Tally) + Sync) -> Tally {
    // Few rays are split as well: they may be slow ones.
    let batch = count.div_ceil(64).clamp(1, BATCH);
    (0..count.div_ceil(batch))
        .into_par_iter()
        .map(|i| {
            let mut tally = Tally::default();
            check(i * batch..count.min((i + 1) * batch), &mut tally);
            tally
        })
        .reduce(Tally::default, Tally::join)
}

/// All bits of a hit.
pub fn bits(hit: &Hit) -> [u32; 4] {
    [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.primitive]
}

/// How many hits differ in any bit.
pub fn differing(hits: &[Hit], expected: &[Hit]) -> usize {
    hits.iter().zip(expected).filter(|(hit, expected)| bits(hit) != bits(expected)).count()
}

/// How many rays hit another triangle, or only one of the two hits.
pub fn others(hits: &[Hit], expected: &[Hit]) -> usize {
    hits.iter().zip(expected).filter(|(hit, expected)| hit.primitive != expected.primitive).count()
}

/// Share of random rays that a tracer which promises no bits may take to another triangle of [`crate::scenes::ORDINARY`]:
/// what the flavour `fast` of the shaders is expected to stay under.
pub const MOST_OTHERS: f64 = 1e-4;
