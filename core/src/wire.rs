//! The file: header words, section table, checksum.
//!
//! Words 0 to 4 are magic, version, total words, CRC-32 (taken with this word zero) and the number of sections; then
//! follows a (tag, offset, words) triple a section, in the order of the file. Sections do not overlap and start at
//! multiples of [`SECTION_ALIGN`] words; those with unknown tags are skipped, wherever they start.

use bytemuck::{Pod, Zeroable};

use crate::error::DecodeError;
use crate::frame::Frame;
use crate::layout::{MAGIC, SECTION_ALIGN, Section, VERSION};

/// Words before the section table.
pub const PREAMBLE_WORDS: usize = 5;
/// Words a row of the section table.
pub const TABLE_ROW: usize = 3;
const CHECKSUM_WORD: usize = 3;

/// The header section: counts, frame, padding and settings.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Header {
    /// Triangles of the mesh, those dropped included.
    pub primitives: u32,
    /// Triangles left out because two of their vertices are equal on the lattice.
    pub dropped: u32,
    /// Dropped triangles that had three different vertices in the mesh.
    pub collapsed: u32,
    /// The entry grid has 2^this cells an axis.
    pub grid_bits: u32,
    /// See [`Frame`].
    pub scale_exponent: i32,
    /// The padding that the triangles were binned with, in lattice steps.
    pub padding: f32,
    /// The largest move of a vertex coordinate, in lattice steps: under 2^-60 for meshes of f32, which are not rounded.
    pub rounding: f32,
    /// Setting: cost of a step over the cost of a triangle.
    pub step_cost: f32,
    /// Setting: deepest level allowed.
    pub max_level: u32,
    /// The frame's anchor: three f64, low words first.
    pub anchor: [u32; 6],
    /// The root's lower corner from the anchor, in lattice steps.
    pub corner: [i32; 3],
}

impl Header {
    /// The lattice frame.
    pub fn frame(&self) -> Frame {
        let word = |k: usize| u64::from(self.anchor[2 * k]) | u64::from(self.anchor[2 * k + 1]) << 32;
        Frame {
            anchor: core::array::from_fn(|k| f64::from_bits(word(k))),
            corner: self.corner.map(|steps| steps as f32),
            scale_exponent: self.scale_exponent,
        }
    }

    /// The words that [`Header::frame`] reads its anchor from.
    pub fn anchor_words(frame: &Frame) -> [u32; 6] {
        core::array::from_fn(|i| (frame.anchor[i / 2].to_bits() >> (32 * (i % 2))) as u32)
    }
}

/// Where each known section lies: offset and length in words, (0, 0) for one that is absent.
pub type Spans = [(u32, u32); Section::ALL.len()];

/// Writes preamble and section table for sections of these lengths in words, and returns the spans and the words in all.
///
/// `None`: the file would have more than 2^32 - 1 words.
pub fn plan(lengths: [usize; Section::ALL.len()]) -> Option<(Spans, u32)> {
    let mut end = PREAMBLE_WORDS + TABLE_ROW * Section::ALL.len();
    let mut spans = Spans::default();
    for (span, length) in spans.iter_mut().zip(lengths) {
        let start = end.next_multiple_of(SECTION_ALIGN);
        *span = (u32::try_from(start).ok()?, u32::try_from(length).ok()?);
        end = start.checked_add(length)?;
    }
    Some((spans, u32::try_from(end.next_multiple_of(SECTION_ALIGN)).ok()?))
}

/// Fills in preamble, section table and checksum of words whose sections stand where [`plan`] put them.
///
/// # Panics
/// When there are fewer words than the table needs.
pub fn seal(words: &mut [u32], spans: &Spans) {
    let preamble = [MAGIC, VERSION, words.len() as u32, 0, Section::ALL.len() as u32];
    words[..PREAMBLE_WORDS].copy_from_slice(&preamble);
    let rows = words[PREAMBLE_WORDS..].chunks_exact_mut(TABLE_ROW);
    for ((row, section), span) in rows.zip(Section::ALL).zip(spans) {
        row.copy_from_slice(&[section.tag(), span.0, span.1]);
    }
    words[CHECKSUM_WORD] = checksum(words);
}

