//! Length, alignment, magic, version, checksum, section table.

use leafwalk::wire::{PREAMBLE_WORDS, TABLE_ROW};
use leafwalk::{DecodeError, Octree};
use leafwalk_core::layout::SECTION_ALIGN;
use leafwalk_core::layout::Section;
use leafwalk_testing::edited::reseal;
use leafwalk_testing::random::Random;

use crate::{compact, levels, nodes, refused};

#[test]
fn a_cut_file_is_truncated() {
    let words = nodes().words;
    for length in 0..words.len() {
        let needed = if length < PREAMBLE_WORDS { PREAMBLE_WORDS } else { words.len() };
        let expected = DecodeError::Truncated { words: length, needed };
        assert_eq!(Octree::from_words(&words[..length]).expect_err("words that do not decode"), expected);
    }
    let mut longer = words.clone();
    longer.push(0);
    let expected = DecodeError::Truncated { words: longer.len(), needed: words.len() };
    assert_eq!(Octree::from_words(&longer).expect_err("words that do not decode"), expected);
}

#[test]
fn a_cut_file_that_says_so_lacks_sections() {
    for mut valid in [levels(), nodes(), compact()] {
        let mut ends: Vec<usize> =
            Section::ALL.map(|section| (valid.row(section)[1] + valid.row(section)[2]) as usize).into();
        let content_end = ends.iter().copied().max().expect("a section");
        let mut random = Random::new(1, 0);
        ends.extend((0..200).map(|_| random.below(content_end)));
        for end in ends.into_iter().flat_map(|end| [end.saturating_sub(1), end, end + 1]) {
            let mut cut = valid.words[..end.min(content_end - 1)].to_vec();
            if let Some(total) = cut.get_mut(2) {
                *total = end.min(content_end - 1) as u32;
            }
            reseal(&mut cut);
            let error = Octree::from_words(&cut).expect_err("words that do not decode");
            let expected = match cut.len() {
                ..PREAMBLE_WORDS => matches!(error, DecodeError::Truncated { .. }),
                n if n < PREAMBLE_WORDS + TABLE_ROW * Section::ALL.len() => {
                    matches!(error, DecodeError::SectionTable { .. })
                }
                _ => matches!(error, DecodeError::SectionRange { .. }),
            };
            assert!(expected, "cut to {} words: {error}", cut.len());
        }
    }
}

#[test]
fn bytes_must_be_aligned_whole_words() {
    let words = levels().words;
    let mut room = vec![0u32; words.len() + 1];
    let room: &mut [u8] = bytemuck::cast_slice_mut(&mut room);
    let bytes: &[u8] = bytemuck::cast_slice(&words);
    for remainder in 1..4 {
        room[remainder..][..bytes.len()].copy_from_slice(bytes);
        let error = Octree::from_bytes(&room[remainder..][..bytes.len()]).expect_err("words that do not decode");
        assert_eq!(error, DecodeError::Misaligned { remainder });
    }
    for length in (0..bytes.len()).filter(|length| length % 4 != 0) {
        assert_eq!(
            Octree::from_bytes(&bytes[..length]).expect_err("words that do not decode"),
            DecodeError::Ragged { bytes: length }
        );
    }
}

#[test]
fn the_first_words_tell_what_the_file_is() {
    let valid = levels();
    let magic = valid.words[0];
    for found in [0, magic ^ 1, u32::MAX] {
        assert_eq!(refused(&valid, |file| file.words[0] = found), DecodeError::BadMagic { found });
    }
    assert_eq!(refused(&valid, |file| file.words[0] = magic.swap_bytes()), DecodeError::OtherEndianness);
    let swapped: Vec<u32> = valid.words.iter().map(|word| word.swap_bytes()).collect();
    assert_eq!(Octree::from_words(swapped).expect_err("words that do not decode"), DecodeError::OtherEndianness);
    for found in [valid.words[1] + 1, u32::MAX] {
        assert_eq!(refused(&valid, |file| file.words[1] = found), DecodeError::Version { found });
    }
}

#[test]
fn every_flipped_bit_is_noticed() {
    let valid = levels().words;
    let mut random = Random::new(2, 0);
    for _ in 0..2000 {
        let mut words = valid.clone();
        let at = 3 + random.below(words.len() - 3);
        words[at] ^= 1 << random.below(32);
        let error = Octree::from_words(words).expect_err("words that do not decode");
        assert!(matches!(error, DecodeError::Checksum { .. }), "word {at}: {error}");
    }
}

#[test]
fn the_section_table_must_fit() {
    let valid = levels();
    let most = ((valid.words.len() - PREAMBLE_WORDS) / TABLE_ROW) as u32;
    for sections in [most + 1, u32::MAX / 3, u32::MAX / 3 + 1, u32::MAX] {
        assert_eq!(refused(&valid, |file| file.words[4] = sections), DecodeError::SectionTable { sections });
    }
    // Without a table there are no sections.
    let error = refused(&valid, |file| file.words[4] = 0);
    assert_eq!(error, DecodeError::SectionLength { section: Section::Header, words: 0 });
}

