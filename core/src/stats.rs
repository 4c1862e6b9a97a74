//! `Stats`: what an octree holds, in numbers.

use crate::layout::{BVH_WIDTH, MAX_LEVEL};
use crate::parts::Parts;

/// Sizes of leaves: 0 to 8 entries.
pub const LEAF_SIZES: usize = BVH_WIDTH + 1;

/// What an octree holds, in numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Stats {
    /// Triangles of the mesh, those dropped included.
    pub primitives: u32,
    /// Triangles left out because two vertices are equal on the lattice.
    pub dropped: u32,
    /// Dropped triangles that lost their extent on the lattice: detail under 2^-76 of the scene's extent.
    pub collapsed: u32,
    /// Blocks of eight triangles.
    pub blocks: u32,
    /// Leaves, empty ones included.
    pub leaves: u32,
    /// Leaves that list nothing.
    pub empty_leaves: u32,
    /// Inner nodes.
    pub inner: u32,
    /// Leaves of each level, root first.
    pub leaves_at_level: [u32; MAX_LEVEL as usize + 1],
    /// Leaves that list 0, 1, .. 8 blocks or nodes of the BVH.
    pub leaves_by_entries: [u32; LEAF_SIZES],
}

impl Stats {
    /// Counts, by a scan of the records.
    pub(crate) fn of(parts: &Parts<'_>) -> Self {
        let mut stats = Self {
            primitives: parts.header.primitives,
            dropped: parts.header.dropped,
            collapsed: parts.header.collapsed,
            blocks: parts.blocks.len() as u32,
            leaves: 0,
            empty_leaves: 0,
            inner: 0,
            leaves_at_level: [0; MAX_LEVEL as usize + 1],
            leaves_by_entries: [0; LEAF_SIZES],
        };
        stats.inner = parts.records.iter().filter(|record| record.head().is_inner()).count() as u32;
        for (_, leaf) in parts.leaves() {
            stats.leaves += 1;
            stats.empty_leaves += u32::from(leaf.head().t_count() == 0);
            stats.leaves_at_level[leaf.head().level() as usize] += 1;
            stats.leaves_by_entries[leaf.head().t_count() as usize] += 1;
        }
        stats
    }
}
