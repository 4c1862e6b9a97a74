//! `Octree`: serialized words that were validated once, and what they hold.

use crate::blocks::{Blocks, Indexed};
use crate::error::DecodeError;
use crate::frame::Frame;
use crate::layout::{Branch, Key, MAX_LEVEL, Payload, Record};
use crate::policy::{Policy, Standard};
use crate::wire::{Header, Section, Spans};
use crate::{validate, wire};

/// A box in the caller's units; empty when a lower side is above its upper side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Lower corner.
    pub lower: [f64; 3],
    /// Upper corner.
    pub upper: [f64; 3],
}

/// A valid octree over owned or borrowed words: `Vec<u32>`, `&[u32]`, a memory map, flash.
///
/// The words are the file, the memory form and the GPU form in one; nothing is copied or fixed up.
#[derive(Clone, Debug)]
pub struct Octree<W> {
    words: W,
    spans: Spans,
}

impl<W: AsRef<[u32]>> Octree<W> {
    /// Checks everything once, in time linear in the size and without allocation, and takes the words over.
    ///
    /// # Errors
    /// [`DecodeError`] names the first thing that is wrong. No content makes this, or tracing what it accepts, panic.
    pub fn from_words(words: W) -> Result<Self, DecodeError> {
        wire::check(words.as_ref())?;
        Self::from_sealed::<Standard>(words)
    }

    /// As [`Octree::from_words`], under a policy that tests may spoil, of words that [`wire::seal`] has just given their
    /// checksum: it is not computed again.
    #[doc(hidden)]
    pub fn from_sealed<P: Policy>(words: W) -> Result<Self, DecodeError> {
        let spans = wire::open(words.as_ref())?;
        validate::sections(&Parts::new(words.as_ref(), &spans)?, P::KEEPS_MESH_MARGIN)?;
        Ok(Self { words, spans })
    }

    /// The same octree, borrowed.
    pub fn view(&self) -> Octree<&[u32]> {
        Octree { words: self.words.as_ref(), spans: self.spans }
    }

    /// The words, which are the file.
    pub fn as_words(&self) -> &[u32] {
        self.words.as_ref()
    }

    /// The words, by value.
    pub fn into_words(self) -> W {
        self.words
    }

    /// What the words hold, section by section.
    pub fn parts(&self) -> Parts<'_> {
        // The spans were checked when the octree was made.
        Parts::new(self.words.as_ref(), &self.spans).unwrap_or(Parts::EMPTY)
    }

    /// The lattice frame.
    #[inline]
    pub fn frame(&self) -> Frame {
        self.section::<Header>(Section::Header).first().map_or(Parts::EMPTY.frame, Header::frame)
    }

    /// The hierarchy over the blocks; empty where no triangle is listed.
    #[inline]
    pub fn branches(&self) -> &[Branch] {
        self.section(Section::Branches)
    }

    /// The triangles, eight by eight.
    #[inline]
    pub fn blocks(&self) -> Blocks<'_> {
        if self.is_compact() {
            let (blocks, vertices) = (self.section(Section::IndexedBlocks), self.section(Section::Vertices));
            Blocks::Indexed(Indexed { blocks, vertices })
        } else {
            Blocks::Packed(self.section(Section::Blocks))
        }
    }

    /// Whether its blocks name their vertices by number: fewer bytes, and slower to trace.
    #[inline]
    pub fn is_compact(&self) -> bool {
        self.spans[Section::IndexedBlocks as usize].1 > 0
    }

    #[inline]
    fn section<T: bytemuck::Pod>(&self, section: Section) -> &[T] {
        slice(self.words.as_ref(), &self.spans, section).unwrap_or(&[])
    }

    /// Offset and length in words of a section.
    pub fn span(&self, section: Section) -> (u32, u32) {
        self.spans[section as usize]
    }

    /// The box around all listed triangles, in whole lattice steps (2^-16 of the root's edge) outward.
    pub fn bounds(&self) -> Aabb {
        self.parts().bounds()
    }

    /// Counts, by a scan of the records.
    pub fn stats(&self) -> Stats {
        self.parts().stats()
    }
}