/// Checks preamble and checksum.
pub(crate) fn check(words: &[u32]) -> Result<(), DecodeError> {
    preamble(words)?;
    let (stored, computed) = (words[CHECKSUM_WORD], checksum(words));
    if stored == computed { Ok(()) } else { Err(DecodeError::Checksum { stored, computed }) }
}

/// Checks all words before the section table but the checksum; returns the number of sections.
fn preamble(words: &[u32]) -> Result<u32, DecodeError> {
    let preamble = words.get(..PREAMBLE_WORDS);
    let preamble = preamble.ok_or(DecodeError::Truncated { words: words.len(), needed: PREAMBLE_WORDS })?;
    let &[magic, version, total, _, sections] = preamble else { unreachable!("five words") };
    match magic {
        MAGIC => {}
        _ if magic == MAGIC.swap_bytes() => return Err(DecodeError::OtherEndianness),
        _ => return Err(DecodeError::BadMagic { found: magic }),
    }
    if version != VERSION {
        return Err(DecodeError::Version { found: version });
    }
    if total as usize != words.len() {
        return Err(DecodeError::Truncated { words: words.len(), needed: total as usize });
    }
    Ok(sections)
}

/// Checks preamble and section table, and returns the spans.
pub(crate) fn open(words: &[u32]) -> Result<Spans, DecodeError> {
    let sections = preamble(words)?;
    let total = words.len() as u32;
    let table_end = (sections as usize).checked_mul(TABLE_ROW).and_then(|n| n.checked_add(PREAMBLE_WORDS));
    let table = table_end.and_then(|end| words.get(PREAMBLE_WORDS..end));
    let table = table.ok_or(DecodeError::SectionTable { sections })?;
    let mut spans = Spans::default();
    let mut free_from = PREAMBLE_WORDS + table.len();
    for row in table.chunks_exact(TABLE_ROW) {
        let &[tag, offset, length] = row else { unreachable!("rows of three words") };
        let end = offset.checked_add(length).filter(|end| *end <= total && offset as usize >= free_from);
        let Some(end) = end else { return Err(DecodeError::SectionRange { tag, offset, length }) };
        free_from = end as usize;
        if let Some(i) = Section::ALL.iter().position(|section| section.tag() == tag) {
            if spans[i] != (0, 0) {
                return Err(DecodeError::SectionTwice { section: Section::ALL[i] });
            }
            if offset as usize % SECTION_ALIGN != 0 {
                return Err(DecodeError::SectionOffset { section: Section::ALL[i], offset });
            }
            spans[i] = (offset, length);
        }
    }
    Ok(spans)
}

/// The CRC-32 stored in word 3, for messages.
pub fn stored_checksum(words: &[u32]) -> Option<u32> {
    words.get(CHECKSUM_WORD).copied()
}

/// CRC-32 (IEEE 802.3) of the words as little-endian bytes, with the checksum word itself taken as zero.
pub fn checksum(words: &[u32]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    let (before, rest) = words.split_at(words.len().min(CHECKSUM_WORD));
    hash(&mut hasher, before);
    if let [_, after @ ..] = rest {
        hash(&mut hasher, &[0]);
        hash(&mut hasher, after);
    }
    hasher.finalize()
}

fn hash(hasher: &mut crc32fast::Hasher, words: &[u32]) {
    if cfg!(target_endian = "little") {
        hasher.update(bytemuck::cast_slice(words));
    } else {
        words.iter().for_each(|word| hasher.update(&word.to_le_bytes()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_the_ieee_one() {
        // The check value of CRC-32/ISO-HDLC is that of "123456789"; of "12345678" it is 0x9ae0daaf.
        let words = [u32::from_le_bytes(*b"1234"), u32::from_le_bytes(*b"5678")];
        assert_eq!(checksum(&words), 0x9ae0_daaf);
    }
}
