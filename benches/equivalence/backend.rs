//! `Backend`: a way to trace, what it promises of its answers, and how they compare.

use std::time::Instant;

use leafwalk::{Hit, LengthMismatch, Ray, Tracer};
use leafwalk_testing::tally::{MOST_OTHERS, differing, others};
use leafwalk_testing::tracers::Flipped;
use leafwalk_testing::workloads::Workload;
use rayon::ThreadPool;

use crate::fail;
use crate::report::Row;
use crate::scene::Expected;

/// What the contract promises of a backend's answers.
#[cfg_attr(not(feature = "gpu"), allow(dead_code, reason = "only GPUs promise less than all bits"))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Promise {
    /// Every bit, and as many cells where they are counted.
    Bits,
    /// No bit, but that hardly any random ray hits another triangle.
    Triangles,
    /// Any answer keeps it.
    Nothing,
}

/// A tracer of any kind, whose failures end the bench.
type Erased<'a> = Box<dyn Tracer<Error = LengthMismatch> + Sync + 'a>;

/// The cells that each ray visits, counted along with its hit.
pub(crate) type Cells<'a> = Box<dyn Fn(&[Ray]) -> (Vec<Hit>, Vec<u32>) + 'a>;

/// A way to trace.
pub(crate) struct Backend<'a> {
    pub(crate) name: String,
    pub(crate) promise: Promise,
    tracer: Erased<'a>,
    cells: Option<Cells<'a>>,
    /// Threads of a batch: one or two.
    pub(crate) threads: usize,
    /// Rays of each kind that it traces, evenly picked where there are more.
    pub(crate) most_rays: usize,
}

impl<'a> Backend<'a> {
    pub(crate) fn new(name: String, promise: Promise, tracer: impl Tracer + Sync + 'a) -> Self {
        let tracer = Box::new(Unfailing(tracer));
        Self { name, promise, tracer, cells: None, threads: 1, most_rays: usize::MAX }
    }

    /// A backend that gives every bit.
    pub(crate) fn exact(name: impl Into<String>, tracer: impl Tracer + Sync + 'a) -> Self {
        Self::new(name.into(), Promise::Bits, tracer)
    }

    /// The same backend, which counts the cells of each ray, too.
    pub(crate) fn counting(self, cells: impl Fn(&[Ray]) -> (Vec<Hit>, Vec<u32>) + 'a) -> Self {
        Self { cells: Some(Box::new(cells)), ..self }
    }

    /// The same backend, of whose answers one bit is wrong.
    pub(crate) fn flipped(self) -> Self {
        Self { name: format!("{}, flipped", self.name), tracer: Box::new(Flipped(self.tracer)), ..self }
    }

    /// Traces rays of a kind, closest hits and occlusions, and counts what differs.
    pub(crate) fn compare(&self, pools: &Pools, workload: &Workload, expected: &Expected) -> Row {
        let stride = workload.rays.len().div_ceil(self.most_rays);
        let some = |hits: &[Hit]| -> Vec<Hit> { hits.iter().step_by(stride).copied().collect() };
        let rays: Vec<Ray> = workload.rays.iter().step_by(stride).copied().collect();
        let (expected_hits, mut hits) = (some(&expected.hits), vec![Hit::MISS; rays.len()]);
        let mut occluded = vec![false; rays.len()];
        let (tracer, pool) = (&self.tracer, &pools.0[self.threads - 1]);
        let timed = |trace: &mut (dyn FnMut() -> Result<(), LengthMismatch> + Send)| {
            let start = Instant::now();
            pool.install(trace).expect("equal lengths");
            start.elapsed()
        };
        let of_hits = timed(&mut || tracer.closest_hits(&rays, &mut hits));
        let of_occlusions = timed(&mut || tracer.occlusions(&rays, &mut occluded));
        let wrong_occlusions = occluded.iter().zip(&expected_hits).filter(|(is, hit)| **is == hit.is_miss()).count();
        let mut row = Row {
            rays_of: workload.name,
            rays: rays.len(),
            threads: self.threads,
            hash: leafwalk::hit_hash(&hits),
            differing: differing(&hits, &expected_hits),
            wrong_occlusions,
            other_cells: 0,
            cells: None,
            time: if workload.is_occlusion { of_occlusions } else { of_hits },
            breaks: 0,
        };
        if let Some(cells) = &self.cells {
            let (again, cells) = cells(&rays);
            row.differing = row.differing.max(differing(&again, &expected_hits));
            let expected = expected.cells.iter().step_by(stride);
            row.other_cells = cells.iter().zip(expected).filter(|(found, expected)| found != expected).count();
            row.cells = Some(cells.iter().map(|cells| u64::from(*cells)).sum());
        }
        let others = others(&hits, &expected_hits);
        row.breaks = match self.promise {
            Promise::Bits => row.differing + row.wrong_occlusions + row.other_cells,
            Promise::Triangles if workload.name == "R" && others as f64 > MOST_OTHERS * rays.len() as f64 => others,
            Promise::Triangles | Promise::Nothing => 0,
        };
        row
    }
}

/// Pools of one thread and of two.
pub(crate) struct Pools([ThreadPool; 2]);

impl Pools {
    pub(crate) fn new() -> Self {
        let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        Self([pool(1), pool(2)])
    }
}

/// A tracer whose failure ends the bench.
struct Unfailing<T>(T);

impl<T: Tracer> Tracer for Unfailing<T> {
    type Error = LengthMismatch;

    fn closest_hits(&self, rays: &[Ray], hits: &mut [Hit]) -> Result<(), LengthMismatch> {
        self.0.closest_hits(rays, hits).unwrap_or_else(|error| fail(&error.to_string()));
        Ok(())
    }

    fn occlusions(&self, rays: &[Ray], occluded: &mut [bool]) -> Result<(), LengthMismatch> {
        self.0.occlusions(rays, occluded).unwrap_or_else(|error| fail(&error.to_string()));
        Ok(())
    }
}
