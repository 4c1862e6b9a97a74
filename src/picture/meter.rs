//! Counting rays, and what they take.

use std::time::Instant;

use leafwalk::{CpuTracer, Hit, LengthMismatch, Ray, Tracer, Work};

/// A tracer with a count of what it answered.
pub(crate) struct Meter<'a, T> {
    tracer: &'a T,
    pub(crate) traced: Traced,
    pub(crate) primary: Primary,
}

/// Rays answered, and how long that took.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Traced {
    pub(crate) rays: u64,
    pub(crate) seconds: f64,
}

/// Primary rays, how many hit, and the work that their walks did in all.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Primary {
    pub(crate) rays: u64,
    pub(crate) hits: u64,
    pub(crate) cells: u64,
    pub(crate) blocks: u64,
}

impl<'a, T> Meter<'a, T> {
    pub(crate) fn new(tracer: &'a T) -> Self {
        Self { tracer, traced: Traced::default(), primary: Primary::default() }
    }

    fn measure<E>(&mut self, rays: usize, trace: impl FnOnce(&T) -> Result<(), E>) -> Result<(), E> {
        let start = Instant::now();
        trace(self.tracer)?;
        self.traced.seconds += start.elapsed().as_secs_f64();
        self.traced.rays += rays as u64;
        Ok(())
    }
}

impl<T: Tracer> Meter<'_, T> {
    pub(crate) fn closest_hits(&mut self, rays: &[Ray]) -> Result<Vec<Hit>, T::Error> {
        let mut hits = vec![Hit::MISS; rays.len()];
        self.measure(rays.len(), |tracer| tracer.closest_hits(rays, &mut hits))?;
        Ok(hits)
    }

    pub(crate) fn occlusions(&mut self, rays: &[Ray]) -> Result<Vec<bool>, T::Error> {
        let mut occluded = vec![false; rays.len()];
        self.measure(rays.len(), |tracer| tracer.occlusions(rays, &mut occluded))?;
        Ok(occluded)
    }
}

/// A tracer that counts what each ray takes.
pub(crate) trait Worked: Tracer {
    /// Closest hits, each with its work.
    ///
    /// # Errors
    /// As [`Tracer::closest_hits`].
    fn closest_hits_with_work(&self, rays: &[Ray], answers: &mut [(Hit, Work)]) -> Result<(), Self::Error>;
}

impl<W: AsRef<[u32]> + Sync> Worked for CpuTracer<W> {
    fn closest_hits_with_work(&self, rays: &[Ray], answers: &mut [(Hit, Work)]) -> Result<(), LengthMismatch> {
        self.closest_hits_with_work(rays, answers)
    }
}

impl<T: Worked> Meter<'_, T> {
    /// Closest hits of primary rays, with the work of each.
    pub(crate) fn primary_hits(&mut self, rays: &[Ray]) -> Result<Vec<(Hit, Work)>, T::Error> {
        let mut answers = vec![(Hit::MISS, Work::default()); rays.len()];
        self.measure(rays.len(), |tracer| tracer.closest_hits_with_work(rays, &mut answers))?;
        for (hit, work) in &answers {
            self.primary.rays += 1;
            self.primary.hits += u64::from(!hit.is_miss());
            self.primary.cells += u64::from(work.cells);
            self.primary.blocks += u64::from(work.blocks);
        }
        Ok(answers)
    }
}
