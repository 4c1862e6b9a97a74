//! What a bounding volume can do.

use core::fmt::Debug;

use glam::Vec3;

use crate::structures::line::Line;

/// A shape around triangles that a line is tested against in their stead.
pub trait Volume: Copy + Debug + Send + Sync {
    /// Around nothing.
    const EMPTY: Self;
    /// By how many of a scene's margins it is dilated: one for what the margin stands for, and one more where its own test
    /// errs by more than a slab test does.
    const MARGINS: f32;
    /// What is computed once of a line.
    type Probe: Copy;

    /// Around some points, and all that is within a margin of them. There is a point.
    fn around(points: &[Vec3], margin: f32) -> Self;

    /// Around two volumes; `None` where one around their points would be smaller.
    fn join(&self, other: &Self) -> Option<Self>;

    /// Prepares a line.
    fn probe(line: &Line) -> Self::Probe;

    /// Where the part of a line between two distances comes into the volume, or `None` if it passes by.
    fn entry(&self, probe: &Self::Probe, first: f32, last: f32) -> Option<f32>;
}
