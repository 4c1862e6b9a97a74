//! `LatticeBox`: a box in whole lattice steps.

/// A box in whole lattice steps: per axis, the first and the last step that it touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LatticeBox {
    /// The first step an axis.
    pub lower: [u16; 3],
    /// The last step an axis; below the first one where the box is empty.
    pub upper: [u16; 3],
}

impl LatticeBox {
    /// The box around nothing: its sides are the wrong way round.
    pub const EMPTY: Self = Self { lower: [u16::MAX; 3], upper: [0; 3] };
    /// The box of a vacant child: in a corner of the root that few rays meet. Those that do find no block there.
    pub const VACANT: Self = Self { lower: [u16::MAX; 3], upper: [u16::MAX; 3] };

    /// The smallest box around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            lower: core::array::from_fn(|k| self.lower[k].min(other.lower[k])),
            upper: core::array::from_fn(|k| self.upper[k].max(other.upper[k])),
        }
    }

    /// The smallest box around all.
    pub fn around(boxes: impl IntoIterator<Item = Self>) -> Self {
        boxes.into_iter().fold(Self::EMPTY, Self::union)
    }

    /// Lower and upper corner as seen from the root's corner, moved outwards by a margin.
    pub fn dilated(self, margin: f32) -> [[f32; 3]; 2] {
        [self.lower.map(|step| f32::from(step) - margin), self.upper.map(|step| f32::from(step) + (1.0 + margin))]
    }

    /// The box a step larger on each side, as far as the root reaches.
    #[must_use]
    pub fn grown(self) -> Self {
        Self { lower: self.lower.map(|c| c.saturating_sub(1)), upper: self.upper.map(|c| c.saturating_add(1)) }
    }

    /// Whether no side is the wrong way round.
    pub fn is_whole(self) -> bool {
        (0..3).all(|k| self.lower[k] <= self.upper[k])
    }

    /// Whether another box lies inside this one, or is equal to it.
    pub fn contains(self, other: Self) -> bool {
        (0..3).all(|k| self.lower[k] <= other.lower[k] && other.upper[k] <= self.upper[k])
    }
}
