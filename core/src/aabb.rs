//! `Aabb`: a box in the caller's units.

/// A box in the caller's units; empty when a lower side is above its upper side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Lower corner.
    pub lower: [f64; 3],
    /// Upper corner.
    pub upper: [f64; 3],
}
