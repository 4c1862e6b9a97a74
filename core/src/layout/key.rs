//! `Key`: where the cell of an octree's node lies.

use super::LATTICE;

/// Words of a key.
pub const KEY_WORDS: usize = 2;

/// Where a node's cell lies: its lower corner in lattice steps, and its level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Key {
    /// Lower corner, 0 to 65535 an axis, a multiple of the cell's edge.
    pub corner: [u32; 3],
    /// 0 for the root.
    pub level: u32,
}

impl Key {
    /// The root's key.
    pub const ROOT: Self = Self { corner: [0; 3], level: 0 };

    /// The cell's edge in lattice steps.
    pub fn size(self) -> u32 {
        LATTICE >> self.level
    }

    /// The child in an octant (bit k: upper half of axis k).
    pub fn child(self, octant: u32) -> Self {
        let half = self.size() >> 1;
        let corner = core::array::from_fn(|k| self.corner[k] + (octant >> k & 1) * half);
        Self { corner, level: self.level + 1 }
    }

    /// The octant (bit k: upper half of axis k) in which a cell of this size holds a corner, both in lattice steps.
    #[inline(always)]
    pub fn octant_towards(size: u32, corner: [u32; 3]) -> u32 {
        let half = size >> 1;
        (0..3).fold(0, |octant, k| octant | u32::from(corner[k] & half != 0) << k)
    }

    /// The cell of an entry of the entry grid, which has 2^`bits` cells an axis, x fastest.
    pub fn of_grid(entry: u32, bits: u32) -> Self {
        let edge = LATTICE >> bits;
        let corner = core::array::from_fn(|k| (entry >> (k as u32 * bits) & ((1 << bits) - 1)) * edge);
        Self { corner, level: bits }
    }

    /// The cell of the same size across a face, or `None` outside the root.
    pub fn across(self, face: u32) -> Option<Self> {
        let mut key = self;
        let corner = &mut key.corner[face as usize >> 1];
        *corner = if face & 1 == 1 { *corner + self.size() } else { corner.checked_sub(self.size())? };
        (*corner < LATTICE).then_some(key)
    }

    /// The cell one level up that contains this one.
    pub fn parent(self) -> Self {
        let mask = !(2 * self.size() - 1);
        Self { corner: self.corner.map(|c| c & mask), level: self.level - 1 }
    }

    /// The two words of the key section: x and y, then z and level, 16 bits each.
    pub fn to_words(self) -> [u32; KEY_WORDS] {
        [self.corner[0] | self.corner[1] << 16, self.corner[2] | self.level << 16]
    }

    /// Reads what [`Key::to_words`] wrote.
    pub fn from_words(words: [u32; KEY_WORDS]) -> Self {
        Self { corner: [words[0] & 0xffff, words[0] >> 16, words[1] & 0xffff], level: words[1] >> 16 }
    }

    /// Lower and upper corner as seen from the root's corner: exact.
    pub fn bounds(self) -> ([f32; 3], [f32; 3]) {
        (self.corner.map(|c| c as f32), self.corner.map(|c| (c + self.size()) as f32))
    }
}
