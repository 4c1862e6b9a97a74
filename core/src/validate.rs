//! Everything that tracing relies on, checked once: after this nothing can go out of bounds, and no walk can loop.

use crate::error::{DecodeError, RecordFault};
use crate::frame::Frame;
use crate::layout::{
    BLOCK_WIDTH, BLOCK_WORDS, Block, CHAINED, KEY_WORDS, Key, LATTICE, LINK_COARSER, LINK_FINER, LINK_NONE, LINK_SAME,
    MAX_LEVEL, MESH_MARGIN, NONE, PADDING, PAYLOAD_BLOCKS, PAYLOAD_WORDS, Payload, RECORD_WORDS, Record, SMALLEST,
};
use crate::octree::Parts;
use crate::wire::Section;

/// Finest entry grid that a header may ask for.
const MAX_GRID_BITS: u32 = 8;

/// Checks every offset, count, key, link, box and id.
pub(crate) fn sections(parts: &Parts<'_>, keeps_margin: bool) -> Result<(), DecodeError> {
    header(parts)?;
    lengths(parts)?;
    tree(parts)?;
    let mut listed = Listed::default();
    for (number, leaf) in parts.leaves() {
        links(parts, number, leaf)?;
        listed.add(parts, number, leaf)?;
    }
    listed.finish(parts)?;
    let margin = if keeps_margin { MESH_MARGIN } else { 0.0 };
    let mut references = 0;
    for (number, block) in (0..).zip(parts.blocks) {
        references += self::block(block, number, parts.header.primitives, margin)?;
    }
    if references != parts.header.references {
        return Err(DecodeError::Header { field: "references" });
    }
    grid(parts)
}

fn header(parts: &Parts<'_>) -> Result<(), DecodeError> {
    let header = &parts.header;
    let check = |is_right: bool, field| if is_right { Ok(()) } else { Err(DecodeError::Header { field }) };
    check(Frame::SCALE_EXPONENTS.contains(&header.scale_exponent), "scale exponent")?;
    // The root must be addressable in the caller's units: f32 positions reach 2^128.
    check(parts.frame.origin.iter().all(|c| c.abs() < (1u128 << 127) as f64 * 16.0), "origin")?;
    check(header.padding.to_bits() == PADDING.to_bits(), "padding")?;
    check(header.primitives != NONE, "primitives")?;
    check(header.dropped <= header.primitives, "dropped")?;
    check(header.collapsed <= header.dropped, "collapsed")?;
    check(header.rounding >= 0.0 && header.rounding <= 1.0, "rounding")?;
    check(header.step_cost > 0.0 && header.step_cost.is_finite(), "step cost")?;
    check(header.max_level <= MAX_LEVEL, "maximum level")?;
    check(header.grid_bits <= MAX_GRID_BITS, "grid bits")
}

fn wrong_length(section: Section, items: usize, item_words: usize) -> DecodeError {
    DecodeError::SectionLength { section, words: (items * item_words) as u32 }
}

fn lengths(parts: &Parts<'_>) -> Result<(), DecodeError> {
    let records = parts.records.len();
    if records == 0 || records % 8 != 0 {
        return Err(wrong_length(Section::Records, records, RECORD_WORDS));
    }
    if parts.key_count() != records {
        return Err(wrong_length(Section::Keys, parts.key_count(), KEY_WORDS));
    }
    if parts.grid.len() != 1 << (3 * parts.header.grid_bits) {
        return Err(wrong_length(Section::Grid, parts.grid.len(), 1));
    }
    if !parts.materials.is_empty() && parts.materials.len() != parts.header.primitives as usize {
        return Err(wrong_length(Section::Materials, parts.materials.len(), 1));
    }
    Ok(())
}

