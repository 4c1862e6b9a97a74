//! The lattices of wide octrees.

use leafwalk::DecodeError;
use leafwalk_core::layout::{BVH_WIDTH, Child, FINEST_STEP, LATTICE, LATTICE_WORDS, Lattice, Section};

use crate::{levels, refused, wide};

fn expect_bad(node: usize, edit: impl Fn(&mut Lattice)) {
    let error = refused(&wide(), |file| edit(&mut file.lattices()[node]));
    assert_eq!(error, DecodeError::BadLattice { node: node as u32 });
}

#[test]
fn there_are_as_many_as_nodes_or_none() {
    let mut valid = wide();
    assert!(valid.decode().is_ok());
    let content = valid.section(Section::Lattices).to_vec();
    assert_eq!(content.len(), LATTICE_WORDS * valid.bvh().len());
    for words in [content.len() - LATTICE_WORDS, content.len() - 1, 1] {
        let error = refused(&valid, |file| file.replace(Section::Lattices, &content[..words]));
        assert_eq!(error, DecodeError::SectionLength { section: Section::Lattices, words: words as u32 });
    }
    // Boxes that count steps of their own are not those of the root's.
    let error = refused(&valid, |file| file.replace(Section::Lattices, &[]));
    assert!(matches!(error, DecodeError::BadBvhNode { .. }), "{error}");
    let mut ordinary = levels();
    let nodes = ordinary.bvh().len() as u32;
    let lattices = vec![0; LATTICE_WORDS * (nodes as usize + 1)];
    let error = refused(&ordinary, |file| file.replace(Section::Lattices, &lattices));
    assert_eq!(error, DecodeError::SectionLength { section: Section::Lattices, words: lattices.len() as u32 });
}

#[test]
fn steps_are_powers_of_two_in_range() {
    for node in 1..wide().bvh().len() {
        for step in [0.0, -1.0, 2.0, 0.75, FINEST_STEP / 2.0, f32::NAN, f32::INFINITY, f32::from_bits(1)] {
            expect_bad(node, |lattice| lattice.step = step);
        }
    }
}

#[test]
fn corners_count_steps_near_the_root() {
    for node in 1..wide().bvh().len() {
        for k in 0..3 {
            let far = (4 * LATTICE) as f32;
            for corner in [f32::NAN, f32::INFINITY, far, -far, FINEST_STEP / 4.0] {
                expect_bad(node, |lattice| lattice.corner[k] = corner);
            }
            expect_bad(node, |lattice| lattice.corner[k] = lattice.step * 0.5);
        }
    }
}

#[test]
fn the_roots_lattice_is_the_roots() {
    expect_bad(0, |lattice| lattice.step = 0.5);
    for k in 0..3 {
        expect_bad(0, |lattice| lattice.corner[k] += 1.0);
    }
}

#[test]
fn boxes_hold_those_of_the_children() {
    let mut valid = wide();
    let nodes = valid.bvh().to_vec();
    let mut count = 0;
    for (number, node) in nodes.iter().enumerate() {
        for slot in 0..BVH_WIDTH {
            let (boxed, Child::Node(child)) = node.child(slot) else { continue };
            count += 1;
            for k in 0..3 {
                assert!(boxed.lower[k] < boxed.upper[k], "boxes more than a step wide");
                for (side, moved) in [(0, boxed.lower[k] + 1), (1, boxed.upper[k] - 1)] {
                    let error = refused(&valid, |file| file.bvh()[number].sides[k][side][slot] = moved);
                    assert_eq!(error, DecodeError::BadBvhNode { node: number as u32 });
                }
                // A lattice that lies elsewhere takes the children along.
                let error = refused(&valid, |file| {
                    let lattice = &mut file.lattices()[child as usize];
                    lattice.corner[k] += lattice.step * LATTICE as f32;
                });
                assert!(matches!(error, DecodeError::BadBvhNode { .. } | DecodeError::BadLattice { .. }), "{error}");
            }
        }
    }
    assert!(count > 1);
}

#[test]
fn entries_lie_in_the_boxes_of_their_nodes() {
    let valid = wide();
    let payloads = valid.clone().payloads().to_vec();
    let leads_to_node = |payload: usize, slot| matches!(payloads[payload].child(slot).1, Child::Node(_));
    let entries = (0..payloads.len()).flat_map(|payload| (0..BVH_WIDTH).map(move |slot| (payload, slot)));
    let (payload, slot) = entries.into_iter().find(|&(payload, slot)| leads_to_node(payload, slot)).expect("an entry");
    let error = refused(&valid, |file| {
        // All of the root.
        for sides in &mut file.payloads()[payload].sides {
            (sides[0][slot], sides[1][slot]) = (0, u16::MAX);
        }
    });
    assert_eq!(error, DecodeError::BadPayload { payload: payload as u32 });
}
