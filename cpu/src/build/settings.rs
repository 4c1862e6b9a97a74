//! `Settings`: what the stages of a build share.

use super::error::BuildError;

/// What the stages of a build share.
pub(crate) struct Settings {
    pub(super) step_cost: f32,
    pub(super) max_level: u32,
    /// References that the leaves may list, in all.
    pub(super) budget: usize,
    pub(super) memory_limit: u64,
    pub(super) padding: f32,
    pub(super) is_compact: bool,
    pub(super) spoiled: Spoiled,
}

impl Settings {
    /// An error where the build may not use so many bytes.
    pub(super) fn check_memory(&self, needed: u64) -> Result<(), BuildError> {
        let limit = self.memory_limit;
        if needed > limit { Err(BuildError::OutOfMemory { needed, limit }) } else { Ok(()) }
    }
}

/// Clauses of the numeric contract that a test may have broken, to prove that it would notice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Spoiled {
    /// The contract holds.
    Nothing,
    /// Triangles are binned without padding, though the header claims it.
    Padding,
    /// Collinear triangles are dropped.
    CollinearTriangles,
    /// The mesh may touch the root's faces.
    MeshMargin,
    /// Boxes are a lattice step too small.
    Boxes,
}
