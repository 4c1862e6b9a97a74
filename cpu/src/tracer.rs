//! `CpuTracer`: batches of rays on every core.

use leafwalk_core::{Blocks, Frame, Hit, LengthMismatch, Octree, Ray, Tracer, Walk, Work};
use rayon::prelude::*;

use crate::batch::{Batch, Scratch, Way};
use crate::hierarchy::{Hierarchy, Source};
use crate::lanes::Registers;
use crate::question::{Closest, Occluded, Question};
use crate::single;
use crate::tile::Tiling;

/// Rays a task: enough to hide the cost of handing it out, few enough to share the work evenly.
const CHUNK: usize = 4096;

/// Traces batches over the threads of the current rayon pool; answers do not depend on how many there are.
#[derive(Clone, Debug)]
pub struct CpuTracer<W> {
    octree: Octree<W>,
    /// The octree's: to read it for each ray would take longer than the ray's first branch.
    frame: Frame,
    registers: Registers,
    tiling: Tiling,
    way: Way,
}

impl<W: AsRef<[u32]> + Sync> CpuTracer<W> {
    /// Takes an octree, owned or borrowed.
    pub fn new(octree: Octree<W>) -> Self {
        let frame = octree.frame();
        Self { octree, frame, registers: Registers::detect(), tiling: Tiling::STANDARD, way: Way::Measured }
    }

    /// With the registers that the compiler may assume alone, for tests: all give the same bits.
    #[doc(hidden)]
    #[must_use]
    pub fn portable(self) -> Self {
        Self { registers: Registers::Portable, ..self }
    }

    /// With streams however few rays there are, and however little they share, for tests.
    #[doc(hidden)]
    #[must_use]
    pub fn streamed(self) -> Self {
        Self { way: Way::Stream, ..self }
    }

    /// With rays always in flight, for tests.
    #[doc(hidden)]
    #[must_use]
    pub fn in_flight(self) -> Self {
        Self { way: Way::Flights, ..self }
    }

    /// With beams that are wider than their rays by this, in lattice units: too small, and a test has to notice.
    #[doc(hidden)]
    #[must_use]
    pub fn with_beam_margin(self, beam_margin: f32) -> Self {
        Self { tiling: Tiling { beam_margin, ..self.tiling }, ..self }
    }

    /// Whose tiles take a triangle for tested once some of their rays were tested against it: a test has to notice.
    #[doc(hidden)]
    #[must_use]
    pub fn forgetting_rays(self) -> Self {
        Self { tiling: Tiling { forgets_rays: true, ..self.tiling }, ..self }
    }

    /// The octree that is traced.
    pub fn octree(&self) -> &Octree<W> {
        &self.octree
    }

    /// The closest hit of one ray, on this thread.
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let hit = self.single::<Closest>(ray);
        (!hit.is_miss()).then_some(hit)
    }

    /// Whether one ray hits anything, on this thread.
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.single::<Occluded>(ray)
    }

    #[inline]
    fn single<Q: Question>(&self, ray: &Ray) -> Q::Answer {
        match self.octree.blocks() {
            Blocks::Packed(blocks) => {
                single::answer::<_, Q>(self.registers, &Hierarchy::new(&self.octree, self.frame, blocks), ray)
            }
            Blocks::Indexed(blocks) => {
                single::answer::<_, Q>(self.registers, &Hierarchy::new(&self.octree, self.frame, blocks), ray)
            }
        }
    }

    fn batches<Q: Question>(&self, rays: &[Ray], answers: &mut [Q::Answer]) -> Result<(), LengthMismatch> {
        match self.octree.blocks() {
            Blocks::Packed(blocks) => self.batches_in::<_, Q>(blocks, rays, answers),
            Blocks::Indexed(blocks) => self.batches_in::<_, Q>(blocks, rays, answers),
        }
    }

    fn batches_in<B: Source, Q: Question>(
        &self,
        blocks: B,
        rays: &[Ray],
        answers: &mut [Q::Answer],
    ) -> Result<(), LengthMismatch> {
        let hierarchy = &Hierarchy::new(&self.octree, self.frame, blocks);
        let Self { tiling, way, .. } = *self;
        answer(rays, answers, Scratch::new, |scratch, rays, answers| {
            self.registers.run(Batch::<B, Q> { hierarchy, tiling, way, scratch, rays, answers });
        })
    }

    /// Closest hits, each with the work it took, for heat maps and reports.
    ///
    /// # Errors
    /// When the slices differ in length.
    pub fn closest_hits_with_work(&self, rays: &[Ray], answers: &mut [(Hit, Work)]) -> Result<(), LengthMismatch> {
        let parts = self.octree.parts();
        let walk = || Walk::new(&parts);
        answer(rays, answers, walk, |walk, rays, answers| {
            for (ray, answer) in rays.iter().zip(answers) {
                let (hit, work) = walk.closest_hit_with_work(ray);
                *answer = (hit.unwrap_or(Hit::MISS), work);
            }
        })
    }
}

/// Shares rays out; `scratch` makes what a thread keeps from one task to the next.
fn answer<A: Send, S>(
    rays: &[Ray],
    answers: &mut [A],
    scratch: impl Fn() -> S + Sync + Send,
    trace: impl Fn(&mut S, &[Ray], &mut [A]) + Sync + Send,
) -> Result<(), LengthMismatch> {
    LengthMismatch::check(rays.len(), answers.len())?;
    let tasks = rays.par_chunks(CHUNK).zip(answers.par_chunks_mut(CHUNK));
    tasks.for_each_init(scratch, |scratch, (rays, answers)| trace(scratch, rays, answers));
    Ok(())
}

impl<W: AsRef<[u32]> + Sync> Tracer for CpuTracer<W> {
    type Error = LengthMismatch;

    fn closest_hits(&self, rays: &[Ray], hits: &mut [Hit]) -> Result<(), LengthMismatch> {
        self.batches::<Closest>(rays, hits)
    }

    fn occlusions(&self, rays: &[Ray], occluded: &mut [bool]) -> Result<(), LengthMismatch> {
        self.batches::<Occluded>(rays, occluded)
    }
}
