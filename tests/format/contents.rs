//! Header fields, payloads, blocks, entry grid.

use leafwalk::DecodeError;
use leafwalk::wire::Header;
use leafwalk_core::contract::PADDING;
use leafwalk_core::layout::{Block, LATTICE, NONE, Payload};
use leafwalk_testing::edited::Edited;

use crate::{chains, compact, levels, no_coordinates, refused};

#[test]
fn header_fields_are_in_range() {
    let valid = levels();
    let anchor = |value: f64| {
        move |header: &mut Header| {
            header.anchor[2..4].copy_from_slice(&[value.to_bits() as u32, (value.to_bits() >> 32) as u32])
        }
    };
    let far = f64::from(f32::MAX).next_up();
    type Edit = Box<dyn Fn(&mut Header)>;
    let edits: [(&str, Edit); 25] = [
        ("scale exponent", Box::new(|header| header.scale_exponent = -150)),
        ("scale exponent", Box::new(|header| header.scale_exponent = 132)),
        ("scale exponent", Box::new(|header| header.scale_exponent = i32::MIN)),
        ("anchor", Box::new(anchor(f64::NAN))),
        ("anchor", Box::new(anchor(f64::NEG_INFINITY))),
        ("anchor", Box::new(anchor(far))),
        ("anchor", Box::new(anchor(-far))),
        ("corner", Box::new(|header| header.corner[0] = 2 * LATTICE as i32 + 1)),
        ("corner", Box::new(|header| header.corner[2] = i32::MIN)),
        ("padding", Box::new(|header| header.padding = 0.0)),
        ("padding", Box::new(|header| header.padding = PADDING.next_down())),
        ("padding", Box::new(|header| header.padding = f32::NAN)),
        ("primitives", Box::new(|header| header.primitives = NONE)),
        ("dropped", Box::new(|header| header.dropped = header.primitives + 1)),
        ("collapsed", Box::new(|header| header.collapsed = header.dropped + 1)),
        ("references", Box::new(|header| header.references += 1)),
        ("references", Box::new(|header| header.references = u32::MAX)),
        ("rounding", Box::new(|header| header.rounding = -1.0)),
        ("rounding", Box::new(|header| header.rounding = f32::NAN)),
        ("rounding", Box::new(|header| header.rounding = LATTICE as f32 + 1.0)),
        ("step cost", Box::new(|header| header.step_cost = 0.0)),
        ("step cost", Box::new(|header| header.step_cost = f32::INFINITY)),
        ("step cost", Box::new(|header| header.step_cost = f32::NAN)),
        ("maximum level", Box::new(|header| header.max_level = 17)),
        ("grid bits", Box::new(|header| header.grid_bits = 9)),
    ];
    for (field, edit) in edits {
        assert_eq!(refused(&valid, |file| edit(file.header())), DecodeError::Header { field });
    }
    // As far as they go.
    assert!(valid.decode_with(|file| file.header().scale_exponent = -149).is_ok());
    assert!(valid.decode_with(|file| file.header().scale_exponent = 131).is_ok());
    assert!(valid.decode_with(|file| anchor(far.next_down())(file.header())).is_ok());
}

#[track_caller]
fn expect_bad_payload(valid: &Edited, payload: usize, edit: impl Fn(&mut Payload)) {
    let error = refused(valid, |file| edit(&mut file.payloads()[payload]));
    // Count and chain of a first payload are also the record's; cut short, what follows is another's, or left over.
    let in_record = matches!(error, DecodeError::BadRecord { fault: leafwalk::RecordFault::Payload, .. });
    let named = matches!(error, DecodeError::BadPayload { .. });
    let is_left_over = matches!(error, DecodeError::SectionLength { .. });
    assert!(named || in_record || is_left_over, "payload {payload}: {error}");
}

#[test]
fn payloads_take_up_the_blocks_in_order() {
    for mut valid in [levels(), chains(), compact()] {
        let payloads = valid.payloads().to_vec();
        for (number, payload) in payloads.iter().enumerate() {
            for count in [0, 9, u32::MAX, payload.count ^ 1] {
                expect_bad_payload(&valid, number, |payload| payload.count = count);
            }
            for word in 0..2 {
                expect_bad_payload(&valid, number, |payload| payload.unused[word] = 1);
            }
            for first in [payload.first.wrapping_sub(1), payload.first + 1, u32::MAX, u32::MAX - 7] {
                expect_bad_payload(&valid, number, |payload| payload.first = first);
            }
            // Chained to itself, back, ahead, out of range; and cut, or made, where there is no chain.
            let at = number as u32;
            for next in [at, at.wrapping_sub(1), 0, at + 1, at + 2, payloads.len() as u32, NONE - 1, NONE] {
                if next != payload.next {
                    expect_bad_payload(&valid, number, |payload| payload.next = next);
                }
            }
        }
    }
}

