//! What the nodes list takes up payloads and blocks in the order of a depth-first traversal, each once: so a chain ends,
//! and all lists together are no longer than the file.

use super::wrong_length;
use crate::error::{DecodeError, RecordFault};
use crate::layout::{ABSENT, BLOCK_WORDS, CHAINED, LatticeBox, NONE, PAYLOAD_BLOCKS, PAYLOAD_WORDS, Payload, hull};
use crate::octree::Parts;
use crate::wire::Section;

/// What has been taken up so far.
pub(super) struct Contents<'a> {
    parts: &'a Parts<'a>,
    payloads: u32,
    blocks: u32,
}

impl<'a> Contents<'a> {
    pub(super) fn new(parts: &'a Parts<'a>) -> Self {
        Self { parts, payloads: u32::from(!parts.payloads.is_empty()), blocks: 0 }
    }

    /// The root's payload, [`NONE`] where nothing is listed at all.
    pub(super) fn root(&self) -> u32 {
        if self.parts.payloads.is_empty() { NONE } else { 0 }
    }

    /// The payload of a child, [`NONE`] where it lists nothing. The parent's was checked.
    pub(super) fn child(&self, parent: u32, octant: u32) -> u32 {
        let parent = self.parts.payloads.get(parent as usize).filter(|parent| parent.children >> octant & 1 == 1);
        parent.map_or(NONE, |parent| parent.child(octant))
    }

    /// Takes up the payloads of an inner node's children, whose boxes it must give.
    pub(super) fn inner(&mut self, number: u32) -> Result<(), DecodeError> {
        let Some(payload) = self.parts.payloads.get(number as usize) else { return Ok(()) };
        let bad = DecodeError::BadPayload { payload: number };
        let is_listed = |octant: u32| payload.children >> octant & 1 == 1;
        let end = self.payloads as usize + usize::from(payload.count);
        let is_right = payload.children != 0
            && payload.children.count_ones() == u32::from(payload.count)
            && (payload.first, payload.next) == (self.payloads, NONE)
            && end <= self.parts.payloads.len()
            && (0..8).all(|octant| {
                let child = is_listed(octant).then(|| &self.parts.payloads[payload.child(octant) as usize]);
                payload.boxed(octant as usize) == child.map_or(ABSENT, Payload::hull)
            })
            && payload.hull() == hull((0..8).map(|octant| payload.boxed(octant)))
            && payload.unused == [0; 2];
        self.payloads = end as u32;
        if is_right { Ok(()) } else { Err(bad) }
    }

    /// Takes up the blocks of a leaf, and the payloads that continue its list.
    pub(super) fn leaf(&mut self, record: u32, first: u32) -> Result<(), DecodeError> {
        let bad = Err(DecodeError::BadRecord { record, fault: RecordFault::Payload });
        let leaf = &self.parts.records[record as usize];
        let count = leaf.head().t_count();
        let payload = match self.parts.payloads.get(first as usize) {
            None if (count, leaf.offset) == (0, 0) => return Ok(()),
            Some(payload) if leaf.offset == first => payload,
            _ => return bad,
        };
        if count != if payload.next == NONE { u32::from(payload.count) } else { CHAINED } {
            return bad;
        }
        let (mut number, mut payload, tight) = (first, payload, (payload.lower, payload.upper));
        loop {
            let bad = Err(DecodeError::BadPayload { payload: number });
            let follows = payload.next == NONE || payload.next == self.payloads;
            if !follows || payload.first != self.blocks || !self.is_consistent(payload, tight) {
                return bad;
            }
            self.blocks += u32::from(payload.count);
            if payload.next == NONE {
                return Ok(());
            }
            number = payload.next;
            payload = match self.parts.payloads.get(number as usize) {
                Some(payload) => payload,
                None => return bad,
            };
            self.payloads += 1;
        }
    }

    /// Whether a leaf's payload has its blocks, and the tight box of the leaf its boxes.
    fn is_consistent(&self, payload: &Payload, tight: LatticeBox) -> bool {
        let count = usize::from(payload.count);
        let is_inside = |outer: LatticeBox, inner: LatticeBox| {
            (0..3).all(|k| outer.0[k] <= inner.0[k] && inner.0[k] <= inner.1[k] && inner.1[k] <= outer.1[k])
        };
        let own = payload.hull();
        (1..=PAYLOAD_BLOCKS).contains(&count)
            && (payload.children, payload.unused) == (0, [0; 2])
            && payload.first as usize + count <= self.parts.blocks.len()
            && is_inside(tight, own)
            && (0..count).all(|block| is_inside(own, payload.boxed(block)))
            && (count..PAYLOAD_BLOCKS).all(|block| payload.boxed(block) == ABSENT)
    }

    /// Nothing may be left over.
    pub(super) fn finish(&self) -> Result<(), DecodeError> {
        let Parts { payloads, blocks, .. } = self.parts;
        if self.payloads as usize != payloads.len() {
            return Err(wrong_length(Section::Payloads, payloads.len(), PAYLOAD_WORDS));
        }
        if self.blocks as usize != blocks.len() {
            return Err(wrong_length(Section::Blocks, blocks.len(), BLOCK_WORDS));
        }
        Ok(())
    }
}
