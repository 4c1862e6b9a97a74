//! The words of an octree, to be spoiled section by section and sealed again.

use leafwalk_core::layout::Section;
use leafwalk_core::layout::{Block, BvhNode, IndexedBlock, Lattice, Record};
use leafwalk_core::wire::{self, Header, Spans, TABLE_ROW};
use leafwalk_core::{DecodeError, Octree};

/// Where the section table starts.
const TABLE: usize = wire::PREAMBLE_WORDS;

/// The words of an octree, which were valid before they were edited.
#[derive(Clone)]
pub struct Edited {
    /// All words of the file.
    pub words: Vec<u32>,
    spans: Spans,
}

impl Edited {
    /// Copies the words of a valid octree.
    pub fn new<W: AsRef<[u32]>>(octree: &Octree<W>) -> Self {
        Self { words: octree.as_words().to_vec(), spans: Section::ALL.map(|section| octree.span(section)) }
    }

    /// The words of a section.
    pub fn section(&mut self, section: Section) -> &mut [u32] {
        let (offset, length) = self.spans[section as usize];
        &mut self.words[offset as usize..][..length as usize]
    }

    /// The header.
    pub fn header(&mut self) -> &mut Header {
        &mut bytemuck::cast_slice_mut(self.section(Section::Header))[0]
    }

    /// The records of all nodes.
    pub fn records(&mut self) -> &mut [Record] {
        bytemuck::cast_slice_mut(self.section(Section::Records))
    }

    /// The keys of all nodes.
    pub fn keys(&mut self) -> &mut [[u32; 2]] {
        bytemuck::cast_slice_mut(self.section(Section::Keys))
    }

    /// The payloads of the leaves.
    pub fn payloads(&mut self) -> &mut [BvhNode] {
        bytemuck::cast_slice_mut(self.section(Section::Payloads))
    }

    /// The blocks of a packed octree; a compact one has none.
    pub fn blocks(&mut self) -> &mut [Block] {
        bytemuck::cast_slice_mut(self.section(Section::Blocks))
    }

    /// The blocks of a compact octree; a packed one has none.
    pub fn indexed_blocks(&mut self) -> &mut [IndexedBlock] {
        bytemuck::cast_slice_mut(self.section(Section::IndexedBlocks))
    }

    /// The vertices of a compact octree; a packed one has none.
    pub fn vertices(&mut self) -> &mut [[f32; 3]] {
        bytemuck::cast_slice_mut(self.section(Section::Vertices))
    }

    /// The nodes of the BVH.
    pub fn bvh(&mut self) -> &mut [BvhNode] {
        bytemuck::cast_slice_mut(self.section(Section::Bvh))
    }

    /// The lattices of a wide octree's nodes; another one has none.
    pub fn lattices(&mut self) -> &mut [Lattice] {
        bytemuck::cast_slice_mut(self.section(Section::Lattices))
    }

    /// The entry grid.
    pub fn grid(&mut self) -> &mut [u32] {
        self.section(Section::Grid)
    }

    /// The row of the section table that describes a section: tag, offset, number of words.
    pub fn row(&mut self, section: Section) -> &mut [u32] {
        &mut self.words[TABLE + TABLE_ROW * section as usize..][..TABLE_ROW]
    }

    /// Gives a section other words, of any number. The sections behind it move.
    pub fn replace(&mut self, section: Section, content: &[u32]) {
        let mut contents = Section::ALL.map(|section| self.section(section).to_vec());
        contents[section as usize] = content.to_vec();
        let (spans, total) = wire::plan(contents.each_ref().map(Vec::len)).expect("fewer than 2^32 words");
        self.spans = spans;
        self.words = vec![0; total as usize];
        for (section, content) in Section::ALL.into_iter().zip(contents) {
            self.section(section).copy_from_slice(&content);
        }
        wire::seal(&mut self.words, &spans);
    }

    /// Makes the checksum right and decodes the words.
    pub fn decode(&mut self) -> Result<Octree<&[u32]>, DecodeError> {
        reseal(&mut self.words);
        Octree::from_words(&self.words)
    }

    /// Decodes a copy of the words with an edit.
    pub fn decode_with(&self, edit: impl FnOnce(&mut Self)) -> Result<Octree<Vec<u32>>, DecodeError> {
        let mut edited = self.clone();
        edit(&mut edited);
        reseal(&mut edited.words);
        Octree::from_words(edited.words)
    }
}

/// Makes the checksum of a file right.
pub fn reseal(words: &mut [u32]) {
    const CHECKSUM: usize = 3;
    if words.len() > CHECKSUM {
        words[CHECKSUM] = wire::checksum(words);
    }
}