#[test]
fn boxes_hold_each_other() {
    for mut valid in [levels(), chains()] {
        let payloads = valid.payloads().to_vec();
        for (number, payload) in payloads.iter().enumerate() {
            for k in 0..3 {
                // The tight box, inside out or shrunk past the boxes it holds.
                if payload.upper[k] < u16::MAX {
                    expect_bad_payload(&valid, number, |payload| payload.lower[k] = payload.upper[k] + 1);
                }
                if payload.lower[k] > 0 {
                    expect_bad_payload(&valid, number, |payload| payload.upper[k] = payload.lower[k] - 1);
                }
                for b in 0..8 {
                    let (lower, upper) = (payload.sides[k][0][b], payload.sides[k][1][b]);
                    // Those not in use are empty.
                    if b >= payload.count as usize {
                        expect_bad_payload(&valid, number, |payload| payload.sides[k][0][b] ^= 1);
                        expect_bad_payload(&valid, number, |payload| payload.sides[k][1][b] ^= 1);
                        continue;
                    }
                    if payload.upper[k] < u16::MAX {
                        expect_bad_payload(&valid, number, |payload| payload.sides[k][1][b] = payload.upper[k] + 1);
                    }
                    if payload.lower[k] > 0 {
                        expect_bad_payload(&valid, number, |payload| payload.sides[k][0][b] = payload.lower[k] - 1);
                    }
                    if upper < u16::MAX {
                        expect_bad_payload(&valid, number, |payload| payload.sides[k][0][b] = upper + 1);
                    }
                    if lower > 0 {
                        expect_bad_payload(&valid, number, |payload| payload.sides[k][1][b] = lower - 1);
                    }
                }
            }
        }
    }
}

#[test]
fn the_first_box_of_a_chain_holds_them_all() {
    let mut valid = chains();
    let payloads = valid.payloads().to_vec();
    let continues = |number: usize| payloads.iter().any(|payload| payload.next as usize == number);
    let mut tried = 0;
    for number in (0..payloads.len()).filter(|number| payloads[*number].next != NONE && !continues(*number)) {
        let (first, second) = (&payloads[number], &payloads[payloads[number].next as usize]);
        for k in (0..3).filter(|k| second.upper[*k] > 0) {
            let own = first.sides[k][1][..first.count as usize].iter().copied().max().expect("a block");
            if own < second.upper[k] {
                let error = refused(&valid, |file| file.payloads()[number].upper[k] = own);
                assert!(matches!(error, DecodeError::BadPayload { .. }), "{error}");
                tried += 1;
            }
        }
    }
    assert!(tried > 3, "the chains are to spread beyond their first payloads: {tried}");
}

#[test]
fn blocks_hold_triangles_of_the_mesh_inside_the_root() {
    let mut valid = levels();
    let blocks: Vec<Block> = valid.blocks().to_vec();
    let (primitives, root) = (valid.header().primitives, valid.header().frame().corner);
    let mut vacant = 0;
    for (number, block) in blocks.iter().enumerate() {
        for lane in 0..8 {
            let expected = DecodeError::BadBlock { block: number as u32, lane: lane as u32 };
            let (corner, axis) = ((number + lane) % 3, (number + lane) / 3 % 3);
            let set = |value: f32| refused(&valid, |file| file.blocks()[number].vertices[corner][axis][lane] = value);
            let name = |primitive: u32| refused(&valid, |file| file.blocks()[number].primitives[lane] = primitive);
            if block.primitives[lane] == NONE {
                vacant += 1;
                for value in [1.0, f32::from_bits(1), f32::NAN] {
                    assert_eq!(set(value), expected);
                }
                assert_eq!(name(0), DecodeError::Header { field: "references" });
                continue;
            }
            for value in no_coordinates(root[axis]) {
                assert_eq!(set(value), expected, "{value}");
            }
            for primitive in [primitives, NONE - 1] {
                assert_eq!(name(primitive), expected, "{primitive}");
            }
            // A vacant lane repeats the first; two equal triangles look like that, but then the header counts one more.
            let repeats = lane > 0 && block.corners(lane) == block.corners(0);
            let expected = if repeats { DecodeError::Header { field: "references" } } else { expected };
            assert_eq!(name(NONE), expected);
        }
    }
    assert!(vacant > 20, "blocks are to have vacant lanes");
    // A triangle taken out whole: the header counts it.
    let fuller = blocks.iter().position(|block| block.primitives[1] != NONE).expect("a block of two triangles");
    let error = refused(&valid, |file| {
        let block = &mut file.blocks()[fuller];
        block.primitives[1] = NONE;
        block.vertices.as_flattened_mut().iter_mut().for_each(|axis| axis[1] = axis[0]);
    });
    assert_eq!(error, DecodeError::Header { field: "references" });
}

#[test]
fn the_entry_grid_names_the_node_of_each_cell() {
    let mut valid = levels();
    let grid = valid.grid().to_vec();
    assert!(grid.len() >= 8);
    let records = valid.records().to_vec();
    for (entry, &number) in (0..).zip(&grid) {
        let expected = DecodeError::BadGrid { entry };
        let neighbour = grid.iter().copied().find(|other| *other != number).expect("another node");
        let children = records[number as usize].offset;
        let is_inner = records[number as usize].head().is_inner();
        let mut others = vec![0, 1, 7, neighbour, number ^ 7, records.len() as u32, u32::MAX];
        others.extend(is_inner.then_some(children));
        for other in others {
            assert_eq!(refused(&valid, |file| file.grid()[entry as usize] = other), expected, "{other}");
        }
    }
    let words = grid.len() as u32;
    for bits in (0..=8).filter(|bits| 1 << (3 * bits) != words) {
        let error = refused(&valid, |file| file.header().grid_bits = bits);
        assert_eq!(error, DecodeError::SectionLength { section: leafwalk_core::layout::Section::Grid, words });
    }
    // A coarser grid is as good, if it is right: the root alone.
    let mut coarser = valid.clone();
    coarser.header().grid_bits = 0;
    coarser.replace(leafwalk_core::layout::Section::Grid, &[0]);
    assert!(coarser.decode().is_ok());
}
