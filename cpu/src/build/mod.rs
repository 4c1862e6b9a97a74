//! From a mesh to the words of a file.
//!
//! ```text
//! normalise   vertices into lattice coordinates, triangles without extent left out
//!             focus    for meshes that must be rounded: where most of their vertices are
//! tree        split cells while that pays, and balance the octree
//! assemble    bvh      grow the BVH over all triangles, down to blocks of eight
//!             leaf     find the nodes and blocks of the BVH that each leaf lists, with boxes cut to its cell
//!             link     number the octree's nodes, link each leaf to its neighbours, make the entry grid
//!             compact  where asked, name corners by number
//!             write the sections; the decoder validates them
//! ```

mod assemble;
mod bounds;
mod bvh;
mod clip;
mod compact;
mod error;
mod focus;
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

pub use error::BuildError;
pub use monitor::Progress;
pub(crate) use normalise::{NonFinite, Normalised, normalise, normalise_with};
#[cfg(feature = "structures")]
pub(crate) use overlap::Overlap;
pub(crate) use overlap::Split;
pub(crate) use part::box_inside;
pub use settings::Spoiled;

use crate::mesh::MeshRef;
use monitor::Monitor;
use settings::{Settings, WALK_STEP_COST};
use tree::Tree;

/// Builds octrees.
///
/// The words depend on the mesh and the settings alone, not on threads. A setting out of its range is an error of
/// [`Builder::build`].
#[derive(Clone, Debug)]
pub struct Builder {
    pub(crate) settings: Settings,
}

impl Default for Builder {
    fn default() -> Self {
        Self::new()
    }
}

impl Builder {
    /// Default settings, which suit descents: those of [`crate::CpuTracer`].
    pub fn new() -> Self {
        Self { settings: Settings::DEFAULT }
    }

    /// Settings for who walks from leaf to leaf, as GPUs and [`Octree::closest_hit`] do: a larger octree of smaller leaves.
    pub fn for_walks() -> Self {
        Self::new().step_cost(WALK_STEP_COST)
    }

    /// Settings for who only descends, as [`crate::CpuTracer`] does: the octree is a single leaf, so a file holds little more
    /// than the BVH and the triangles. Who walks descends in that leaf, for the same answers.
    pub fn for_descents() -> Self {
        Self::new().max_level(0)
    }

    /// Whether the leaves of an octree are as small as those that [`Builder::for_walks`] makes, or smaller. All octrees
    /// give the same answers; the others are walked more slowly.
    pub fn suits_walks<W: AsRef<[u32]>>(octree: &Octree<W>) -> bool {
        octree.parts().header.step_cost <= WALK_STEP_COST
    }

    /// Cost of a step over the cost of a triangle test: larger values make fewer, fuller leaves, and a smaller octree. At
    /// least 0.5; the default is 192. No answer depends on it.
    #[must_use]
    pub fn step_cost(mut self, step_cost: f32) -> Self {
        self.settings.step_cost = step_cost;
        self
    }

    /// Deepest level of a leaf, 0 (the root alone) to 16.
    #[must_use]
    pub fn max_level(mut self, level: u32) -> Self {
        self.settings.max_level = level;
        self
    }

    /// How many leaves may meet a triangle, on average, at least 1; the default is 8.
    #[must_use]
    pub fn reference_budget(mut self, references: f32) -> Self {
        self.settings.budget = references;
        self
    }

    /// Bytes that a build may use, its result included; the default is 16 GiB.
    #[must_use]
    pub fn memory_limit(mut self, bytes: u64) -> Self {
        self.settings.memory_limit = bytes;
        self
    }

    /// Leaves triangles with NaN or infinite vertices out, counted as dropped, instead of refusing the mesh.
    #[must_use]
    pub fn lenient(mut self) -> Self {
        self.settings.non_finite = NonFinite::Dropped;
        self
    }

    /// Names the corners of triangles by number instead of repeating them: about half the bytes, the same answers, and
    /// slower to trace (docs/choices.md, "Compact octrees name their corners").
    #[must_use]
    pub fn compact(mut self) -> Self {
        self.settings.is_compact = true;
        self
    }

    /// Builds on the threads of the current rayon pool. A mesh is a `&Mesh` or a [`MeshRef`].
    ///
    /// # Errors
    /// [`BuildError`].
    pub fn build<'a>(&self, mesh: impl Into<MeshRef<'a>>) -> Result<Octree<Vec<u32>>, BuildError> {
        self.build_with_progress(mesh, |_| ControlFlow::Continue(()))
    }

    /// As [`Builder::build`]; the callback hears of progress and may stop the build.
    ///
    /// # Errors
    /// [`BuildError`], [`BuildError::Cancelled`] when the callback breaks.
    pub fn build_with_progress<'a>(
        &self,
        mesh: impl Into<MeshRef<'a>>,
        progress: impl Fn(Progress) -> ControlFlow<()> + Sync,
    ) -> Result<Octree<Vec<u32>>, BuildError> {
        self.build_monitored(mesh.into(), &Monitor::new(&progress))
    }

    fn build_monitored(&self, mesh: MeshRef<'_>, monitor: &Monitor<'_>) -> Result<Octree<Vec<u32>>, BuildError> {
        let settings = &self.settings;
        settings.check()?;
        monitor.check(0.0)?;
        settings.check_memory(normalise::bytes_needed(mesh))?;
        let normalised = self.normalise(mesh)?;
        let budget = settings.references(mesh.triangles.len());
        let tree = Tree::grow(&normalised.frame, &normalised.triangles, budget, settings, &monitor.part(0.05, 0.6))?;
        assemble::assemble(mesh, &normalised, &tree, settings, &monitor.part(0.6, 1.0))
    }

    fn normalise(&self, mesh: MeshRef<'_>) -> Result<Normalised, BuildError> {
        let mut normalised = match self.settings.spoiled {
            Spoiled::MeshMargin => normalise::normalise_touching(mesh)?,
            _ => normalise_with(mesh, self.settings.non_finite)?,
        };
        if self.settings.spoiled == Spoiled::CollinearTriangles {
            normalised.triangles.retain(|triangle| !normalise::is_collinear(&triangle.corners));
            normalised.dropped = (mesh.triangles.len() - normalised.triangles.len()) as u32;
        }
        Ok(normalised)
    }
}
