//! What every structure can do: be built, and lead a ray past triangles.

use core::ops::Range;

use super::line::Line;
use super::scene::Scene;

/// A way to find the few triangles that a ray may hit.
pub trait Structure: Sized + Send + Sync {
    /// What may be chosen when it is built.
    type Settings;
    /// Whether a triangle that is listed twice is stored twice, in the order of [`Structure::listed`]. Where each is listed
    /// once, that costs nothing, and a leaf's triangles lie side by side.
    const COPIES: bool;

    /// Builds it over the triangles of a scene.
    fn build(scene: &Scene, settings: &Self::Settings) -> Self;

    /// The triangles that it lists, leaf after leaf, each as often as it is listed.
    fn listed(&self) -> &[u32];

    /// Leads a line past the triangles that it may hit, roughly in the order in which it comes to them.
    fn visit(&self, line: &Line, search: &mut impl Search);

    /// The bytes that it takes, what it lists included, the triangles not.
    fn bytes(&self) -> usize;
}

/// A structure that can follow vertices that move.
pub trait Refit: Structure {
    /// Fits it to a scene of the same triangles, in the same order, with other corners: it leads rays past them as surely as
    /// one built anew, though not as fast if they moved far.
    fn refit(&mut self, scene: &Scene);
}

/// What a structure leads along a ray.
pub trait Search {
    /// Tests some of the triangles that the structure lists, given by their places in [`Structure::listed`].
    fn test(&mut self, listed: Range<usize>);

    /// From this t on no hit counts any more: one that is nearer is known, or, where any hit will do, one at all. It never
    /// grows.
    fn end(&self) -> f32;

    /// Says that a node or a cell was looked at.
    #[inline]
    fn step(&mut self) {}
}
