//! Records, keys, children.

use leafwalk::{Builder, DecodeError, Mesh, RecordFault};
use leafwalk_core::layout::Section;
use leafwalk_core::layout::{MAX_LEVEL, Record, RecordHead};
use leafwalk_testing::edited::Edited;

use crate::{levels, nodes, refused};

/// Numbers of all records but the vacant ones.
fn numbers(file: &mut Edited) -> impl Iterator<Item = u32> + use<> {
    let count = file.records().len() as u32;
    (0..count).filter(|number| *number == 0 || *number > 7)
}

#[track_caller]
fn expect(valid: &Edited, record: u32, fault: RecordFault, edit: impl FnOnce(&mut Edited)) {
    assert_eq!(refused(valid, edit), DecodeError::BadRecord { record, fault });
}

#[test]
fn bits_without_a_meaning_are_zero() {
    let mut valid = levels();
    for number in numbers(&mut valid) {
        for bit in 26..32 {
            expect(&valid, number, RecordFault::StrayBits, |file| file.records()[number as usize].head |= 1 << bit);
        }
        if valid.records()[number as usize].head().is_inner() {
            for bit in (0..8).chain(13..25) {
                expect(&valid, number, RecordFault::StrayBits, |file| file.records()[number as usize].head |= 1 << bit);
            }
        }
    }
    for number in 1..8 {
        expect(&valid, number, RecordFault::StrayBits, |file| file.records()[number as usize].head = 1);
        expect(&valid, number, RecordFault::StrayBits, |file| file.records()[number as usize].offset = 8);
        expect(&valid, number, RecordFault::StrayBits, |file| file.records()[number as usize].neighbours[5] = 8);
        expect(&valid, number, RecordFault::StrayBits, |file| file.keys()[number as usize][0] = 1);
    }
}

#[test]
fn level_and_key_are_those_of_the_place() {
    let mut valid = levels();
    for number in numbers(&mut valid).step_by(3) {
        let at = number as usize;
        for level in 0..32 {
            let head = valid.records()[at].head;
            let other = head & !(31 << 8) | level << 8;
            if other != head {
                expect(&valid, number, RecordFault::Place, |file| file.records()[at].head = other);
            }
        }
        for bit in 0..64 {
            expect(&valid, number, RecordFault::Place, |file| file.keys()[at][bit / 32] ^= 1 << (bit % 32));
        }
        if number & 1 == 1 {
            expect(&valid, number - 1, RecordFault::Place, |file| file.keys().swap(at, at - 1));
        }
    }
}

#[test]
fn children_are_the_next_eight_siblings() {
    let mut valid = levels();
    let count = valid.records().len() as u32;
    let inner: Vec<u32> =
        numbers(&mut valid).filter(|number| valid.clone().records()[*number as usize].head().is_inner()).collect();
    assert!(inner.len() > 5);
    for &number in &inner {
        let at = number as usize;
        let first = valid.records()[at].offset;
        // Cycles to itself, its block and the root; its neighbours' children; out of range.
        for other in [0, number, number & !7, 8, first - 8, first + 8, first + 1, count, count - 7, u32::MAX] {
            if other != first {
                expect(&valid, number, RecordFault::Children, |file| file.records()[at].offset = other);
            }
        }
        expect(&valid, number, RecordFault::Children, |file| file.records()[at].neighbours[3] = 8);
    }
    // An inner node made a leaf: its children belong to nobody.
    for &number in &inner {
        let error = refused(&valid, |file| {
            let record = &mut file.records()[number as usize];
            (record.head, record.offset) = (RecordHead::leaf(0, record.head().level(), [0; 6]).0, 0);
        });
        // Whoever comes next misses a number; or, behind all others, what they listed is left over.
        let is_left_over = matches!(error, DecodeError::SectionLength { section: Section::Payloads, .. });
        assert!(is_left_over || matches!(error, DecodeError::BadRecord { .. }), "{error}");
    }
    let error = refused(&valid, |file| {
        let mut records = file.section(Section::Records).to_vec();
        records.extend([0; 64]);
        let mut keys = file.section(Section::Keys).to_vec();
        keys.extend([0; 16]);
        file.replace(Section::Records, &records);
        file.replace(Section::Keys, &keys);
    });
    assert_eq!(error, DecodeError::BadRecord { record: count, fault: RecordFault::Place });
}

#[test]
fn no_leaf_is_deeper_than_the_deepest_level() {
    // A wall, and a speck that splits to the last level.
    let mut positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 1.0]];
    let mut triangles = vec![[0, 1, 2]];
    for i in 0..64u32 {
        let (x, y, size) = (0.2517, 0.2549, 2f32.powi(-18));
        positions.extend([[x + i as f32 * size * 0.01, y, 0.3], [x + size, y, 0.3], [x, y + size, 0.3]]);
        triangles.push([3 * i + 3, 3 * i + 4, 3 * i + 5]);
    }
    let octree = Builder::new().step_cost(0.5).build(&Mesh::new(positions, triangles)).expect("a mesh that builds");
    let mut valid = Edited::new(&octree);
    let deepest: Vec<u32> = octree.parts().leaves().map(|(number, _)| number).collect();
    let level = |number: &u32| octree.parts().records[*number as usize].head().level();
    let deepest: Vec<u32> = deepest.into_iter().filter(|number| level(number) == MAX_LEVEL).collect();
    assert!(!deepest.is_empty(), "the mesh is to reach level {MAX_LEVEL}");
    // A header that allows less is only a setting; a level that does not exist is an error.
    let count = valid.records().len() as u32;
    for number in deepest {
        expect(&valid, number, RecordFault::Children, |file| {
            let record = &mut file.records()[number as usize];
            *record = Record { head: RecordHead::inner(MAX_LEVEL).0, offset: count - 8, neighbours: [0; 6] };
        });
    }
}

#[test]
fn a_leaf_names_its_own_payload() {
    for mut valid in [levels(), nodes()] {
        let payloads = valid.payloads().len() as u32;
        let numbers: Vec<u32> = numbers(&mut valid).collect();
        for number in numbers {
            let at = number as usize;
            let record = valid.records()[at];
            if record.head().is_inner() {
                continue;
            }
            for offset in [0, 1, record.offset + 1, payloads, u32::MAX] {
                if offset != record.offset {
                    expect(&valid, number, RecordFault::Payload, |file| file.records()[at].offset = offset);
                }
            }
            // A different number of entries.
            for count in [0, 1, 2, 7, 8, 9, 64, 254, 255] {
                if count != record.head().t_count() {
                    // An empty leaf may take what another leaf then misses, unless it lies elsewhere.
                    let error = refused(&valid, |file| file.records()[at].head = record.head & !0xff | count);
                    let is_late = match error {
                        DecodeError::BadRecord { record, fault } => record >= number && fault == RecordFault::Payload,
                        DecodeError::BadPayload { .. } => record.head().t_count() == 0,
                        _ => false,
                    };
                    assert!(is_late, "leaf {number}: {error}");
                }
            }
        }
    }
}
