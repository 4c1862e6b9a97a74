//! `Limits`: when cells are cut no more.

/// The smallest cells have at least this part of the root's edge, 2^-16: a lattice step, wider than what the margin
/// adds on one side.
pub(super) const MOST_DEPTH: u32 = 16;
/// However few triangles there are, they may be listed as often as this in all.
const LEAST_LISTED: usize = 4096;

/// When cells are cut no more. A cell that lists more triangles than the limit is cut if it is not too deep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Cells that list no more triangles than these stay whole.
    pub leaf: u32,
    /// How often cells are cut on the way from the root to the smallest, 16 at most.
    pub depth: u32,
    /// How often a triangle may be listed on average. Cells that list most are cut first, level by level; with large
    /// triangles that cross each other a depth alone would bound nothing.
    pub copies: u32,
}

impl Default for Limits {
    fn default() -> Self {
        Self { leaf: 16, depth: 11, copies: 12 }
    }
}

impl Limits {
    /// Levels below the root.
    pub(super) fn levels(&self) -> u32 {
        self.depth.min(MOST_DEPTH)
    }

    /// How many triangles all leaves may list.
    pub(super) fn listed(&self, triangles: usize) -> usize {
        triangles.saturating_mul(self.copies as usize).max(LEAST_LISTED)
    }
}
