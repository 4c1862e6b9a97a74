//! Every shared constant and bit field of the format and of the numeric contract, once.

use crate::per_axis;

/// The first word of a file: the bytes `lwok`.
pub const MAGIC: u32 = u32::from_le_bytes(*b"lwok");
/// The format's version, frozen: a change of what the words mean takes the next one, and readers read all up to theirs.
pub const VERSION: u32 = 1;

/// Deepest level of a leaf: cells 2^-16 of the root's edge.
pub const MAX_LEVEL: u32 = 16;
/// Lattice steps along the root's edge.
pub const LATTICE: u32 = 1 << MAX_LEVEL;
/// Edge of the smallest cell, in root edges.
pub const LATTICE_STEP: f32 = 1.0 / LATTICE as f32;

/// Unit roundoff of f32.
pub const ROUNDOFF: f32 = 1.0 / (1 << 24) as f32;
/// A triangle is listed in every leaf whose box, dilated by this, meets it (lattice units).
///
/// 32 roundoffs of the root's edge; the bound needs 26 (ARCHITECTURE.md, "Padding").
pub const PADDING: f32 = 32.0 * ROUNDOFF;
/// The mesh keeps this far inside the root cube, so that the root's own test can never cut a hit off.
pub const MESH_MARGIN: f32 = 128.0 * ROUNDOFF;
/// Tight boxes and block boxes are dilated by this before a ray is tested against them (lattice units).
///
/// One padding for the zone that binning adds around a cell, and 38 roundoffs for the ray: lateral error 10, depth
/// error 19, slab test 9 (all at an origin one root edge away). Three paddings are 96.
pub const BOX_MARGIN: f32 = 3.0 * PADDING;
/// A walk starts this far (in t') before `t_min`, so that the point it starts from may carry rounding.
///
/// A canonical direction covers at least t' root edges, so this is at least 64 roundoffs of the root's edge; hits lie
/// within 38 (lateral 10, depth 19, start point 9).
pub const START_MARGIN: f32 = 2.0 * PADDING;

/// Lattice coordinates, barycentrics and t' below this become 0.
pub const SMALLEST: f32 = 1.0 / (1u64 << 60) as f32;
/// Direction components of a canonical ray below this become 0.
pub const SMALLEST_DIRECTION: f32 = 1.0 / (1u64 << 40) as f32;
/// Sheared coordinates below this become 0, so that the error of their products stays a normal number.
pub const SMALLEST_SHEARED: f32 = 1.0 / (1u64 << 38) as f32;

/// Triangles a block.
pub const BLOCK_WIDTH: usize = 8;
/// Blocks a payload.
pub const PAYLOAD_BLOCKS: usize = 8;
/// Stands where there is no record, payload or primitive.
pub const NONE: u32 = u32::MAX;

/// Words a record.
pub const RECORD_WORDS: usize = 8;
/// Words a key.
pub const KEY_WORDS: usize = 2;
/// Words a payload.
pub const PAYLOAD_WORDS: usize = 32;
/// Children a branch.
pub const BRANCH_WIDTH: usize = 8;
/// Words a branch.
pub const BRANCH_WORDS: usize = 32;
/// Branches between the first and a block, both ends included, at most: it bounds what a descent must remember.
///
/// Nine levels of eight hold all blocks that a file may have; the others are room for scenes that ask for uneven trees.
pub const MAX_DEPTH: usize = 24;
/// Words a block.
pub const BLOCK_WORDS: usize = 80;
/// Words an indexed block.
pub const INDEXED_BLOCK_WORDS: usize = 21;
/// Words a vertex.
pub const VERTEX_WORDS: usize = 3;
/// Sections start at multiples of this many words: one cache line.
pub const SECTION_ALIGN: usize = 16;

/// A face has no neighbour: it lies on the root's boundary.
pub const LINK_NONE: u32 = 0;
/// The neighbour is a leaf of the same size.
pub const LINK_SAME: u32 = 1;
/// The neighbour is a leaf one level up.
pub const LINK_COARSER: u32 = 2;
/// The neighbours are four leaves one level down; the link names the first of their eight siblings.
pub const LINK_FINER: u32 = 3;

