//! What a builder was told, and what its stages share.

use leafwalk_core::contract::PADDING;
use leafwalk_core::layout::{LatticeBox, MAX_LEVEL};

use super::bounds::Bounds;
use super::error::BuildError;
use super::normalise::NonFinite;

/// What the builder takes a ray's step into a cell to cost, in triangle tests, where rays descend. Measured on four scenes
/// (docs/choices.md, "Leaves of up to about 192 triangles").
const STEP_COST: f32 = 192.0;
/// What the builder takes a step to cost, in triangle tests, where rays walk from leaf to leaf: such rays are faster with
/// smaller leaves.
pub(super) const WALK_STEP_COST: f32 = 64.0;
/// The least step cost that a builder accepts: below half a triangle test, leaves of one triangle would be split.
const LEAST_STEP_COST: f32 = 0.5;
/// How many references a build may make for each triangle of the mesh, unless it is told another number.
const BUDGET: f32 = 8.0;
/// The least number of references for each triangle that a builder accepts: each triangle is listed once at least.
const LEAST_BUDGET: f32 = 1.0;
/// How many references a build may make in all, however few triangles the mesh has.
const LEAST_REFERENCES: usize = 4096;
/// How many bytes a build may use, unless it is told another number. Half of the machines that a build is meant for have
/// more.
const MEMORY_LIMIT: u64 = 16 << 30;

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

impl Spoiled {
    /// The steps of a box, a step too small where boxes are spoiled.
    pub(super) fn boxed(self, bounds: Bounds) -> LatticeBox {
        self.shrunk(bounds.boxed())
    }

    /// A box, a step too small where boxes are spoiled.
    pub(super) fn shrunk(self, LatticeBox { lower, upper }: LatticeBox) -> LatticeBox {
        let shrink = |k: usize| u16::from(self == Self::Boxes && lower[k] < upper[k]);
        LatticeBox { lower, upper: core::array::from_fn(|k| upper[k] - shrink(k)) }
    }
}

/// The settings of a builder.
#[derive(Clone, Debug)]
pub(crate) struct Settings {
    pub(super) step_cost: f32,
    pub(super) max_level: u32,
    /// How many references a build may make for each triangle of the mesh.
    pub(super) budget: f32,
    pub(super) memory_limit: u64,
    pub(super) non_finite: NonFinite,
    pub(super) is_compact: bool,
    pub(crate) spoiled: Spoiled,
}

impl Settings {
    pub(super) const DEFAULT: Self = Self {
        step_cost: STEP_COST,
        max_level: MAX_LEVEL,
        budget: BUDGET,
        memory_limit: MEMORY_LIMIT,
        non_finite: NonFinite::Refused,
        is_compact: false,
        spoiled: Spoiled::Nothing,
    };

    /// An error for the first setting that is out of its range.
    pub(super) fn check(&self) -> Result<(), BuildError> {
        let unlimited = f64::from(f32::MAX);
        let settings = [
            ("step cost", self.step_cost.into(), LEAST_STEP_COST.into(), unlimited),
            ("maximum level", self.max_level.into(), 0.0, MAX_LEVEL.into()),
            ("reference budget", self.budget.into(), LEAST_BUDGET.into(), unlimited),
        ];
        // NaN is in no range.
        match settings.into_iter().find(|(_, value, least, most)| !(least..=most).contains(&value)) {
            Some((setting, value, least, most)) => Err(BuildError::Setting { setting, value, least, most }),
            None => Ok(()),
        }
    }

    /// An error where the build may not use so many bytes.
    pub(super) fn check_memory(&self, needed: u64) -> Result<(), BuildError> {
        let limit = self.memory_limit;
        if needed > limit { Err(BuildError::OutOfMemory { needed, limit }) } else { Ok(()) }
    }

    /// How many references the leaves may list, for a mesh of so many triangles.
    pub(super) fn references(&self, triangles: usize) -> usize {
        ((f64::from(self.budget) * triangles as f64) as usize).max(LEAST_REFERENCES)
    }

    /// By how much cells are dilated before triangles are binned.
    pub(super) fn padding(&self) -> f32 {
        if self.spoiled == Spoiled::Padding { 0.0 } else { PADDING }
    }
}
