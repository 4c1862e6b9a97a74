//! `CpuTracer`: batches of rays on every core.

use core::cell::RefCell;
use core::fmt;

use leafwalk_core::canonical::PreparedFrame;
use leafwalk_core::{Clock, Hit, HitF64, Leaf, LengthMismatch, Nearest, Octree, Ray, RayF64, Tracer};
use rayon::prelude::*;

use crate::lanes::Registers;
use crate::trace::bvh::{BlockSource, Bvh, with_blocks};
use crate::trace::query::{AnyHit, ClosestHit, Query};
use crate::trace::{Batch, Leaves, Scratch, Tiling, Way, single};

/// Rays a task: enough to hide the cost of handing it out, few enough to share the work evenly.
const TASK: usize = 4096;

/// Traces batches over the threads of the current rayon pool; answers do not depend on how many there are.
#[derive(Clone)]
pub struct CpuTracer<W> {
    octree: Octree<W>,
    /// The octree's frame: to read it for each ray would take longer than the ray's first node.
    frame: PreparedFrame,
    pub(crate) registers: Registers,
    pub(crate) tiling: Tiling,
    way: Way,
}

impl<W: AsRef<[u32]> + Sync> CpuTracer<W> {
    /// Takes an octree, owned or borrowed.
    pub fn new(octree: Octree<W>) -> Self {
        let frame = octree.frame().prepare();
        Self { octree, frame, registers: Registers::detect(), tiling: Tiling::STANDARD, way: Way::Auto }
    }

    /// The same tracer, whose batches are traced in this way. Single calls are not.
    ///
    /// [`Way::Auto`] is seldom far from the fastest; who knows the rays may know better, and tests and measurements of one
    /// way ask for it.
    #[must_use]
    pub fn with_way(self, way: Way) -> Self {
        Self { way, ..self }
    }

    /// The octree that is traced.
    pub fn octree(&self) -> &Octree<W> {
        &self.octree
    }

    /// The closest hit of one ray, on this thread.
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.single::<ClosestHit>(ray).ok()
    }

    /// Whether one ray hits anything, on this thread.
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.single::<AnyHit>(ray)
    }

    /// As [`Tracer::closest_hits`] by [`Way::Walk`], for rays that may start in leaves that are known; and the leaves in which
    /// their walks ended, [`Leaf::UNKNOWN`] where there was nothing to walk through. See [`Leaf`].
    ///
    /// Of rays beyond the end of `known` nothing is known, so it may be empty. A walk is a little faster from a known leaf;
    /// where other ways are much faster than walks, as they are for most rays, they stay so.
    ///
    /// ```
    /// # use leafwalk_core::{Hit, Leaf, Ray};
    /// # use leafwalk_cpu::{Builder, CpuTracer, Mesh};
    /// let floor = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let ceiling = floor.map(|[x, y, _]| [x, y, 1.0]);
    /// let mesh = Mesh::new([floor, ceiling].concat(), vec![[0, 1, 2], [3, 4, 5]]);
    /// let tracer = CpuTracer::new(Builder::for_walks().build(&mesh)?);
    /// let (mut hits, mut ends) = ([Hit::MISS], [Leaf::UNKNOWN]);
    /// tracer.closest_hits_from(&[Ray::new([0.25, 0.25, 0.5], [0.0, 0.0, -1.0])], &[], &mut hits, &mut ends)?;
    /// assert_eq!(hits[0].primitive, 0);
    ///
    /// // What leaves a hit begins where the walk to the hit ended.
    /// let up = hits[0].spawn(&tracer.octree().frame(), &mesh.corners(0), [0.0, 0.0, 1.0]);
    /// let known = ends;
    /// tracer.closest_hits_from(&[up], &known, &mut hits, &mut ends)?;
    /// assert_eq!(hits[0].primitive, 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When `hits` or `ends` is not as long as `rays`.
    pub fn closest_hits_from(
        &self,
        rays: &[Ray],
        known: &[Leaf],
        hits: &mut [Hit],
        ends: &mut [Leaf],
    ) -> Result<(), LengthMismatch> {
        LengthMismatch::check(rays.len(), ends.len())?;
        self.borrowed().with_way(Way::Walk).find_closest(rays, Leaves { known, ends }, hits)
    }

    /// As [`Tracer::occlusions`] by [`Way::Walk`], for rays that may start in leaves that are known.
    ///
    /// # Errors
    /// When `occluded` is not as long as `rays`.
    pub fn occlusions_from(&self, rays: &[Ray], known: &[Leaf], occluded: &mut [bool]) -> Result<(), LengthMismatch> {
        self.borrowed().with_way(Way::Walk).find_any(rays, Leaves { known, ends: &mut [] }, occluded)
    }

    /// The closest hit of one ray in f64, on this thread: `t_min < t < t_max` holds for the t of the answer.
    pub fn closest_hit_f64(&self, ray: &RayF64) -> Option<HitF64> {
        self.borrowed().find_closest_f64(ray).ok()
    }

    /// Whether one ray in f64 hits anything, on this thread.
    pub fn occluded_f64(&self, ray: &RayF64) -> bool {
        self.borrowed().find_any_f64(ray)
    }

    /// As [`Tracer::closest_hits`], in f64. Rays of f64 are traced one by one, which takes longer than rays of f32 do.
    ///
    /// # Errors
    /// When the slices differ in length.
    pub fn closest_hits_f64(&self, rays: &[RayF64], hits: &mut [HitF64]) -> Result<(), LengthMismatch> {
        self.borrowed().each_f64(rays, hits, |tracer, ray| tracer.find_closest_f64(ray))
    }

    /// As [`Tracer::occlusions`], in f64, one by one likewise.
    ///
    /// # Errors
    /// When the slices differ in length.
    pub fn occlusions_f64(&self, rays: &[RayF64], occluded: &mut [bool]) -> Result<(), LengthMismatch> {
        self.borrowed().each_f64(rays, occluded, |tracer, ray| tracer.find_any_f64(ray))
    }

    #[inline]
    fn single<Q: Query>(&self, ray: &Ray) -> Q::Answer {
        with_blocks!(self.octree, blocks => {
            single::answer::<_, Q>(self.registers, &Bvh::new(&self.octree, self.frame, blocks), ray)
        })
    }

    fn borrowed(&self) -> CpuTracer<&[u32]> {
        let Self { ref octree, frame, registers, tiling, way } = *self;
        CpuTracer { octree: octree.view(), frame, registers, tiling, way }
    }
}

