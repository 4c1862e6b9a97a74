//! The words of an octree, to be spoiled section by section and sealed again.

use leafwalk::wire::{self, Header, Section, Spans, TABLE_ROW};
use leafwalk::{DecodeError, Octree};
use leafwalk_core::layout::{Block, Branch, IndexedBlock, Payload, Record};

/// Where the section table starts.
const TABLE: usize = wire::PREAMBLE_WORDS;

/// Words that once were valid.
#[derive(Clone)]
pub struct Edited {
    pub words: Vec<u32>,
    spans: Spans,
}

impl Edited {
    pub fn new<W: AsRef<[u32]>>(octree: &Octree<W>) -> Self {
        Self { words: octree.as_words().to_vec(), spans: Section::ALL.map(|section| octree.span(section)) }
    }

    pub fn section(&mut self, section: Section) -> &mut [u32] {
        let (offset, length) = self.spans[section as usize];
        &mut self.words[offset as usize..][..length as usize]
    }

    pub fn header(&mut self) -> &mut Header {
        &mut bytemuck::cast_slice_mut(self.section(Section::Header))[0]
    }

    pub fn records(&mut self) -> &mut [Record] {
        bytemuck::cast_slice_mut(self.section(Section::Records))
    }

    pub fn keys(&mut self) -> &mut [[u32; 2]] {
        bytemuck::cast_slice_mut(self.section(Section::Keys))
    }

    pub fn payloads(&mut self) -> &mut [Payload] {
        bytemuck::cast_slice_mut(self.section(Section::Payloads))
    }

    pub fn blocks(&mut self) -> &mut [Block] {
        bytemuck::cast_slice_mut(self.section(Section::Blocks))
    }

    pub fn indexed_blocks(&mut self) -> &mut [IndexedBlock] {
        bytemuck::cast_slice_mut(self.section(Section::IndexedBlocks))
    }

    pub fn vertices(&mut self) -> &mut [[f32; 3]] {
        bytemuck::cast_slice_mut(self.section(Section::Vertices))
    }

    pub fn branches(&mut self) -> &mut [Branch] {
        bytemuck::cast_slice_mut(self.section(Section::Branches))
    }

    pub fn grid(&mut self) -> &mut [u32] {
        self.section(Section::Grid)
    }

    /// A section's row of the table: tag, offset, words.
    pub fn row(&mut self, section: Section) -> &mut [u32] {
        &mut self.words[TABLE + TABLE_ROW * section as usize..][..TABLE_ROW]
    }

    /// Gives a section other words, of any number; the others move.
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

    /// Makes the checksum right and decodes.
    pub fn decode(&mut self) -> Result<Octree<&[u32]>, DecodeError> {
        reseal(&mut self.words);
        Octree::from_words(&self.words)
    }

    /// Decodes with one edit; the words are as before afterwards.
    pub fn decode_with(&self, edit: impl FnOnce(&mut Self)) -> Result<Octree<Vec<u32>>, DecodeError> {
        let mut edited = self.clone();
        edit(&mut edited);
        reseal(&mut edited.words);
        Octree::from_words(edited.words)
    }
}

/// Makes the checksum right.
pub fn reseal(words: &mut [u32]) {
    const CHECKSUM: usize = 3;
    if words.len() > CHECKSUM {
        words[CHECKSUM] = wire::checksum(words);
    }
}