/// Levels, keys and children: a depth-first traversal must meet the sibling blocks in the order of their numbers.
///
/// So each block has exactly one parent, every key is that of its place, and a stack of the tree's depth suffices.
fn tree(parts: &Parts<'_>) -> Result<(), DecodeError> {
    let bad = |record, fault| Err(DecodeError::BadRecord { record, fault });
    let vacant = Record { head: 0, offset: 0, neighbours: [0; 6] };
    if let Some(i) = (1..8).find(|&i| parts.records[i] != vacant || parts.key(i as u32) != Key::ROOT) {
        return bad(i as u32, RecordFault::StrayBits);
    }
    let mut next_block = 8u32;
    // The record to visit at each level; numbers of siblings end in 0 to 7.
    let mut path = [0u32; MAX_LEVEL as usize + 1];
    let mut keys = [Key::ROOT; MAX_LEVEL as usize + 1];
    let mut level = 0;
    loop {
        let number = path[level];
        let head = parts.records[number as usize].head();
        if !head.is_canonical() {
            return bad(number, RecordFault::StrayBits);
        }
        let place = if level == 0 { Key::ROOT } else { keys[level - 1].child(number & 7) };
        if parts.key(number) != place || head.level() as usize != level {
            return bad(number, RecordFault::Place);
        }
        if head.is_inner() {
            let record = &parts.records[number as usize];
            let children_end = next_block.checked_add(8).filter(|end| *end as usize <= parts.records.len());
            let Some(children_end) = children_end else { return bad(number, RecordFault::Children) };
            if record.offset != next_block || record.neighbours != [0; 6] || level == MAX_LEVEL as usize {
                return bad(number, RecordFault::Children);
            }
            keys[level] = place;
            level += 1;
            path[level] = next_block;
            next_block = children_end;
            continue;
        }
        while level > 0 && path[level] & 7 == 7 {
            level -= 1;
        }
        if level == 0 {
            break;
        }
        path[level] += 1;
    }
    if next_block as usize == parts.records.len() { Ok(()) } else { bad(next_block, RecordFault::Place) }
}

/// Each face of a leaf leads to the leaf, or the four leaves, on its other side. Keys are unique, so adjacency by key is
/// adjacency, and reciprocity follows.
fn links(parts: &Parts<'_>, number: u32, leaf: &Record) -> Result<(), DecodeError> {
    let key = parts.key(number);
    for face in 0..6 {
        let target = leaf.neighbours[face as usize];
        let leaf_at = |number: u32, key: Key| {
            let record = parts.records.get(number as usize).filter(|_| number == 0 || number > 7);
            record.is_some_and(|record| !record.head().is_inner()) && parts.key(number) == key
        };
        let across = key.across(face);
        let is_right = match (leaf.head().link(face), across) {
            (LINK_NONE, None) => target == 0,
            (LINK_SAME, Some(across)) => leaf_at(target, across),
            (LINK_COARSER, Some(across)) => across.level > 0 && leaf_at(target, across.parent()),
            (LINK_FINER, Some(across)) => {
                let touches = |octant: u32| octant >> (face >> 1) & 1 != face & 1;
                let in_range = target & 7 == 0 && (8..=u32::MAX - 7).contains(&target) && across.level < MAX_LEVEL;
                in_range && (0..8).filter(|o| touches(*o)).all(|o| leaf_at(target + o, across.child(o)))
            }
            _ => false,
        };
        if !is_right {
            return Err(DecodeError::BadLink { record: number, face });
        }
    }
    Ok(())
}

/// What the leaves list takes up payloads and blocks in order, each once: so a chain ends, and all lists together are no
/// longer than the file.
#[derive(Default)]
struct Listed {
    /// Payloads that belong to the leaves so far.
    payloads: u32,
    /// Blocks that belong to them.
    blocks: u32,
}