/// What every batch comes to, whatever holds the words.
///
/// The first two have no type parameter, so the kernels are compiled here, once. They take most of a minute to compile,
/// and each crate that traces would compile them anew.
impl CpuTracer<&[u32]> {
    fn find_closest(&self, rays: &[Ray], leaves: Leaves<'_>, hits: &mut [Hit]) -> Result<(), LengthMismatch> {
        self.batches::<ClosestHit>(rays, leaves, hits)
    }

    fn find_any(&self, rays: &[Ray], leaves: Leaves<'_>, occluded: &mut [bool]) -> Result<(), LengthMismatch> {
        self.batches::<AnyHit>(rays, leaves, occluded)
    }

    fn find_closest_f64(&self, ray: &RayF64) -> HitF64 {
        self.nearest_f64::<ClosestHit>(ray).map_or(HitF64::MISS, |(nearest, clock)| nearest.hit_f64(&clock))
    }

    fn find_any_f64(&self, ray: &RayF64) -> bool {
        self.nearest_f64::<AnyHit>(ray).is_some_and(|(nearest, _)| nearest.is_hit())
    }

    /// What one ray finds, and the clock of its t.
    fn nearest_f64<Q: Query>(&self, ray: &RayF64) -> Option<(Nearest, Clock)> {
        let ray = self.frame.frame().canonical_f64(ray)?;
        let nearest = with_blocks!(self.octree, blocks => {
            single::nearest::<_, Q>(self.registers, &Bvh::new(&self.octree, self.frame, blocks), &ray)
        });
        Some((nearest, ray.clock))
    }

    /// Answers each ray by itself, over the threads of the current rayon pool.
    fn each_f64<A: Send>(
        &self,
        rays: &[RayF64],
        answers: &mut [A],
        answer: impl Fn(&Self, &RayF64) -> A + Sync,
    ) -> Result<(), LengthMismatch> {
        LengthMismatch::check(rays.len(), answers.len())?;
        let pairs = rays.par_iter().zip(answers).with_min_len(TASK);
        pairs.for_each(|(ray, slot)| *slot = answer(self, ray));
        Ok(())
    }

    fn batches<Q: Query>(
        &self,
        rays: &[Ray],
        leaves: Leaves<'_>,
        answers: &mut [Q::Answer],
    ) -> Result<(), LengthMismatch> {
        with_blocks!(self.octree, blocks => self.batches_in::<_, Q>(blocks, rays, leaves, answers))
    }

    fn batches_in<B: BlockSource, Q: Query>(
        &self,
        blocks: B,
        rays: &[Ray],
        leaves: Leaves<'_>,
        answers: &mut [Q::Answer],
    ) -> Result<(), LengthMismatch> {
        // A new scratch would have to be filled for each batch.
        thread_local!(static SCRATCH: RefCell<Scratch> = const { RefCell::new(Scratch::new()) });
        LengthMismatch::check(rays.len(), answers.len())?;
        let bvh = &Bvh::new(&self.octree, self.frame, blocks);
        let Self { ref octree, tiling, way, .. } = *self;
        let tasks = rays.par_chunks(TASK).zip(answers.par_chunks_mut(TASK)).zip(leaves.par_chunks(TASK, rays.len()));
        tasks.for_each(|((rays, answers), leaves)| {
            SCRATCH.with_borrow_mut(|scratch| {
                self.registers.run(Batch::<B, Q> { octree, bvh, tiling, way, scratch, rays, leaves, answers });
            });
        });
        Ok(())
    }
}

impl<W: AsRef<[u32]> + Sync> Tracer for CpuTracer<W> {
    type Error = LengthMismatch;

    fn closest_hits(&self, rays: &[Ray], hits: &mut [Hit]) -> Result<(), LengthMismatch> {
        self.borrowed().find_closest(rays, Leaves::default(), hits)
    }

    fn occlusions(&self, rays: &[Ray], occluded: &mut [bool]) -> Result<(), LengthMismatch> {
        self.borrowed().find_any(rays, Leaves::default(), occluded)
    }
}

/// Counts instead of words, of which there may be millions.
impl<W: AsRef<[u32]>> fmt::Debug for CpuTracer<W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("CpuTracer")
            .field("octree", &self.octree)
            .field("registers", &self.registers)
            .finish_non_exhaustive()
    }
}
