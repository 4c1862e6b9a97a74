//! Doors for tests: ways and registers that a test may ask for, and broken clauses that it must notice.
//!
//! Nothing here is part of the API.

use leafwalk_core::Frame;
use leafwalk_core::layout::Triangle;

use crate::lanes::Registers;
use crate::trace::Way;
use crate::{BruteForce, Builder, CpuTracer};

pub use crate::build::Spoiled;

/// A tracer that uses only the registers that the compiler may assume.
#[must_use]
pub fn portable<W>(mut tracer: CpuTracer<W>) -> CpuTracer<W> {
    tracer.registers = Registers::Portable;
    tracer
}

/// A tracer that takes every ray that no tile answers by itself.
#[must_use]
pub fn single<W>(mut tracer: CpuTracer<W>) -> CpuTracer<W> {
    tracer.way = Way::Single;
    tracer
}

/// A tracer that uses streams however few rays there are, and however little they share.
#[must_use]
pub fn streamed<W>(mut tracer: CpuTracer<W>) -> CpuTracer<W> {
    tracer.way = Way::Stream;
    tracer
}

/// A tracer that always interleaves the rays that no tile answers.
#[must_use]
pub fn interleaved<W>(mut tracer: CpuTracer<W>) -> CpuTracer<W> {
    tracer.way = Way::Interleaved;
    tracer
}

/// A tracer whose beams are wider than their rays by this, in lattice units: too small, and a test has to notice.
#[must_use]
pub fn with_beam_margin<W>(mut tracer: CpuTracer<W>, beam_margin: f32) -> CpuTracer<W> {
    tracer.tiling.beam_margin = beam_margin;
    tracer
}

/// A tracer whose tiles take a triangle for tested once some of their rays were tested against it: a test has to notice.
#[must_use]
pub fn forgetting_rays<W>(mut tracer: CpuTracer<W>) -> CpuTracer<W> {
    tracer.tiling.forgets_rays = true;
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