impl Listed {
    /// Takes up the payloads of a leaf and their blocks.
    fn add(&mut self, parts: &Parts<'_>, number: u32, leaf: &Record) -> Result<(), DecodeError> {
        let bad = Err(DecodeError::BadRecord { record: number, fault: RecordFault::Payload });
        let count = leaf.head().t_count();
        if count == 0 {
            return if leaf.offset == 0 { Ok(()) } else { bad };
        }
        let first = self.payloads;
        match parts.payloads.get(first as usize).filter(|_| leaf.offset == first) {
            Some(payload) if payload.next == NONE && u32::from(payload.count) == count => {}
            Some(payload) if payload.next != NONE && count == CHAINED => {}
            _ => return bad,
        }
        loop {
            let bad = DecodeError::BadPayload { payload: self.payloads };
            let payload = parts.payloads.get(self.payloads as usize).ok_or(bad)?;
            self.payloads += 1;
            let follows = payload.next == NONE || payload.next == self.payloads;
            if !follows || payload.first_block != self.blocks || !is_consistent(payload, parts, first) {
                return Err(bad);
            }
            self.blocks += u32::from(payload.count);
            if payload.next == NONE {
                return Ok(());
            }
        }
    }

    /// Nothing may be left over.
    fn finish(&self, parts: &Parts<'_>) -> Result<(), DecodeError> {
        if self.payloads as usize != parts.payloads.len() {
            return Err(wrong_length(Section::Payloads, parts.payloads.len(), PAYLOAD_WORDS));
        }
        if self.blocks as usize != parts.blocks.len() {
            return Err(wrong_length(Section::Blocks, parts.blocks.len(), BLOCK_WORDS));
        }
        Ok(())
    }
}

/// Whether a payload's blocks exist, its boxes hold each other, and the first payload of the leaf holds its tight box.
fn is_consistent(payload: &Payload, parts: &Parts<'_>, first: u32) -> bool {
    let count = payload.count as usize;
    let blocks_end = payload.first_block as usize + count;
    let first = &parts.payloads[first as usize];
    let holds = |outer: (u8, u8), inner: (u8, u8)| outer.0 <= inner.0 && inner.0 <= inner.1 && inner.1 <= outer.1;
    (1..=PAYLOAD_BLOCKS).contains(&count)
        && payload.unused == 0
        && blocks_end <= parts.blocks.len()
        && (0..3).all(|k| {
            let tight = (payload.lower[k], payload.upper[k]);
            holds((first.lower[k], first.upper[k]), tight)
                && (0..count).all(|b| holds(tight, (payload.block_lower[k][b], payload.block_upper[k][b])))
        })
}

/// Checks a block; returns how many triangles it holds.
fn block(block: &Block, number: u32, primitives: u32, margin: f32) -> Result<u32, DecodeError> {
    let mut triangles = 0;
    let inside = margin..=1.0 - margin;
    for lane in 0..BLOCK_WIDTH {
        let corners = block.corners(lane);
        let is_right = if block.primitives[lane] == NONE {
            corners == [[0.0; 3]; 3]
        } else {
            triangles += 1;
            let in_range = |c: &f32| inside.contains(c) && (c.to_bits() == 0 || *c >= SMALLEST);
            block.primitives[lane] < primitives && corners.as_flattened().iter().all(in_range)
        };
        if !is_right {
            return Err(DecodeError::BadBlock { block: number, lane: lane as u32 });
        }
    }
    Ok(triangles)
}

/// Each entry of the grid names the deepest node, no finer than the grid, whose cell holds the entry's.
fn grid(parts: &Parts<'_>) -> Result<(), DecodeError> {
    let bits = parts.header.grid_bits;
    let edge = LATTICE >> bits;
    for (entry, &number) in (0..).zip(parts.grid) {
        let corner: [u32; 3] = core::array::from_fn(|k| (entry >> (k as u32 * bits) & ((1 << bits) - 1)) * edge);
        let record = parts.records.get(number as usize).filter(|_| number == 0 || number > 7);
        let is_right = record.is_some_and(|record| {
            let key = parts.key(number);
            let holds = (0..3).all(|k| corner[k] & !(key.size() - 1) == key.corner[k]);
            holds && (key.level == bits || (key.level < bits && !record.head().is_inner()))
        });
        if !is_right {
            return Err(DecodeError::BadGrid { entry });
        }
    }
    Ok(())
}
