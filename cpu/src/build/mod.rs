//! From a mesh to the words of a file.
//!
//! ```text
//! normalise   vertices into lattice units, triangles without extent left out
//! tree        split cells while that pays, and balance the octree
//! assemble    link     number the nodes, link each leaf to its neighbours, make the entry grid
//!             leaf     group what each leaf lists into blocks of eight, with their boxes
//!             bvh      grow the BVH over all blocks
//!             compact  where asked, name corners by number
//!             write the sections; the decoder validates them
//! ```

mod assemble;
mod bounds;
mod bvh;
mod clip;
mod compact;
mod error;
mod leaf;
mod link;
mod monitor;
mod normalise;
mod overlap;
mod part;
mod settings;
mod span;
mod tree;

use core::ops::ControlFlow;

use leafwalk_core::Octree;
use leafwalk_core::contract::PADDING;
use leafwalk_core::layout::MAX_LEVEL;

pub use error::BuildError;
pub use monitor::Progress;
pub(crate) use normalise::{NonFinite, Normalised, normalise, normalise_with};
pub(crate) use overlap::Split;
pub(crate) use part::box_inside;
pub use settings::Spoiled;

use crate::mesh::Mesh;
use monitor::Monitor;
use settings::Settings;
use tree::Tree;

/// Cost of a step over the cost of a triangle test. Measured on four scenes
/// (docs/choices.md, "Leaves of up to about 192 triangles").
const STEP_COST: f32 = 192.0;
/// References that a build may make for each triangle.
const BUDGET: f32 = 8.0;
/// References that even a mesh of one triangle may make.
const LEAST_BUDGET: usize = 4096;
/// Half of the machines that a build is meant for have more.
const MEMORY_LIMIT: u64 = 16 << 30;

/// Builds octrees.
///
/// The words depend on the mesh and the settings alone, not on threads.
#[derive(Clone, Debug)]
pub struct Builder {
    step_cost: f32,
    max_level: u32,
    budget: f32,
    memory_limit: u64,
    non_finite: NonFinite,
    is_compact: bool,
    pub(crate) spoiled: Spoiled,
}

impl Default for Builder {
    fn default() -> Self {
        Self::new()
    }
}

impl Builder {
    /// Default settings.
    pub fn new() -> Self {
        Self {
            step_cost: STEP_COST,
            max_level: MAX_LEVEL,
            budget: BUDGET,
            memory_limit: MEMORY_LIMIT,
            non_finite: NonFinite::Refused,
            is_compact: false,
            spoiled: Spoiled::Nothing,
        }
    }

    /// A step cost for who walks, as GPUs and the scalar tracer do: a larger octree of smaller leaves.
    pub const WALK_STEP_COST: f32 = 64.0;

    /// Cost of a step over the cost of a triangle test: larger values make fewer, fuller leaves, and a smaller octree. At
    /// least 0.5; the default is 192. No answer depends on it.
    #[must_use]
    pub fn step_cost(self, step_cost: f32) -> Self {
        Self { step_cost: if step_cost.is_finite() { step_cost.max(0.5) } else { STEP_COST }, ..self }
    }

    /// Deepest level of a leaf, 0 (the root alone) to 16.
    #[must_use]
    pub fn max_level(self, level: u32) -> Self {
        Self { max_level: level.min(MAX_LEVEL), ..self }
    }

    /// References that the leaves may list for each triangle of the mesh, at least 1; the default is 8.
    #[must_use]
    pub fn reference_budget(self, references: f32) -> Self {
        Self { budget: if references.is_finite() { references.max(1.0) } else { BUDGET }, ..self }
    }

    /// Bytes that a build may use, its result included; the default is 16 GiB.
    #[must_use]
    pub fn memory_limit(self, bytes: u64) -> Self {
        Self { memory_limit: bytes, ..self }
    }

    /// Leaves triangles with NaN or infinite vertices out, counted as dropped, instead of refusing the mesh.
    #[must_use]
    pub fn lenient(self) -> Self {
        Self { non_finite: NonFinite::Dropped, ..self }
    }

    /// Names the corners of triangles by number instead of repeating them: about half the bytes, the same answers, and
    /// slower to trace (docs/choices.md, "Compact octrees name their corners").
    #[must_use]
    pub fn compact(self) -> Self {
        Self { is_compact: true, ..self }
    }

    /// Builds on the threads of the current rayon pool.
    ///
    /// # Errors
    /// [`BuildError`].
    pub fn build(&self, mesh: &Mesh) -> Result<Octree<Vec<u32>>, BuildError> {
        self.build_with_progress(mesh, |_| ControlFlow::Continue(()))
    }

    /// As [`Builder::build`]; the callback hears of progress and may stop the build.
    ///
    /// # Errors
    /// [`BuildError`], [`BuildError::Cancelled`] when the callback breaks.
    pub fn build_with_progress(
        &self,
        mesh: &Mesh,
        progress: impl Fn(Progress) -> ControlFlow<()> + Sync,
    ) -> Result<Octree<Vec<u32>>, BuildError> {
        let monitor = Monitor::new(&progress);
        monitor.check(0.0)?;
        let settings = Settings {
            step_cost: self.step_cost,
            max_level: self.max_level,
            budget: ((f64::from(self.budget) * mesh.triangles.len() as f64) as usize).max(LEAST_BUDGET),
            memory_limit: self.memory_limit,
            is_compact: self.is_compact,
            padding: if self.spoiled == Spoiled::Padding { 0.0 } else { PADDING },
            spoiled: self.spoiled,
        };
        settings.check_memory(normalise::bytes_needed(mesh))?;
        let normalised = self.normalise(mesh)?;
        let tree = Tree::grow(&normalised.triangles, &settings, &monitor.part(0.05, 0.6))?;
        assemble::assemble(mesh, &normalised, &tree, &settings, &monitor.part(0.6, 1.0))
    }

    fn normalise(&self, mesh: &Mesh) -> Result<Normalised, BuildError> {
        let mut normalised = match self.spoiled {
            Spoiled::MeshMargin => normalise::normalise_touching(mesh)?,
            _ => normalise_with(mesh, self.non_finite)?,
        };
        if self.spoiled == Spoiled::CollinearTriangles {
            normalised.triangles.retain(|triangle| !normalise::is_collinear(&triangle.corners));
            normalised.dropped = (mesh.triangles.len() - normalised.triangles.len()) as u32;
        }
        Ok(normalised)
    }
}
