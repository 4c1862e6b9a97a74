//! Doors for tests, which may switch clauses of the numeric contract off, to prove that they would notice.
//!
//! Nothing here is part of the API.

use crate::error::DecodeError;
use crate::frame::Frame;
use crate::octree::Octree;
use crate::parts::Parts;
use crate::ray::{CanonicalRay, Hit, Ray};
use crate::step::Step;
use crate::trace::Walk;

pub use crate::policy::{Policy, Standard};

/// [`Octree::from_sealed`] under a policy.
///
/// # Errors
/// As [`Octree::from_sealed`].
pub fn from_sealed<W: AsRef<[u32]>, P: Policy>(words: W) -> Result<Octree<W>, DecodeError> {
    Octree::from_sealed_with::<P>(words)
}

/// [`Frame::canonical`] under a policy.
pub fn canonical<P: Policy>(frame: &Frame, ray: &Ray) -> Option<CanonicalRay> {
    frame.canonical_with::<P>(ray)
}

/// The walk by any kind of step under any policy.
pub fn walk<'a, S: Step, P: Policy>(parts: &'a Parts<'a>) -> Walk<'a, S, P> {
    Walk::with(parts)
}

/// [`Hit::spawn`] with another offset from the triangle, in the caller's units, than [`Frame::clearance`].
pub fn spawn_lifted(hit: &Hit, corners: &[[f32; 3]; 3], direction: [f32; 3], lift: f64) -> Ray {
    hit.spawn_lifted(corners, direction, lift)
}

/// [`Frame::focused`] without the margin that the contract demands: the mesh may touch the root's faces.
pub fn frame_touching(bounds: [[f64; 3]; 2], focus: [[f64; 3]; 2]) -> Frame {
    Frame::focused_with_margin(bounds, focus, 0.0)
}
