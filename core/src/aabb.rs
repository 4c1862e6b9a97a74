//! `Aabb`: a box in the caller's units.

/// A box in the caller's units; empty when a lower side is above its upper side.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Aabb {
    /// Lower corner.
    #[cfg_attr(feature = "serde", serde(with = "crate::numbers::triple"))]
    pub lower: [f64; 3],
    /// Upper corner.
    #[cfg_attr(feature = "serde", serde(with = "crate::numbers::triple"))]
    pub upper: [f64; 3],
}
