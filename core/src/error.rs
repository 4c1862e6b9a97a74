//! Why bytes are not an octree.

use core::fmt;

use crate::layout::Section;

/// What is wrong with a serialized octree. Nothing of it was used.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum DecodeError {
    /// The bytes do not start at a multiple of 4.
    Misaligned {
        /// Address modulo 4.
        remainder: usize,
    },
    /// The length is no multiple of 4 bytes.
    Ragged {
        /// Length in bytes.
        bytes: usize,
    },
    /// Fewer, or more, words than the file says it has.
    Truncated {
        /// Words present.
        words: usize,
        /// Words that the file says it has.
        needed: usize,
    },
    /// The first word is not the format's.
    BadMagic {
        /// The first word.
        found: u32,
    },
    /// Written by, or read on, a machine of the other byte order.
    OtherEndianness,
    /// A version that this release does not read.
    Version {
        /// The version word.
        found: u32,
    },
    /// The checksum differs: the file was damaged.
    Checksum {
        /// In the file.
        stored: u32,
        /// The checksum of the words present.
        computed: u32,
    },
    /// The section table does not fit.
    SectionTable {
        /// Number of sections claimed.
        sections: u32,
    },
    /// A section lies outside the file, or over the section table or the section before it.
    SectionRange {
        /// Four ASCII characters.
        tag: u32,
        /// First word.
        offset: u32,
        /// Words.
        length: u32,
    },
    /// A section starts elsewhere than at a multiple of 16 words, where devices cannot read it.
    SectionOffset {
        /// Which one.
        section: Section,
        /// First word.
        offset: u32,
    },
    /// A section stands in the table twice.
    SectionTwice {
        /// Which one.
        section: Section,
    },
    /// A section is absent, or its length is impossible.
    SectionLength {
        /// Which one.
        section: Section,
        /// Its words.
        words: u32,
    },
    /// A number in the header is out of its range.
    Header {
        /// Which field.
        field: &'static str,
    },
    /// A node's fields contradict the tree.
    BadRecord {
        /// Record number.
        record: u32,
        /// What is wrong with it.
        fault: RecordFault,
    },
    /// A leaf's link does not lead to the leaf on the other side of the face.
    BadLink {
        /// Record number of the leaf.
        record: u32,
        /// 2 * axis + positive.
        face: u32,
    },
    /// A payload leads to what is not there, or a box of it reaches out of its leaf or of the node that it leads to.
    BadPayload {
        /// Payload number.
        payload: u32,
    },
    /// A BVH node leads to what is not there or out of turn, or lies too deep; or a child's box is not that of its own
    /// children (in a wide octree: does not hold them).
    BadBvhNode {
        /// Number of the node.
        node: u32,
    },
    /// The lattice of a BVH node has no power of two for its step, or a corner that is no multiple of it; or the root's is
    /// not that of the root.
    BadLattice {
        /// Number of the node.
        node: u32,
    },
    /// There are both packed and indexed blocks.
    BlocksTwice,
    /// A vertex of a compact octree lies outside the root.
    BadVertex {
        /// Its number.
        vertex: u32,
    },
    /// A block holds a coordinate outside the root, a primitive out of range, or vertices out of range or turn.
    BadBlock {
        /// Block number.
        block: u32,
        /// 0 to 7.
        lane: u32,
    },
    /// An entry of the grid does not lead to the node of its cell.
    BadGrid {
        /// Which entry.
        entry: u32,
    },
}

/// What is wrong with a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RecordFault {
    /// A bit without a meaning is set, or a vacant record is not zero.
    StrayBits,
    /// Its level or key is not that of its place in the tree.
    Place,
    /// Its children are not the next block of eight siblings.
    Children,
    /// Its payload is not the next one, or has another number of entries than it says.
    Payload,
}

impl fmt::Display for DecodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Misaligned { remainder } => {
                write!(
                    f,
                    "the bytes start {remainder} past a multiple of 4: copy them to an aligned buffer, or include them as AlignedBytes"
                )
            }
            Self::Ragged { bytes } => write!(f, "{bytes} bytes are no whole number of 4-byte words: the file is cut"),
            Self::Truncated { words, needed } => {
                write!(f, "{words} words where the file says {needed}: it is cut, or something was appended")
            }
            Self::BadMagic { found } => write!(f, "the first word is {found:#010x}: this is no leafwalk octree"),
            Self::OtherEndianness => {
                write!(f, "the words have the other byte order: build the octree on this kind of machine")
            }
            Self::Version { found } => {
                write!(
                    f,
                    "format version {found}; this release reads {}: build the octree anew",
                    crate::layout::VERSION
                )
            }
            Self::Checksum { stored, computed } => {
                write!(f, "checksum {computed:#010x} where the file says {stored:#010x}: it was damaged, copy it anew")
            }
            Self::SectionTable { sections } => write!(f, "a table of {sections} sections does not fit into the file"),
            Self::SectionRange { tag, offset, length } => {
                let tag = tag.to_le_bytes();
                let tag = tag.escape_ascii();
                write!(
                    f,
                    "section '{tag}' at word {offset}, {length} words long, lies outside the file or over another"
                )
            }
            Self::SectionOffset { section, offset } => {
                let align = crate::layout::SECTION_ALIGN;
                write!(f, "section '{}' starts at word {offset}, which is no multiple of {align}", section.name())
            }
            Self::SectionTwice { section } => write!(f, "section '{}' stands in the table twice", section.name()),
            Self::SectionLength { section, words } => {
                write!(f, "section '{}' cannot be {words} words long here", section.name())
            }
            Self::Header { field } => write!(f, "header field '{field}' is out of range"),
            Self::BadRecord { record, fault } => {
                let what = match fault {
                    RecordFault::StrayBits => "has bits set that mean nothing",
                    RecordFault::Place => "is not where its place in the tree says",
                    RecordFault::Children => "does not name the next eight siblings as its children",
                    RecordFault::Payload => "disagrees with its payload",
                };
                write!(f, "record {record} {what}")
            }
            Self::BadLink { record, face } => {
                write!(f, "record {record} is not linked to the leaf across its face {face}")
            }
            Self::BadBvhNode { node } => write!(f, "BVH node {node} is inconsistent"),
            Self::BadLattice { node } => write!(f, "the lattice of BVH node {node} is inconsistent"),
            Self::BadPayload { payload } => write!(f, "payload {payload} is inconsistent"),
            Self::BadBlock { block, lane } => {
                write!(f, "block {block}, lane {lane}: coordinate, vertex or primitive out of range")
            }
            Self::BadVertex { vertex } => write!(f, "vertex {vertex} has a coordinate out of range"),
            Self::BlocksTwice => write!(f, "both packed and indexed blocks: build the octree anew"),
            Self::BadGrid { entry } => write!(f, "entry {entry} of the grid leads elsewhere"),
        }
    }
}

impl core::error::Error for DecodeError {}
