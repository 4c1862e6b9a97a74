//! The backends on the CPU: testing every triangle, the scalar walk, and each way of the eight-lane machine by itself, in
//! each kind of registers, over the packed octree and the compact one.

use leafwalk::{BruteForce, CpuTracer, Hit, Octree, Parts, Walk, Way};
use leafwalk_core::step::Pluecker;
use leafwalk_core::testing::Standard;
use leafwalk_cpu::testing;
use leafwalk_testing::tracers::{OneByOne, Stepping};

use crate::backend::Backend;
use crate::scene::Scene;

/// Triangle tests of brute force for a kind of rays: where all rays would take more, some stand for them.
const MOST_TESTS: usize = 1 << 22;
/// As many rays as it is asked at least, however large the mesh.
const LEAST_RAYS: usize = 64;

/// A tracer by the registers that it runs on.
type InRegisters<'a> = (&'static str, CpuTracer<&'a [u32]>);

/// What the backends of the CPU trace with.
pub(crate) struct Tracers<'a> {
    octree: &'a Octree<Vec<u32>>,
    compact: &'a Octree<Vec<u32>>,
    parts: Parts<'a>,
    brute_force: BruteForce,
    batches: Vec<InRegisters<'a>>,
    compact_batches: Vec<InRegisters<'a>>,
}

impl<'a> Tracers<'a> {
    pub(crate) fn new(scene: &'a Scene) -> Self {
        let Scene { octree, compact, mesh, .. } = scene;
        let batches = |octree: &'a Octree<Vec<u32>>| testing::in_all_registers(&CpuTracer::new(octree.view()));
        Self {
            octree,
            compact,
            parts: octree.parts(),
            brute_force: BruteForce::new(mesh).expect("a mesh that was built"),
            batches: batches(octree),
            compact_batches: batches(compact),
        }
    }

    /// Every backend of the CPU.
    pub(crate) fn backends(&self) -> Vec<Backend<'_>> {
        let mut brute_force = Backend::exact("brute force", &self.brute_force);
        brute_force.most_rays = (MOST_TESTS / testing::triangles(&self.brute_force).len().max(1)).max(LEAST_RAYS);
        let scalar = Backend::exact("scalar walk", self.octree).counting(|rays| {
            let walked = rays.iter().map(|ray| Walk::new(&self.parts).closest_hit_with_work(ray));
            walked.map(|(hit, work)| (Hit::from(hit), work.cells)).unzip()
        });
        let by_signs = Stepping::<Pluecker, Standard>::new(&self.parts);
        let mut backends = vec![
            brute_force,
            scalar,
            Backend::exact("scalar walk by Plücker signs", by_signs),
            Backend::exact("compact, scalar walk", self.compact),
        ];
        for (of, tracers) in [("", &self.batches), ("compact, ", &self.compact_batches)] {
            for (registers, tracer) in tracers {
                let exact = |way: &str, tracer| Backend::exact(format!("{of}{way}, {registers}"), tracer);
                let forced = |way| tracer.clone().with_way(way);
                let mut on_two_threads = exact("batch", tracer.clone());
                on_two_threads.threads = 2;
                backends.extend([
                    exact("batch", tracer.clone()),
                    on_two_threads,
                    Backend::exact(format!("{of}one ray a call, {registers}"), OneByOne(tracer)),
                    exact("tile", testing::tiled(forced(Way::Single))),
                    exact("single", forced(Way::Single)),
                    exact("stream", forced(Way::Stream)),
                    exact("interleaved", forced(Way::Interleaved)),
                    exact("walk in lanes", forced(Way::Walk)),
                ]);
            }
        }
        backends
    }
}
