//! The meter of a picture: it counts the rays and the time that tracing them takes.

use std::time::Instant;

use leafwalk::{Hit, Octree, Ray, Tracer, Work};

use super::walk::{Walked, closest_hits_with_work};

/// A tracer that counts the rays it answers.
pub(crate) struct Meter<'a, T> {
    tracer: &'a T,
    pub(crate) traced: Traced,
    pub(crate) primary: Primary,
    /// The work that [`Meter::primary_walks`] counted.
    pub(crate) walked: Walked,
}

/// How many rays of every kind were answered, and the time that took.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Traced {
    pub(crate) rays: u64,
    pub(crate) seconds: f64,
}

/// How many primary rays were answered, and how many of them hit.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Primary {
    pub(crate) rays: u64,
    pub(crate) hits: u64,
}

impl<'a, T> Meter<'a, T> {
    pub(crate) fn new(tracer: &'a T) -> Self {
        Self { tracer, traced: Traced::default(), primary: Primary::default(), walked: Walked::default() }
    }

    /// Runs `trace` and counts it as so many rays.
    fn measure<A>(&mut self, rays: usize, trace: impl FnOnce(&T) -> A) -> A {
        let start = Instant::now();
        let answers = trace(self.tracer);
        self.traced.seconds += start.elapsed().as_secs_f64();
        self.traced.rays += rays as u64;
        answers
    }

    /// Closest hits of primary rays, each with its work, by the counted walk through an octree instead of the tracer.
    pub(crate) fn primary_walks<W: AsRef<[u32]> + Sync>(
        &mut self,
        octree: &Octree<W>,
        rays: &[Ray],
    ) -> Vec<(Hit, Work)> {
        let answers = self.measure(rays.len(), |_| closest_hits_with_work(octree, rays));
        self.primary.add(answers.iter().map(|(hit, _)| hit));
        self.walked.add(&answers);
        answers
    }
}

impl<T: Tracer> Meter<'_, T> {
    pub(crate) fn closest_hits(&mut self, rays: &[Ray]) -> Result<Vec<Hit>, T::Error> {
        let mut hits = vec![Hit::MISS; rays.len()];
        self.measure(rays.len(), |tracer| tracer.closest_hits(rays, &mut hits))?;
        Ok(hits)
    }

    /// Closest hits of primary rays.
    pub(crate) fn primary_hits(&mut self, rays: &[Ray]) -> Result<Vec<Hit>, T::Error> {
        let hits = self.closest_hits(rays)?;
        self.primary.add(hits.iter());
        Ok(hits)
    }

    pub(crate) fn occlusions(&mut self, rays: &[Ray]) -> Result<Vec<bool>, T::Error> {
        let mut occluded = vec![false; rays.len()];
        self.measure(rays.len(), |tracer| tracer.occlusions(rays, &mut occluded))?;
        Ok(occluded)
    }
}

impl Primary {
    fn add<'h>(&mut self, answers: impl ExactSizeIterator<Item = &'h Hit>) {
        self.rays += answers.len() as u64;
        self.hits += answers.filter(|hit| !hit.is_miss()).count() as u64;
    }
}
