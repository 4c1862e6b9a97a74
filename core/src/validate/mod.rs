//! Everything that tracing relies on, checked once: after this nothing can go out of bounds, and no walk can loop.

mod bvh;
mod contents;
mod tree;
mod triangles;

use crate::contract::{MESH_MARGIN, PADDING};
use crate::error::DecodeError;
use crate::frame::Frame;
use crate::layout::{
    KEY_WORDS, Key, LATTICE, LATTICE_WORDS, LINK_COARSER, LINK_FINER, LINK_NONE, LINK_SAME, MAX_LEVEL, NONE,
    RECORD_WORDS, Record, Section,
};
use crate::parts::Parts;

/// Finest entry grid that a header may ask for.
const MAX_GRID_BITS: u32 = 8;

/// Checks every offset, count, key, link, box and id.
pub(crate) fn sections(parts: &Parts<'_>, keeps_margin: bool) -> Result<(), DecodeError> {
    header(parts)?;
    lengths(parts)?;
    bvh::check(parts)?;
    tree::check(parts)?;
    for (number, leaf) in parts.leaves() {
        links(parts, number, leaf)?;
    }
    triangles::check(parts, if keeps_margin { MESH_MARGIN } else { 0.0 })?;
    grid(parts)
}

fn header(parts: &Parts<'_>) -> Result<(), DecodeError> {
    let header = &parts.header;
    let check = |is_right: bool, field| if is_right { Ok(()) } else { Err(DecodeError::Header { field }) };
    check(Frame::SCALE_EXPONENTS.contains(&header.scale_exponent), "scale exponent")?;
    // Meshes have f32 positions, or f64 ones as large at most.
    check(parts.frame.anchor.iter().all(|c| c.abs() <= f64::from(f32::MAX)), "anchor")?;
    check(header.corner.iter().all(|steps| steps.unsigned_abs() <= 2 * LATTICE), "corner")?;
    check(header.padding.to_bits() == PADDING.to_bits(), "padding")?;
    check(header.primitives != NONE, "primitives")?;
    check(header.dropped <= header.primitives, "dropped")?;
    check(header.collapsed <= header.dropped, "collapsed")?;
    check(header.rounding >= 0.0 && header.rounding <= LATTICE as f32, "rounding")?;
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
    if !parts.lattices.is_empty() && parts.lattices.len() != parts.bvh.len() {
        return Err(wrong_length(Section::Lattices, parts.lattices.len(), LATTICE_WORDS));
    }
    if !parts.materials.is_empty() && parts.materials.len() != parts.header.primitives as usize {
        return Err(wrong_length(Section::Materials, parts.materials.len(), 1));
    }
    Ok(())
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

/// Each entry of the grid names the deepest node, no finer than the grid, whose cell holds the entry's.
fn grid(parts: &Parts<'_>) -> Result<(), DecodeError> {
    let bits = parts.header.grid_bits;
    for (entry, &number) in (0..).zip(parts.grid) {
        let Key { corner, .. } = Key::of_grid(entry, bits);
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
