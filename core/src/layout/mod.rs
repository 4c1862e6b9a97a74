//! What the words of a file mean: every shared constant and bit field of the format, once.
//!
//! Each kind of item has its file: the octree's [`Record`]s with their [`Key`]s, the [`BvhNode`]s, which are what leaves list
//! as well, and the [`Block`]s of triangles that both structures lead to. `docs/format.md` shows how they stand in a file.

mod block;
mod bvh;
mod key;
mod lattice;
mod lattice_box;
mod record;
mod section;

pub use block::{BLOCK_WIDTH, BLOCK_WORDS, Block, INDEXED_BLOCK_WORDS, IndexedBlock, Triangle, VERTEX_WORDS};
pub use bvh::{BVH_NODE_WORDS, BVH_WIDTH, BvhNode, Child, MAX_DEPTH};
pub use key::{KEY_WORDS, Key};
pub use lattice::{FINEST_STEP, LATTICE_WORDS, Lattice};
pub use lattice_box::LatticeBox;
pub use record::{
    INNER, LEVEL_MASK, LEVEL_SHIFT, LINK_COARSER, LINK_FINER, LINK_NONE, LINK_SAME, LINK_SHIFT, RECORD_WORDS, Record,
    RecordHead, T_COUNT_MASK,
};
pub use section::Section;

/// The first word of a file: the bytes `lwok`.
pub const MAGIC: u32 = u32::from_le_bytes(*b"lwok");
/// The format's version. Readers refuse every other one.
pub const VERSION: u32 = 2;

/// Deepest level of a leaf: cells 2^-16 of the root's edge.
pub const MAX_LEVEL: u32 = 16;
/// Lattice steps along the root's edge. A step is the edge of the smallest cell, and the unit of lattice coordinates.
pub const LATTICE: u32 = 1 << MAX_LEVEL;

/// Stands where there is no record, child or primitive.
pub const NONE: u32 = u32::MAX;
/// Sections start at multiples of this many words: one cache line.
pub const SECTION_ALIGN: usize = 16;
