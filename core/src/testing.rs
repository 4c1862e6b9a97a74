//! Doors for tests: the clauses of the numeric contract that a test may switch off, to prove that it would notice.
//!
//! Nothing here is part of the API. Everything but tests traces with [`Standard`].

use crate::error::DecodeError;
use crate::frame::Frame;
use crate::octree::Octree;
use crate::parts::Parts;
use crate::ray::{CanonicalRay, Ray};
use crate::step::Step;
use crate::trace::Walk;

/// Which clauses hold.
pub trait Policy: Copy {
    /// The walk goes on past the exit plane by the padding.
    const STOP_MARGIN: bool = true;
    /// The walk ends at the first leaf that gives a hit.
    const STOPS_AT_FIRST_HIT: bool = false;
    /// The root's test is dilated by the padding.
    const DILATES_ROOT: bool = true;
    /// `t_min` of a moved ray is clamped to its new origin.
    const CLAMPS_T_MIN: bool = false;
    /// Hits are ordered by the t that is reported.
    const ORDERS_BY_REPORTED: bool = false;
    /// The mesh keeps its margin inside the root; only files that break the contract lack it.
    const KEEPS_MESH_MARGIN: bool = true;
}

/// The contract as it stands.
#[derive(Clone, Copy, Debug)]
pub struct Standard;
impl Policy for Standard {}

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

/// [`Frame::around`] without the margin that the contract demands: the mesh may touch the root's faces.
pub fn frame_touching(lower: [f32; 3], upper: [f32; 3]) -> Frame {
    Frame::around_with_margin(lower, upper, 0.0)
}