/// `tCount` of a leaf whose payloads are chained.
pub const CHAINED: u32 = 0xff;
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
    /// A leaf: blocks it lists (or [`CHAINED`]), its level, and the link kind of each face.
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

    /// Blocks listed: 0 to 8, or [`CHAINED`].
    #[inline]
    pub fn t_count(self) -> u32 {
        self.0 & T_COUNT_MASK
    }

    /// 0 for the root, up to [`MAX_LEVEL`].
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

    /// Lower and upper corner in lattice units: exact.
    pub fn bounds(self) -> ([f32; 3], [f32; 3]) {
        let at = |c: u32| c as f32 * LATTICE_STEP;
        (self.corner.map(at), self.corner.map(|c| at(c + self.size())))
    }
}

/// A box in whole lattice steps: per axis, the first and the last step that it touches.
pub type LatticeBox = ([u16; 3], [u16; 3]);

/// The box around nothing: its sides are the wrong way round.
pub const ABSENT: LatticeBox = ([u16::MAX; 3], [0; 3]);

/// The smallest box around boxes.
pub fn hull(boxes: impl IntoIterator<Item = LatticeBox>) -> LatticeBox {
    boxes.into_iter().fold(ABSENT, |(lower, upper), b| {
        (core::array::from_fn(|k| lower[k].min(b.0[k])), core::array::from_fn(|k| upper[k].max(b.1[k])))
    })
}

/// What a leaf lists, 128 bytes: up to eight blocks of triangles, and where the list goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Payload {
    /// Lower and upper sides of the boxes of the blocks, axis by axis. Boxes that are not in use are [`ABSENT`].
    pub sides: [[[u16; PAYLOAD_BLOCKS]; 2]; 3],
    /// Lower side of the box around all that is listed, of the whole chain.
    pub lower: [u16; 3],
    /// Upper side of that box.
    pub upper: [u16; 3],
    /// Blocks in this payload: 1 to 8.
    pub count: u32,
    /// Number of the first block; the others follow it.
    pub first: u32,
    /// The payload that continues the list, or [`NONE`].
    pub next: u32,
    /// Zero.
    pub unused: [u32; 2],
}

impl Payload {
    /// The box of a block.
    pub fn boxed(&self, at: usize) -> LatticeBox {
        (self.sides.map(|[lower, _]| lower[at]), self.sides.map(|[_, upper]| upper[at]))
    }

    /// The box around all that is listed.
    pub fn hull(&self) -> LatticeBox {
        (self.lower, self.upper)
    }

    /// With these boxes, absent ones included, and nothing else.
    pub fn of_boxes(boxes: [LatticeBox; PAYLOAD_BLOCKS]) -> Self {
        let (lower, upper) = hull(boxes);
        Self {
            sides: core::array::from_fn(|k| [boxes.map(|b| b.0[k]), boxes.map(|b| b.1[k])]),
            lower,
            upper,
            count: boxes.iter().filter(|b| **b != ABSENT).count() as u32,
            first: 0,
            next: NONE,
            unused: [0; 2],
        }
    }
}

/// Where a child of a branch leads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Child {
    /// To a branch, by its number.
    Branch(u32),
    /// To a block, by its number.
    Block(u32),
    /// Nowhere.
    Vacant,
}

impl Child {
    /// Set in the words of blocks.
    const BLOCK: u32 = 1 << 31;
    /// Numbers that fit beside the flag.
    pub const NUMBERS: u32 = Self::BLOCK - 1;

    /// Its word in a branch. Numbers are below [`Child::NUMBERS`].
    #[inline]
    pub fn to_word(self) -> u32 {
        match self {
            Self::Branch(number) => number,
            Self::Block(number) => number | Self::BLOCK,
            Self::Vacant => NONE,
        }
    }

    /// Reads what [`Child::to_word`] wrote.
    #[inline(always)]
    pub fn from_word(word: u32) -> Self {
        match word {
            NONE => Self::Vacant,
            _ if word & Self::BLOCK != 0 => Self::Block(word & Self::NUMBERS),
            _ => Self::Branch(word),
        }
    }
}

