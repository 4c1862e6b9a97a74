//! The nodes form one tree, and what it lists is in its order.

use super::contents::Contents;
use crate::error::{DecodeError, RecordFault};
use crate::layout::{Key, MAX_LEVEL, Record};
use crate::parts::Parts;

/// Levels, keys and children: a depth-first traversal must meet the sibling blocks in the order of their numbers.
///
/// So each block has exactly one parent, every key is that of its place, and a stack of the tree's depth suffices.
pub(super) fn check(parts: &Parts<'_>) -> Result<(), DecodeError> {
    let bad = |record, fault| Err(DecodeError::BadRecord { record, fault });
    let vacant = Record { head: 0, offset: 0, neighbours: [0; 6] };
    if let Some(i) = (1..8).find(|&i| parts.records[i] != vacant || parts.key(i as u32) != Key::ROOT) {
        return bad(i as u32, RecordFault::StrayBits);
    }
    let mut contents = Contents::new(parts);
    let mut next_block = 8u32;
    // At each level the record to visit; numbers of siblings end in 0 to 7.
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
        contents.leaf(number, place)?;
        while level > 0 && path[level] & 7 == 7 {
            level -= 1;
        }
        if level == 0 {
            break;
        }
        path[level] += 1;
    }
    contents.finish()?;
    if next_block as usize == parts.records.len() { Ok(()) } else { bad(next_block, RecordFault::Place) }
}
