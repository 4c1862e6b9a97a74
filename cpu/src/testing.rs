//! Doors for tests and benches: ways and registers that they may ask for, the innermost loops, and broken clauses that a
//! test must notice.
//!
//! Nothing here is part of the API.

use leafwalk_core::canonical::PreparedFrame;
use leafwalk_core::layout::{Block, BvhNode, Triangle};
use leafwalk_core::{CanonicalRay, Frame, Nearest, Ray};

use crate::lanes::{Eight, Kernel, Registers};
use crate::trace::Way;
use crate::trace::bvh::node::{boxes_hit, test_block};
use crate::trace::packet::Packet;
use crate::trace::probe::Probe;
use crate::trace::query::ClosestHit;
use crate::{BruteForce, Builder, CpuTracer};

pub use crate::build::Spoiled;

/// A tracer that uses only the registers that the compiler may assume.
#[must_use]
pub fn portable<W>(mut tracer: CpuTracer<W>) -> CpuTracer<W> {
    tracer.registers = Registers::Portable;
    tracer
}

/// The tracer in each kind of registers that this machine has, the widest first, by the names of the registers.
#[must_use]
pub fn in_all_registers<W: Clone>(tracer: &CpuTracer<W>) -> Vec<(&'static str, CpuTracer<W>)> {
    let widest = match tracer.registers {
        Registers::Portable => None,
        #[cfg(target_arch = "x86_64")]
        Registers::Avx2(_) => Some(("AVX2", tracer.clone())),
    };
    widest.into_iter().chain([("portable", portable(tracer.clone()))]).collect()
}

/// A tracer that makes a tile of every run, however short it is, and however many tiles gave up.
#[must_use]
pub fn tiled<W>(mut tracer: CpuTracer<W>) -> CpuTracer<W> {
    tracer.tiling.takes_every_run = true;
    tracer
}

/// A tracer that traces batches ray by ray.
#[must_use]
pub fn single<W: AsRef<[u32]> + Sync>(tracer: CpuTracer<W>) -> CpuTracer<W> {
    tracer.with_way(Way::Single)
}

/// A tracer that uses streams however few rays there are, and however little they share.
#[must_use]
pub fn streamed<W: AsRef<[u32]> + Sync>(tracer: CpuTracer<W>) -> CpuTracer<W> {
    tracer.with_way(Way::Stream)
}

/// A tracer that always interleaves the rays.
#[must_use]
pub fn interleaved<W: AsRef<[u32]> + Sync>(tracer: CpuTracer<W>) -> CpuTracer<W> {
    tracer.with_way(Way::Interleaved)
}

/// A tracer that walks from leaf to leaf.
#[must_use]
pub fn walked<W: AsRef<[u32]> + Sync>(tracer: CpuTracer<W>) -> CpuTracer<W> {
    tracer.with_way(Way::Walk)
}

/// A tracer whose beams are wider than their rays by this, in lattice steps, or as much in proportion in wide octrees: too
/// small, and a test has to notice.
#[must_use]
pub fn with_beam_margin<W>(mut tracer: CpuTracer<W>, beam_margin: f32) -> CpuTracer<W> {
    tracer.tiling.beam_margin = beam_margin;
    tracer
}

/// A builder that breaks a clause of the contract.
#[must_use]
pub fn spoil(mut builder: Builder, spoiled: Spoiled) -> Builder {
    builder.settings.spoiled = spoiled;
    builder
}

/// The frame that brute force brings rays into.
pub fn frame(oracle: &BruteForce) -> &Frame {
    &oracle.frame
}

/// Every triangle that brute force tests.
pub fn triangles(oracle: &BruteForce) -> &[Triangle] {
    &oracle.triangles
}

/// Makes packets of rays in the tracer's registers, and counts the rays that can be traced.
pub fn traceable<W: AsRef<[u32]> + Sync>(tracer: &CpuTracer<W>, rays: &[Ray]) -> u32 {
    tracer.registers.run(Packets { frame: tracer.octree().frame().prepare(), rays })
}

struct Packets<'a> {
    frame: PreparedFrame,
    rays: &'a [Ray],
}

impl Kernel for Packets<'_> {
    type Output = u32;

    #[inline(always)]
    fn run<L: Eight>(self) -> u32 {
        let mut count = 0;
        for eight in self.rays.chunks(8) {
            count += Packet::new::<L>(&self.frame, eight, 0).waiting().count_ones();
        }
        count
    }
}

/// How many of the boxes of some nodes a ray meets, tested in the tracer's registers.
pub fn boxes_met<W>(tracer: &CpuTracer<W>, nodes: &[BvhNode], ray: &CanonicalRay) -> u32 {
    tracer.registers.run(Boxes { nodes, ray })
}

struct Boxes<'a> {
    nodes: &'a [BvhNode],
    ray: &'a CanonicalRay,
}

impl Kernel for Boxes<'_> {
    type Output = u32;

    #[inline(always)]
    fn run<L: Eight>(self) -> u32 {
        let Probe { slabs, order, nearest, .. } = Probe::<L>::new(self.ray);
        let mut count = 0;
        for node in self.nodes {
            count += boxes_hit(&slabs, order, node, &nearest).1.count_ones();
        }
        count
    }
}

/// A ray's nearest hit among the triangles of some blocks, tested in the tracer's registers.
pub fn nearest<W>(tracer: &CpuTracer<W>, blocks: &[Block], ray: &CanonicalRay) -> Nearest {
    tracer.registers.run(Triangles { blocks, ray })
}

struct Triangles<'a> {
    blocks: &'a [Block],
    ray: &'a CanonicalRay,
}

impl Kernel for Triangles<'_> {
    type Output = Nearest;

    #[inline(always)]
    fn run<L: Eight>(self) -> Nearest {
        let Probe { shear, axes, mut nearest, .. } = Probe::<L>::new(self.ray);
        for block in self.blocks {
            test_block::<L, ClosestHit>(block, (shear, axes), move || (shear, axes), &mut nearest);
        }
        nearest
    }
}
