//! `Policy`: the clauses of the numeric contract that a test may switch off, to prove that it would notice.
//!
//! Everything but tests traces with [`Standard`]; tests reach the policies through [`crate::testing`].

/// Which clauses hold.
pub trait Policy: Copy {
    /// The walk goes on past the exit plane by the padding.
    const STOP_MARGIN: bool = true;
    /// The walk ends at the first leaf that gives a hit.
    const STOPS_AT_FIRST_HIT: bool = false;
    /// The root's test is dilated by the padding, and the hull's by the box margin.
    const DILATES_ROOT: bool = true;
    /// `t_min` of a moved ray is clamped to its new origin.
    const CLAMPS_T_MIN: bool = false;
    /// Limits of moved rays are rounded to t', instead of being where the reported t crosses them.
    const ROUNDS_LIMITS: bool = false;
    /// Hits are ordered by the t that is reported.
    const ORDERS_BY_REPORTED: bool = false;
    /// Short hits lie where the ray meets the triangle's plane.
    const MEETS_PLANES: bool = true;
    /// A walk begins in the leaf that the caller knows, wherever the ray starts.
    const TRUSTS_LEAVES: bool = false;
    /// The mesh keeps its margin inside the root; only files that break the contract lack it.
    const KEEPS_MESH_MARGIN: bool = true;
}

/// The contract as it stands.
#[derive(Clone, Copy, Debug)]
pub struct Standard;
impl Policy for Standard {}