impl<'a> Octree<&'a [u32]> {
    /// Checks and borrows little-endian bytes, such as a memory map, without a copy.
    ///
    /// # Errors
    /// As [`Octree::from_words`], and when the bytes are not aligned to 4 or no whole number of words.
    pub fn from_bytes(bytes: &'a [u8]) -> Result<Self, DecodeError> {
        if bytes.len() % 4 != 0 {
            return Err(DecodeError::Ragged { bytes: bytes.len() });
        }
        match bytemuck::try_cast_slice(bytes) {
            Ok(words) => Self::from_words(words),
            Err(_) => Err(DecodeError::Misaligned { remainder: bytes.as_ptr().addr() % align_of::<u32>() }),
        }
    }
}

/// The sections of an octree as slices.
#[derive(Clone, Copy, Debug)]
pub struct Parts<'a> {
    /// Counts and settings.
    pub header: Header,
    /// The frame that the header holds.
    pub frame: Frame,
    /// All nodes; the root is number 0, and numbers 1 to 7 are vacant.
    pub records: &'a [Record],
    keys: &'a [[u32; 2]],
    /// What non-empty leaves list.
    pub payloads: &'a [Payload],
    /// The triangles.
    pub blocks: Blocks<'a>,
    /// The hierarchy over the blocks.
    pub branches: &'a [Branch],
    /// Record numbers of the entry grid, x fastest.
    pub grid: &'a [u32],
    /// One material id a triangle, or empty.
    pub materials: &'a [u32],
}