#[test]
fn a_section_must_lie_inside_the_file_behind_the_one_before_it() {
    let valid = levels();
    let total = valid.words.len() as u32;
    let table_end = (PREAMBLE_WORDS + TABLE_ROW * Section::ALL.len()) as u32;
    for section in Section::ALL {
        let [tag, offset, length] = *valid.clone().row(section) else { unreachable!() };
        let before = offset - 16;
        let spans = [
            (u32::MAX, 2),
            (offset, u32::MAX - offset + 1),
            (offset, u32::MAX),
            (total, 1),
            (offset, total - offset + 1),
            (0, length),
            (table_end - 1, length),
            // Over the section before it, or the table.
            (before - before % 16, length),
        ];
        for (offset, length) in spans {
            let error = refused(&valid, |file| file.row(section)[1..].copy_from_slice(&[offset, length]));
            assert_eq!(error, DecodeError::SectionRange { tag, offset, length }, "{section:?}");
        }
    }
    // Two sections over each other would only read the same words twice, but no writer has a reason for it.
    let error = refused(&valid, |file| {
        let [_, offset, length] = *file.row(Section::Records) else { unreachable!() };
        file.row(Section::Keys)[1..].copy_from_slice(&[offset, length / 4]);
    });
    assert!(matches!(error, DecodeError::SectionRange { tag, .. } if tag == Section::Keys.tag()), "{error}");
}

#[test]
fn a_section_must_start_at_a_whole_cache_line() {
    let valid = levels();
    for section in Section::ALL {
        let [_, offset, length] = *valid.clone().row(section) else { unreachable!() };
        for by in (1..SECTION_ALIGN as u32).filter(|by| *by <= length) {
            let error = refused(&valid, |file| file.row(section)[1..].copy_from_slice(&[offset + by, length - by]));
            assert_eq!(error, DecodeError::SectionOffset { section, offset: offset + by });
        }
    }
}

#[test]
fn a_section_must_stand_in_the_table_once() {
    let valid = levels();
    for (section, other) in Section::ALL.into_iter().zip(&Section::ALL[1..]) {
        let error = refused(&valid, |file| file.row(*other)[0] = section.tag());
        assert_eq!(error, DecodeError::SectionTwice { section });
    }
    for section in [Section::Header, Section::Records, Section::Keys, Section::Grid] {
        let error = refused(&valid, |file| file.row(section)[0] = u32::from_le_bytes(*b"none"));
        assert_eq!(error, DecodeError::SectionLength { section, words: 0 });
    }
    for section in [Section::Payloads, Section::Blocks] {
        let error = refused(&valid, |file| file.row(section)[0] = u32::from_le_bytes(*b"none"));
        assert!(matches!(error, DecodeError::BadRecord { .. } | DecodeError::BadBvhNode { .. }), "{error}");
    }
    let error = refused(&valid, |file| file.row(Section::Bvh)[0] = u32::from_le_bytes(*b"none"));
    assert_eq!(error, DecodeError::SectionLength { section: Section::Bvh, words: 0 });
    assert!(valid.decode_with(|file| file.row(Section::Materials)[0] = u32::from_le_bytes(*b"none")).is_ok());
}

#[test]
fn a_section_must_hold_whole_items_in_the_right_number() {
    let valid = levels();
    for section in [Section::Header, Section::Records, Section::Keys, Section::Grid] {
        let length = valid.clone().row(section)[2];
        for words in [0, 1, length - 1, length / 2 + 1] {
            let error = refused(&valid, |file| file.row(section)[2] = words);
            assert_eq!(error, DecodeError::SectionLength { section, words });
        }
    }
    for section in [Section::Payloads, Section::Blocks] {
        let length = valid.clone().row(section)[2];
        let error = refused(&valid, |file| file.row(section)[2] = length - 1);
        assert_eq!(error, DecodeError::SectionLength { section, words: length - 1 });
    }
    // One item more than anything leads to.
    for section in [Section::Payloads, Section::Blocks] {
        let mut content = valid.clone().section(section).to_vec();
        let item = if section == Section::Payloads { 32 } else { 80 };
        content.extend_from_within(content.len() - item..);
        let words = content.len() as u32;
        let error = refused(&valid, |file| file.replace(section, &content));
        assert_eq!(error, DecodeError::SectionLength { section, words });
    }
    let error = refused(&valid, |file| file.replace(Section::Materials, &[0; 3]));
    assert_eq!(error, DecodeError::SectionLength { section: Section::Materials, words: 3 });
}
