//! `Record`: one node of the octree, eight words.

/// Words of a record.
pub const RECORD_WORDS: usize = 8;

/// A face has no neighbour: it lies on the root's boundary.
pub const LINK_NONE: u32 = 0;
/// The neighbour is a leaf of the same size.
pub const LINK_SAME: u32 = 1;
/// The neighbour is a leaf one level up.
pub const LINK_COARSER: u32 = 2;
/// The neighbours are four leaves one level down; the link names the first of their eight siblings.
pub const LINK_FINER: u32 = 3;

/// Bits of `tCount` in word 0 of a record.
pub const T_COUNT_MASK: u32 = 0xff;
/// Where the level starts in word 0 of a record.
pub const LEVEL_SHIFT: u32 = 8;
/// Bits of the level, once shifted.
pub const LEVEL_MASK: u32 = 0x1f;
/// Where the six 2-bit link kinds start in word 0 of a record, face 0 lowest.
pub const LINK_SHIFT: u32 = 13;
/// The bit of word 0 that tells an inner node.
pub const INNER: u32 = 1 << 25;
const USED_BITS: u32 = (1 << 26) - 1;

/// Word 0 of a record: `tCount` (8 bits) · level (5) · `nCount` (6 x 2) · inner flag (1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordHead(pub u32);

impl RecordHead {
    /// A leaf: entries of its payload, its level, and the link kind of each face.
    pub fn leaf(t_count: u32, level: u32, links: [u32; 6]) -> Self {
        let n_count = links.iter().rev().fold(0, |bits, kind| bits << 2 | kind);
        Self(t_count | level << LEVEL_SHIFT | n_count << LINK_SHIFT)
    }

    /// An inner node.
    pub fn inner(level: u32) -> Self {
        Self(level << LEVEL_SHIFT | INNER)
    }

    /// Whether the record has children instead of triangles.
    #[inline]
    pub fn is_inner(self) -> bool {
        self.0 & INNER != 0
    }

    /// Entries of the leaf's payload, 0 to 8.
    #[inline]
    pub fn t_count(self) -> u32 {
        self.0 & T_COUNT_MASK
    }

    /// 0 for the root, up to [`super::MAX_LEVEL`].
    #[inline]
    pub fn level(self) -> u32 {
        self.0 >> LEVEL_SHIFT & LEVEL_MASK
    }

    /// How the leaf is linked across a face (`2 * axis + positive`).
    #[inline]
    pub fn link(self, face: u32) -> u32 {
        self.0 >> (LINK_SHIFT + 2 * face) & 3
    }

    /// Whether bits that mean nothing are zero, as they must be.
    pub(crate) fn is_canonical(self) -> bool {
        let leaf_only = T_COUNT_MASK | 0xfff << LINK_SHIFT;
        self.0 & !USED_BITS == 0 && (!self.is_inner() || self.0 & leaf_only == 0)
    }
}

/// One node: a leaf's five fields (the fifth, its index, is its own number) or an inner node's children.
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Record {
    /// See [`RecordHead`].
    pub head: u32,
    /// `tOffset`: a leaf's payload number, or an inner node's first child.
    pub offset: u32,
    /// Per face: the neighbouring leaf, or the first of the eight siblings of which four are neighbours.
    pub neighbours: [u32; 6],
}

impl Record {
    /// Word 0 with its fields.
    #[inline]
    pub fn head(&self) -> RecordHead {
        RecordHead(self.head)
    }
}