impl<'a> Parts<'a> {
    const EMPTY: Parts<'static> = Parts {
        header: Header {
            primitives: 0,
            dropped: 0,
            collapsed: 0,
            references: 0,
            grid_bits: 0,
            scale_exponent: 0,
            padding: 0.0,
            rounding: 0.0,
            step_cost: 0.0,
            max_level: 0,
            origin: [0; 6],
        },
        frame: Frame { origin: [0.0; 3], scale_exponent: 0 },
        records: &[],
        keys: &[],
        payloads: &[],
        blocks: Blocks::EMPTY,
        branches: &[],
        grid: &[],
        materials: &[],
    };

    pub(crate) fn new(words: &'a [u32], spans: &Spans) -> Result<Self, DecodeError> {
        let header: &[Header] = slice(words, spans, Section::Header)?;
        let &[header] = header else { return Err(wrong_length(spans, Section::Header)) };
        let (indexed, vertices) = (Section::IndexedBlocks, Section::Vertices);
        let indexed = Indexed { blocks: slice(words, spans, indexed)?, vertices: slice(words, spans, vertices)? };
        let blocks = Blocks::new(slice(words, spans, Section::Blocks)?, indexed)?;
        Ok(Self {
            header,
            frame: header.frame(),
            records: slice(words, spans, Section::Records)?,
            keys: slice(words, spans, Section::Keys)?,
            payloads: slice(words, spans, Section::Payloads)?,
            blocks,
            branches: slice(words, spans, Section::Branches)?,
            grid: slice(words, spans, Section::Grid)?,
            materials: slice(words, spans, Section::Materials)?,
        })
    }

    /// The key of a record.
    pub fn key(&self, record: u32) -> Key {
        Key::from_words(self.keys[record as usize])
    }

    pub(crate) fn key_count(&self) -> usize {
        self.keys.len()
    }

    /// Leaves, as (record number, record), in depth-first order.
    pub fn leaves(&self) -> impl Iterator<Item = (u32, &'a Record)> + use<'a> {
        let numbered = (0..).zip(self.records);
        numbered.filter(|(number, record)| (*number == 0 || *number > 7) && !record.head().is_inner())
    }

    /// The payloads of a leaf, first to last.
    pub fn payloads_of(&self, leaf: &Record) -> impl Iterator<Item = &'a Payload> + use<'a> {
        let payloads = self.payloads;
        let first = (leaf.head().t_count() != 0).then(|| &payloads[leaf.offset as usize]);
        core::iter::successors(first, move |payload| payloads.get(payload.next as usize))
    }

    /// The triangles of a leaf, as (primitive, corners in lattice units).
    pub fn triangles_of(&self, leaf: &Record) -> impl Iterator<Item = (u32, [[f32; 3]; 3])> + use<'a> {
        let blocks = self.blocks;
        self.payloads_of(leaf).flat_map(move |payload| blocks.of(payload)).flat_map(|block| block.triangles())
    }

    fn bounds(&self) -> Aabb {
        let Some((lower, upper)) = self.branches.first().map(Branch::hull) else {
            return Aabb { lower: [f64::INFINITY; 3], upper: [f64::NEG_INFINITY; 3] };
        };
        let at = |steps: [u16; 3], end: f32| {
            self.frame.to_caller(steps.map(|step| (f32::from(step) + end) * crate::layout::LATTICE_STEP))
        };
        Aabb { lower: at(lower, 0.0), upper: at(upper, 1.0) }
    }

    fn stats(&self) -> Stats {
        let mut stats = Stats {
            primitives: self.header.primitives,
            dropped: self.header.dropped,
            collapsed: self.header.collapsed,
            references: self.header.references,
            blocks: self.blocks.len() as u32,
            leaves: 0,
            empty_leaves: 0,
            inner: 0,
            leaves_at_level: [0; MAX_LEVEL as usize + 1],
            leaves_by_blocks: [0; LEAF_SIZES],
        };
        stats.inner = self.records.iter().filter(|record| record.head().is_inner()).count() as u32;
        for (_, leaf) in self.leaves() {
            let blocks: usize = self.payloads_of(leaf).map(|payload| payload.count as usize).sum();
            stats.leaves += 1;
            stats.empty_leaves += u32::from(blocks == 0);
            stats.leaves_at_level[leaf.head().level() as usize] += 1;
            stats.leaves_by_blocks[blocks.min(LEAF_SIZES - 1)] += 1;
        }
        stats
    }
}

/// Entries of [`Stats::leaves_by_blocks`]: 0 to 8 blocks, and more.
pub const LEAF_SIZES: usize = 10;

/// What an octree holds, in numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Stats {
    /// Triangles of the mesh, those dropped included.
    pub primitives: u32,
    /// Triangles left out because two vertices are equal after rounding.
    pub dropped: u32,
    /// Of those, how many lost their extent by rounding: detail too small for the scene's extent.
    pub collapsed: u32,
    /// Triangles listed, counted once a leaf.
    pub references: u32,
    /// Blocks of eight triangles.
    pub blocks: u32,
    /// Leaves, empty ones included.
    pub leaves: u32,
    /// Leaves that list nothing.
    pub empty_leaves: u32,
    /// Inner nodes.
    pub inner: u32,
    /// Leaves of each level, root first.
    pub leaves_at_level: [u32; MAX_LEVEL as usize + 1],
    /// Leaves of 0, 1, .. 8 blocks, and of more.
    pub leaves_by_blocks: [u32; LEAF_SIZES],
}

#[inline]
fn slice<'a, T: bytemuck::Pod>(words: &'a [u32], spans: &Spans, section: Section) -> Result<&'a [T], DecodeError> {
    let (offset, length) = spans[section as usize];
    let words = &words[offset as usize..][..length as usize];
    bytemuck::try_cast_slice(words).map_err(|_| wrong_length(spans, section))
}

fn wrong_length(spans: &Spans, section: Section) -> DecodeError {
    DecodeError::SectionLength { section, words: spans[section as usize].1 }
}
