//! Leaves take up payloads in the order of a depth-first traversal, each once; their entries lead to what there is.

use super::wrong_length;
use crate::error::{DecodeError, RecordFault};
use crate::layout::{BVH_NODE_WORDS, BVH_WIDTH, Child, Key, Lattice, LatticeBox, Section};
use crate::parts::Parts;

/// How many payloads have been taken up so far.
pub(super) struct Contents<'a> {
    parts: &'a Parts<'a>,
    payloads: u32,
}

impl<'a> Contents<'a> {
    pub(super) fn new(parts: &'a Parts<'a>) -> Self {
        Self { parts, payloads: 0 }
    }

    /// Takes up the payload of a leaf.
    pub(super) fn leaf(&mut self, record: u32, key: Key) -> Result<(), DecodeError> {
        let leaf = &self.parts.records[record as usize];
        let count = leaf.head().t_count();
        let is_right = if count == 0 {
            leaf.offset == 0
        } else {
            let payload = self.parts.payloads.get(self.payloads as usize);
            leaf.offset == self.payloads && payload.is_some_and(|payload| payload.count() == count)
        };
        if !is_right {
            return Err(DecodeError::BadRecord { record, fault: RecordFault::Payload });
        }
        if count > 0 {
            let payload = self.payloads;
            if !(0..BVH_WIDTH).all(|slot| self.is_entry(self.parts.payloads[payload as usize].child(slot), key)) {
                return Err(DecodeError::BadPayload { payload });
            }
            self.payloads += 1;
        }
        Ok(())
    }

    /// Whether an entry leads to what there is, with a box inside the cell, and inside that of the node that it leads to but
    /// for a step: what lies beside the cell, no farther than the padding, has its box on the face.
    fn is_entry(&self, (boxed, child): (LatticeBox, Child), key: Key) -> bool {
        let cell =
            LatticeBox { lower: key.corner.map(|c| c as u16), upper: key.corner.map(|c| (c + key.size() - 1) as u16) };
        let is_inside = boxed.is_whole() && cell.contains(boxed);
        match child {
            Child::Vacant => boxed == LatticeBox::VACANT,
            Child::Block(block) => is_inside && (block as usize) < self.parts.blocks.len(),
            Child::Node(node) => is_inside && self.hull(node).is_some_and(|hull| hull.grown().contains(boxed)),
        }
    }

    /// The box around a node's children, in the root's steps.
    fn hull(&self, node: u32) -> Option<LatticeBox> {
        let hull = self.parts.bvh.get(node as usize)?.hull();
        Some(match self.parts.lattices.get(node as usize) {
            Some(own) => own.seen_from(&Lattice::root(&self.parts.frame), hull),
            None => hull,
        })
    }

    /// Checks that no payload is left over.
    pub(super) fn finish(&self) -> Result<(), DecodeError> {
        if self.payloads as usize == self.parts.payloads.len() {
            return Ok(());
        }
        Err(wrong_length(Section::Payloads, self.parts.payloads.len(), BVH_NODE_WORDS))
    }
}
