//! `Octree`: serialized words that were validated once, and what they hold.

use core::fmt;

use crate::aabb::Aabb;
use crate::blocks::{Blocks, Indexed};
use crate::error::DecodeError;
use crate::frame::Frame;
use crate::layout::{BvhNode, Lattice, LatticeBox, Section};
use crate::parts::{Parts, slice};
use crate::policy::{Policy, Standard};
use crate::stats::Stats;
use crate::wire::{Header, Spans};
use crate::{validate, wire};

/// A valid octree over owned or borrowed words: `Vec<u32>`, `&[u32]`, a memory map, flash.
///
/// The words are the file, the memory form and the GPU form in one; nothing is copied or fixed up.
#[derive(Clone)]
pub struct Octree<W> {
    words: W,
    spans: Spans,
    /// See [`Parts::hull`]; rays that walk alone would take long to find it.
    hull: LatticeBox,
}

impl<W: AsRef<[u32]>> Octree<W> {
    /// Checks everything once, in time linear in the size and without allocation, and takes the words over.
    ///
    /// # Errors
    /// [`DecodeError`] names the first thing that is wrong. No content makes this, or tracing what it accepts, panic.
    pub fn from_words(words: W) -> Result<Self, DecodeError> {
        wire::check(words.as_ref())?;
        Self::from_sealed(words)
    }

    /// As [`Octree::from_words`], of words that [`wire::seal`] has just given their checksum, as builders do: it is not
    /// computed again.
    ///
    /// # Errors
    /// As [`Octree::from_words`], but for the checksum.
    pub fn from_sealed(words: W) -> Result<Self, DecodeError> {
        Self::from_sealed_with::<Standard>(words)
    }

    /// See [`crate::testing::from_sealed`].
    pub(crate) fn from_sealed_with<P: Policy>(words: W) -> Result<Self, DecodeError> {
        let spans = wire::open(words.as_ref())?;
        let parts = Parts::new(words.as_ref(), &spans, LatticeBox::VACANT)?;
        validate::sections(&parts, P::KEEPS_MESH_MARGIN)?;
        let hull = parts.bvh.first().map_or(LatticeBox::VACANT, BvhNode::hull);
        Ok(Self { words, spans, hull })
    }

    /// The same octree, borrowed.
    pub fn view(&self) -> Octree<&[u32]> {
        Octree { words: self.words.as_ref(), spans: self.spans, hull: self.hull }
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
        Parts::new(self.words.as_ref(), &self.spans, self.hull).unwrap_or(Parts::EMPTY)
    }

    /// The lattice frame.
    #[inline]
    pub fn frame(&self) -> Frame {
        self.section::<Header>(Section::Header).first().map_or(Parts::EMPTY.frame, Header::frame)
    }

    /// The BVH over the blocks, its root first; empty where no triangle is listed.
    #[inline]
    pub fn bvh(&self) -> &[BvhNode] {
        self.section(Section::Bvh)
    }

    /// In wide octrees one lattice a node of the BVH; else empty, and all count the root's steps.
    #[inline]
    pub fn lattices(&self) -> &[Lattice] {
        self.section(Section::Lattices)
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
        Stats::of(&self.parts())
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

/// Counts instead of words, of which there may be millions.
impl<W: AsRef<[u32]>> fmt::Debug for Octree<W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts = self.parts();
        f.debug_struct("Octree")
            .field("words", &self.as_words().len())
            .field("primitives", &parts.header.primitives)
            .field("records", &parts.records.len())
            .field("bvh_nodes", &parts.bvh.len())
            .field("blocks", &parts.blocks.len())
            .field("is_compact", &self.is_compact())
            .finish_non_exhaustive()
    }
}
