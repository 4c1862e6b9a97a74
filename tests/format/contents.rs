//! Header fields, payloads, blocks, entry grid.

use leafwalk::wire::Header;
use leafwalk::{DecodeError, RecordFault};
use leafwalk_core::contract::PADDING;
use leafwalk_core::layout::{BVH_WIDTH, Block, BvhNode, Child, Key, LATTICE, LatticeBox, NONE};
use leafwalk_testing::edited::Edited;

use crate::{compact, levels, no_coordinates, nodes, refused};

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
    let edits: [(&str, Edit); 24] = [
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
        ("dropped", Box::new(|header| header.dropped += 1)),
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
fn expect_bad_payload(valid: &Edited, payload: usize, edit: impl Fn(&mut BvhNode)) {
    let error = refused(valid, |file| edit(&mut file.payloads()[payload]));
    assert_eq!(error, DecodeError::BadPayload { payload: payload as u32 });
}

#[test]
fn payloads_have_as_many_entries_as_their_leaves_say() {
    for mut valid in [levels(), nodes(), compact()] {
        let payloads = valid.payloads().to_vec();
        for (number, payload) in payloads.iter().enumerate() {
            for slot in 0..BVH_WIDTH {
                // One less, or one more that is as good as another.
                let used = (0..BVH_WIDTH).find(|slot| payload.child(*slot).1 != Child::Vacant).expect("an entry");
                let (boxed, child) = payload.child(used);
                let error = refused(&valid, |file| match payload.child(slot).1 {
                    Child::Vacant => file.payloads()[number].put(slot, boxed, child),
                    _ => file.payloads()[number].put(slot, LatticeBox::VACANT, Child::Vacant),
                });
                assert!(matches!(error, DecodeError::BadRecord { fault: RecordFault::Payload, .. }), "{error}");
            }
        }
    }
}

#[test]
fn entries_lead_to_what_there_is() {
    let mut kinds = [0; 2];
    for mut valid in [levels(), nodes(), compact()] {
        let payloads = valid.payloads().to_vec();
        let (nodes, blocks) = (valid.bvh().len() as u32, valid.decode().expect("words that decode").stats().blocks);
        for (number, payload) in payloads.iter().enumerate() {
            for slot in 0..BVH_WIDTH {
                let (boxed, child) = payload.child(slot);
                if child == Child::Vacant {
                    // Its box is the one that few rays meet.
                    expect_bad_payload(&valid, number, |payload| payload.sides[0][0][slot] ^= 1);
                    continue;
                }
                kinds[usize::from(matches!(child, Child::Block(_)))] += 1;
                for other in [blocks, Child::NUMBERS - 1] {
                    expect_bad_payload(&valid, number, |payload| payload.put(slot, boxed, Child::Block(other)));
                }
                for other in [nodes, Child::NUMBERS] {
                    expect_bad_payload(&valid, number, |payload| payload.put(slot, boxed, Child::Node(other)));
                }
            }
        }
    }
    assert!(kinds.iter().all(|count| *count > 20), "{kinds:?}");
}

#[test]
fn boxes_of_entries_lie_in_their_cells_and_nodes() {
    let mut outside_node = 0;
    for mut valid in [levels(), nodes()] {
        let (payloads, bvh) = (valid.payloads().to_vec(), valid.bvh().to_vec());
        let octree = valid.decode().expect("words that decode");
        let listing = octree.parts().leaves().filter(|(_, leaf)| leaf.head().t_count() > 0);
        let keys: Vec<(usize, Key)> =
            listing.map(|(number, leaf)| (leaf.offset as usize, octree.parts().key(number))).collect();
        for (number, key) in keys {
            let payload = &payloads[number];
            for (slot, k) in (0..BVH_WIDTH).flat_map(|slot| (0..3).map(move |k| (slot, k))) {
                let (LatticeBox { lower, upper }, child) = payload.child(slot);
                if child == Child::Vacant {
                    continue;
                }
                // The wrong way round.
                if upper[k] < u16::MAX {
                    expect_bad_payload(&valid, number, |payload| payload.sides[k][0][slot] = upper[k] + 1);
                }
                if lower[k] > 0 {
                    expect_bad_payload(&valid, number, |payload| payload.sides[k][1][slot] = lower[k] - 1);
                }
                // A step outside the cell.
                let (first, last) = (key.corner[k], key.corner[k] + key.size() - 1);
                if first > 0 {
                    expect_bad_payload(&valid, number, |payload| payload.sides[k][0][slot] = first as u16 - 1);
                }
                if last < LATTICE - 1 {
                    expect_bad_payload(&valid, number, |payload| payload.sides[k][1][slot] = last as u16 + 1);
                }
                // Two steps outside the node.
                if let Child::Node(node) = child {
                    let hull = bvh[node as usize].hull();
                    if let Some(side) = hull.lower[k].checked_sub(2) {
                        outside_node += 1;
                        expect_bad_payload(&valid, number, |payload| payload.sides[k][0][slot] = side);
                    }
                    if let Some(side) = hull.upper[k].checked_add(2) {
                        outside_node += 1;
                        expect_bad_payload(&valid, number, |payload| payload.sides[k][1][slot] = side);
                    }
                }
            }
        }
    }
    assert!(outside_node > 20, "{outside_node}");
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
                assert_eq!(name(0), DecodeError::Header { field: "dropped" });
                continue;
            }
            for value in no_coordinates(root[axis]) {
                assert_eq!(set(value), expected, "{value}");
            }
            for primitive in [primitives, NONE - 1] {
                assert_eq!(name(primitive), expected, "{primitive}");
            }
            // A vacant lane repeats the first; two equal triangles look like that, but then one is missing.
            let repeats = lane > 0 && block.corners(lane) == block.corners(0);
            let expected = if repeats { DecodeError::Header { field: "dropped" } } else { expected };
            assert_eq!(name(NONE), expected);
        }
    }
    assert_eq!(vacant, 3, "the last block is to have vacant lanes");
    // A triangle taken out whole: the header says how many there are.
    let fuller = blocks.iter().position(|block| block.primitives[1] != NONE).expect("a block of two triangles");
    let error = refused(&valid, |file| {
        let block = &mut file.blocks()[fuller];
        block.primitives[1] = NONE;
        block.vertices.as_flattened_mut().iter_mut().for_each(|axis| axis[1] = axis[0]);
    });
    assert_eq!(error, DecodeError::Header { field: "dropped" });
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
