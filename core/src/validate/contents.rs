//! Leaves take up payloads and blocks in the order of a depth-first traversal, each once: so a chain ends, and all lists
//! together are no longer than the file.

use super::wrong_length;
use crate::blocks::{Blocks, Indexed};
use crate::error::{DecodeError, RecordFault};
use crate::layout::{
    BLOCK_WORDS, CHAINED, INDEXED_BLOCK_WORDS, LatticeBox, NONE, PAYLOAD_BLOCKS, PAYLOAD_WORDS, Payload, Section,
};
use crate::parts::Parts;

/// What has been taken up so far.
pub(super) struct Contents<'a> {
    parts: &'a Parts<'a>,
    payloads: u32,
    blocks: u32,
}

impl<'a> Contents<'a> {
    pub(super) fn new(parts: &'a Parts<'a>) -> Self {
        Self { parts, payloads: 0, blocks: 0 }
    }

    /// Takes up the payloads of a leaf, and their blocks.
    pub(super) fn leaf(&mut self, record: u32) -> Result<(), DecodeError> {
        let bad = Err(DecodeError::BadRecord { record, fault: RecordFault::Payload });
        let leaf = &self.parts.records[record as usize];
        let count = leaf.head().t_count();
        if count == 0 {
            return if leaf.offset == 0 { Ok(()) } else { bad };
        }
        let Some(mut payload) = self.next().filter(|_| leaf.offset == self.payloads) else { return bad };
        if count != if payload.next == NONE { payload.count } else { CHAINED } {
            return bad;
        }
        let tight = payload.hull();
        loop {
            let bad = Err(DecodeError::BadPayload { payload: self.payloads });
            if payload.first != self.blocks || !self.is_consistent(payload, tight) {
                return bad;
            }
            self.blocks += payload.count;
            self.payloads += 1;
            if payload.next == NONE {
                return Ok(());
            }
            payload = match self.next() {
                Some(next) if payload.next == self.payloads => next,
                _ => return bad,
            };
        }
    }

    fn next(&self) -> Option<&'a Payload> {
        self.parts.payloads.get(self.payloads as usize)
    }

    /// Whether a payload has its blocks, and the tight box of the leaf its boxes.
    fn is_consistent(&self, payload: &Payload, tight: LatticeBox) -> bool {
        let count = payload.count as usize;
        let is_inside = |outer: LatticeBox, inner: LatticeBox| inner.is_whole() && outer.contains(inner);
        let own = payload.hull();
        (1..=PAYLOAD_BLOCKS).contains(&count)
            && payload.unused == [0; 2]
            && payload.first as usize + count <= self.parts.blocks.len()
            && is_inside(tight, own)
            && (0..count).all(|block| is_inside(own, payload.boxed(block)))
            && (count..PAYLOAD_BLOCKS).all(|block| payload.boxed(block) == LatticeBox::EMPTY)
    }

    /// Checks that no payload and no block is left over.
    pub(super) fn finish(&self) -> Result<(), DecodeError> {
        let Parts { payloads, blocks, .. } = self.parts;
        if self.payloads as usize != payloads.len() {
            return Err(wrong_length(Section::Payloads, payloads.len(), PAYLOAD_WORDS));
        }
        if self.blocks as usize != blocks.len() {
            return Err(match blocks {
                Blocks::Packed(blocks) => wrong_length(Section::Blocks, blocks.len(), BLOCK_WORDS),
                Blocks::Indexed(Indexed { blocks, .. }) => {
                    wrong_length(Section::IndexedBlocks, blocks.len(), INDEXED_BLOCK_WORDS)
                }
            });
        }
        Ok(())
    }
}
