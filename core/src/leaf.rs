//! `Leaf`: where a walk ended, for the walks of rays that start there.

use bytemuck::{Pod, Zeroable};

use crate::layout::NONE;
use crate::octree::Octree;
use crate::policy::Policy;
use crate::ray::{Hit, Ray};
use crate::step::Step;
use crate::trace::Walk;

/// A leaf of an octree, as a walk that ends in it gives it back: rays that leave the hit mostly start there.
///
/// It is the number of a record, and a mere hint. A walk begins in the leaf only if its first point lies in the leaf's cell,
/// and else where it would have begun without. So any number may be given, also of another octree: no answer depends on it.
///
/// ```
/// # use leafwalk_core::{Leaf, Octree, Ray};
/// /// How many surfaces a ray goes through, given the corners of triangles by their numbers.
/// fn layers(octree: &Octree<&[u32]>, mut ray: Ray, corners: impl Fn(u32) -> [[f32; 3]; 3]) -> usize {
///     let frame = octree.frame();
///     let (mut leaf, mut layers) = (Leaf::UNKNOWN, 0);
///     while let (Some(hit), end) = octree.closest_hit_from(&ray, leaf) {
///         ray = hit.spawn(&frame, &corners(hit.primitive), ray.direction);
///         (leaf, layers) = (end, layers + 1);
///     }
///     layers
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Pod, Zeroable)]
#[repr(transparent)]
pub struct Leaf(pub u32);

impl Leaf {
    /// No leaf is known.
    pub const UNKNOWN: Self = Self(NONE);
}

impl Default for Leaf {
    fn default() -> Self {
        Self::UNKNOWN
    }
}

impl<W: AsRef<[u32]>> Octree<W> {
    /// The closest hit as by [`Octree::closest_hit`], found by a walk that begins in a leaf if the ray starts there; and the
    /// leaf in which the walk ended, [`Leaf::UNKNOWN`] where there was nothing to walk through. See [`Leaf`].
    pub fn closest_hit_from(&self, ray: &Ray, leaf: Leaf) -> (Option<Hit>, Leaf) {
        Walk::new(&self.parts()).closest_hit_from(ray, leaf)
    }

    /// As [`Octree::occluded`], found likewise.
    pub fn occluded_from(&self, ray: &Ray, leaf: Leaf) -> bool {
        Walk::new(&self.parts()).occluded_from(ray, leaf)
    }
}

impl<S: Step, P: Policy> Walk<'_, S, P> {
    /// See [`Octree::closest_hit_from`].
    pub fn closest_hit_from(&self, ray: &Ray, leaf: Leaf) -> (Option<Hit>, Leaf) {
        let (hit, end, _) = self.find(ray, leaf);
        (hit, end)
    }
}
