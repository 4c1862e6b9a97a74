//! The hierarchy over all triangles.

use leafwalk::{Builder, DecodeError, Mesh};
use leafwalk_core::layout::Section;
use leafwalk_core::layout::{BVH_WIDTH, BvhNode, Child, LatticeBox, MAX_DEPTH, NONE};
use leafwalk_testing::edited::Edited;

use crate::{levels, nodes, refused};

#[track_caller]
fn expect_bad(valid: &Edited, node: usize, edit: impl Fn(&mut BvhNode)) {
    let error = refused(valid, |file| edit(&mut file.bvh()[node]));
    // What one node takes too many, or leaves, another one misses; or it is left over in the end.
    let is_named = matches!(error, DecodeError::BadBvhNode { .. });
    let is_left_over = matches!(error, DecodeError::SectionLength { section: Section::Bvh, .. });
    assert!(is_named || is_left_over, "node {node}: {error}");
}

#[test]
fn each_node_is_led_to_in_turn() {
    for mut valid in [levels(), nodes()] {
        let nodes = valid.bvh().to_vec();
        let (count, blocks) = (nodes.len() as u32, valid.blocks().len() as u32);
        assert!(count > 5, "{count}");
        let mut kinds = [0; 3];
        for (number, node) in nodes.iter().enumerate() {
            for slot in 0..BVH_WIDTH {
                let (boxed, child) = node.child(slot);
                let own = number as u32;
                match child {
                    Child::Node(child) => {
                        kinds[0] += 1;
                        // To itself, back to the first, to a sibling, ahead, out of range; to a block; nowhere.
                        for other in [own, 0, child - 1, child + 1, count, Child::NUMBERS].map(Child::Node) {
                            if other != Child::Node(child) {
                                expect_bad(&valid, number, |node| node.put(slot, boxed, other));
                            }
                        }
                        expect_bad(&valid, number, |node| node.put(slot, boxed, Child::Block(0)));
                        expect_bad(&valid, number, |node| node.children[slot] = NONE);
                    }
                    Child::Block(block) => {
                        kinds[1] += 1;
                        for other in [blocks, Child::NUMBERS - 1, block + 1, block.wrapping_sub(1) & Child::NUMBERS] {
                            expect_bad(&valid, number, |node| node.put(slot, boxed, Child::Block(other)));
                        }
                        for other in [0, own, count] {
                            expect_bad(&valid, number, |node| node.put(slot, boxed, Child::Node(other)));
                        }
                        expect_bad(&valid, number, |node| node.put(slot, LatticeBox::VACANT, Child::Vacant));
                    }
                    Child::Vacant => {
                        kinds[2] += 1;
                        expect_bad(&valid, number, |node| node.put(slot, LatticeBox::VACANT, Child::Block(0)));
                        expect_bad(&valid, number, |node| node.put(slot, LatticeBox::VACANT, Child::Node(own)));
                    }
                }
            }
        }
        assert!(kinds.iter().all(|count| *count > 4), "{kinds:?}");
    }
}

#[test]
fn boxes_are_those_of_the_children() {
    for mut valid in [levels(), nodes()] {
        let nodes = valid.bvh().to_vec();
        for (number, node) in nodes.iter().enumerate() {
            for (slot, k) in (0..BVH_WIDTH).flat_map(|slot| (0..3).map(move |k| (slot, k))) {
                let (LatticeBox { lower, upper }, child) = node.child(slot);
                match child {
                    // The wrong way round.
                    Child::Block(_) => {
                        if upper[k] < u16::MAX {
                            expect_bad(&valid, number, |node| node.sides[k][0][slot] = upper[k] + 1);
                        }
                        if lower[k] > 0 {
                            expect_bad(&valid, number, |node| node.sides[k][1][slot] = lower[k] - 1);
                        }
                    }
                    _ => {
                        expect_bad(&valid, number, |node| node.sides[k][0][slot] ^= 1);
                        expect_bad(&valid, number, |node| node.sides[k][1][slot] ^= 1);
                    }
                }
            }
        }
    }
}

#[test]
fn a_node_leads_somewhere() {
    let mut valid = levels();
    let count = valid.bvh().len() as u32;
    let mut content = valid.section(Section::Bvh).to_vec();
    content.extend_from_slice(bytemuck::cast_slice(&[BvhNode::VACANT]));
    let words = content.len() as u32;
    let error = refused(&valid, |file| file.replace(Section::Bvh, &content));
    assert_eq!(error, DecodeError::SectionLength { section: Section::Bvh, words });
    // The same, led to.
    let slots = |node: &BvhNode| (0..BVH_WIDTH).find(|slot| node.child(*slot).1 == Child::Vacant);
    let last_level = valid.bvh().iter().rposition(|node| slots(node).is_some()).expect("such a node");
    let error = refused(&valid, |file| {
        file.replace(Section::Bvh, &content);
        let slot = slots(&file.bvh()[last_level]).expect("as found above");
        file.bvh()[last_level].put(slot, BvhNode::VACANT.hull(), Child::Node(count));
    });
    assert!(matches!(error, DecodeError::BadBvhNode { .. }), "{error}");
}

#[test]
fn no_bvh_without_blocks_nor_blocks_without_a_bvh() {
    let error = refused(&levels(), |file| file.replace(Section::Bvh, &[]));
    assert_eq!(error, DecodeError::SectionLength { section: Section::Bvh, words: 0 });
    let empty = Edited::new(&Builder::new().build(&Mesh::default()).expect("a mesh that builds"));
    let error = refused(&empty, |file| file.replace(Section::Bvh, bytemuck::cast_slice(&[BvhNode::VACANT])));
    assert!(matches!(error, DecodeError::BadBvhNode { node: 0 }), "{error}");
}

/// One block at the end of a chain of nodes.
fn chain(valid: &Edited, depth: usize) -> Edited {
    let mut file = valid.clone();
    let (boxed, block) = file.bvh()[0].child(0);
    assert!(matches!(block, Child::Block(0)) && file.bvh().len() == 1, "the mesh is to fill one block");
    let node = |number: usize| {
        let mut node = BvhNode::VACANT;
        node.put(3, boxed, if number + 1 < depth { Child::Node(number as u32 + 1) } else { block });
        node
    };
    let nodes: Vec<BvhNode> = (0..depth).map(node).collect();
    file.replace(Section::Bvh, bytemuck::cast_slice(&nodes));
    file
}

#[test]
fn no_node_is_too_deep() {
    let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 1.0]], vec![[0, 1, 2]]);
    let mut valid = Edited::new(&Builder::new().build(&mesh).expect("a mesh that builds"));
    // Wherever the builder puts the only child, from here on it is the first.
    let single = valid.bvh()[0];
    let slot = (0..BVH_WIDTH).find(|slot| single.child(*slot).1 != Child::Vacant).expect("a child");
    let (boxed, child) = single.child(slot);
    valid.bvh()[0] = BvhNode::VACANT;
    valid.bvh()[0].put(0, boxed, child);
    assert!(valid.decode().is_ok());

    let octree = chain(&valid, MAX_DEPTH).decode_with(|_| ()).expect("words that decode");
    let ray = leafwalk::Ray::new([0.3, 0.3, -1.0], [0.0, 0.0, 1.0]);
    assert!(leafwalk::CpuTracer::new(octree.view()).closest_hit(&ray).is_some());
    let error = refused(&chain(&valid, MAX_DEPTH + 1), |_| ());
    assert!(matches!(error, DecodeError::BadBvhNode { .. }), "{error}");
}