/// Where a vacant child's box lies: in a corner of the root that few rays meet. Those that do find no block there.
pub const CORNER: LatticeBox = ([u16::MAX; 3], [u16::MAX; 3]);

/// Up to eight boxes with what they hold, 128 bytes: a node of the bounding volume hierarchy over all blocks.
///
/// It serves who has no use for neighbours: rays that descend from the first branch, alone or many together. Children
/// stand in slots such that a ray of octant `neg` meets those of low slot XOR `neg` first, as far as there is such an order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Branch {
    /// Lower and upper sides of the children's boxes, axis by axis.
    pub sides: [[[u16; BRANCH_WIDTH]; 2]; 3],
    /// See [`Child`].
    pub children: [u32; BRANCH_WIDTH],
}

impl Branch {
    /// With nothing in it.
    pub const VACANT: Self = Self { sides: [[[u16::MAX; BRANCH_WIDTH]; 2]; 3], children: [NONE; BRANCH_WIDTH] };

    /// The child in a slot, and its box.
    #[inline]
    pub fn child(&self, slot: usize) -> (LatticeBox, Child) {
        let boxed = (self.sides.map(|[lower, _]| lower[slot]), self.sides.map(|[_, upper]| upper[slot]));
        (boxed, Child::from_word(self.children[slot]))
    }

    /// Puts a child in a slot.
    pub fn put(&mut self, slot: usize, boxed: LatticeBox, child: Child) {
        for k in 0..3 {
            (self.sides[k][0][slot], self.sides[k][1][slot]) = (boxed.0[k], boxed.1[k]);
        }
        self.children[slot] = child.to_word();
    }

    /// The box around all children.
    pub fn hull(&self) -> LatticeBox {
        let children = (0..BRANCH_WIDTH).map(|slot| self.child(slot));
        hull(children.filter(|(_, child)| *child != Child::Vacant).map(|(boxed, _)| boxed))
    }

    /// Per axis, the sides of all boxes that a ray of octant `neg` meets first, or last with `neg` inverted.
    #[inline(always)]
    pub fn facing(&self, neg: u32) -> [&[u16; BRANCH_WIDTH]; 3] {
        per_axis!(k => &self.sides[k][(neg >> k & 1) as usize])
    }
}

/// Eight triangles: 320 bytes. A vacant lane repeats the first one's corners, and its primitive never wins the tie.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Block {
    /// Corner, axis, lane: in lattice units.
    pub vertices: [[[f32; BLOCK_WIDTH]; 3]; 3],
    /// The triangle of each lane, or [`NONE`].
    pub primitives: [u32; BLOCK_WIDTH],
}

impl Block {
    /// Without a triangle.
    pub const VACANT: Self = Self { vertices: [[[0.0; BLOCK_WIDTH]; 3]; 3], primitives: [NONE; BLOCK_WIDTH] };

    /// Primitive and corners of each lane that is not vacant.
    pub fn triangles(self) -> impl Iterator<Item = (u32, [[f32; 3]; 3])> {
        let lanes = (0..BLOCK_WIDTH).filter(move |lane| self.primitives[*lane] != NONE);
        lanes.map(move |lane| (self.primitives[lane], self.corners(lane)))
    }

    /// The three corners of a lane.
    pub fn corners(&self, lane: usize) -> [[f32; 3]; 3] {
        self.vertices.map(|corner| corner.map(|axis| axis[lane]))
    }
}

/// Eight triangles by the numbers of their vertices, 84 bytes: a block of a compact octree. Vacant lanes are as in
/// [`Block`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct IndexedBlock {
    /// The triangle of each lane, or [`NONE`].
    pub primitives: [u32; BLOCK_WIDTH],
    /// The vertex that the others are counted from.
    pub base: u32,
    /// Corner, lane: the number of its vertex, less `base`.
    pub numbers: [[u16; BLOCK_WIDTH]; 3],
}
