//! `CpuTracer`: batches of rays on every core.

use leafwalk_core::{Hit, LengthMismatch, Octree, Ray, Tracer, Walk, Work};
use rayon::prelude::*;

use crate::lanes::Registers;
use crate::single::Single;

/// Rays a task: enough to hide the cost of handing it out, few enough to share the work evenly.
const CHUNK: usize = 4096;

/// Traces batches over the threads of the current rayon pool; answers do not depend on how many there are.
#[derive(Clone, Debug)]
pub struct CpuTracer<W> {
    octree: Octree<W>,
    registers: Registers,
}

impl<W: AsRef<[u32]> + Sync> CpuTracer<W> {
    /// Takes an octree, owned or borrowed.
    pub fn new(octree: Octree<W>) -> Self {
        Self { octree, registers: Registers::detect() }
    }

    /// The octree that is traced.
    pub fn octree(&self) -> &Octree<W> {
        &self.octree
    }

    /// The closest hit of one ray, on this thread.
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let hit = Single::new(&self.octree.parts(), self.registers).closest_hit(ray);
        (!hit.is_miss()).then_some(hit)
    }

    /// Whether one ray hits anything, on this thread.
    pub fn occluded(&self, ray: &Ray) -> bool {
        Single::new(&self.octree.parts(), self.registers).occluded(ray)
    }

    /// Closest hits, each with the work it took, for heat maps and reports.
    ///
    /// # Errors
    /// When the slices differ in length.
    pub fn closest_hits_with_work(&self, rays: &[Ray], answers: &mut [(Hit, Work)]) -> Result<(), LengthMismatch> {
        let parts = self.octree.parts();
        answer(rays, answers, |ray| {
            let (hit, work) = Walk::new(&parts).closest_hit_with_work(ray);
            (hit.unwrap_or(Hit::MISS), work)
        })
    }
}

fn answer<A: Send>(rays: &[Ray], answers: &mut [A], trace: impl Fn(&Ray) -> A + Sync) -> Result<(), LengthMismatch> {
    LengthMismatch::check(rays.len(), answers.len())?;
    rays.par_chunks(CHUNK).zip(answers.par_chunks_mut(CHUNK)).for_each(|(rays, answers)| {
        for (ray, answer) in rays.iter().zip(answers) {
            *answer = trace(ray);
        }
    });
    Ok(())
}

impl<W: AsRef<[u32]> + Sync> Tracer for CpuTracer<W> {
    type Error = LengthMismatch;

    fn closest_hits(&self, rays: &[Ray], hits: &mut [Hit]) -> Result<(), LengthMismatch> {
        let parts = self.octree.parts();
        let single = Single::new(&parts, self.registers);
        answer(rays, hits, |ray| single.closest_hit(ray))
    }

    fn occlusions(&self, rays: &[Ray], occluded: &mut [bool]) -> Result<(), LengthMismatch> {
        let parts = self.octree.parts();
        let single = Single::new(&parts, self.registers);
        answer(rays, occluded, |ray| single.occluded(ray))
    }
}
