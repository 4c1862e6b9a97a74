//! The hierarchy over the blocks.

use leafwalk::wire::Section;
use leafwalk::{Builder, DecodeError, Mesh};
use leafwalk_core::layout::{BRANCH_WIDTH, Branch, CORNER, Child, MAX_DEPTH, NONE};
use leafwalk_testing::edited::Edited;

use crate::{chains, levels, refused};

#[track_caller]
fn expect_bad(valid: &Edited, branch: usize, edit: impl Fn(&mut Branch)) {
    let error = refused(valid, |file| edit(&mut file.branches()[branch]));
    // What one branch takes too many, or leaves, another one misses; or it is left over in the end.
    let is_named = matches!(error, DecodeError::BadBranch { .. });
    let is_left_over = matches!(error, DecodeError::SectionLength { section: Section::Branches, .. });
    assert!(is_named || is_left_over, "branch {branch}: {error}");
}

#[test]
fn each_branch_is_led_to_in_turn() {
    for mut valid in [levels(), chains()] {
        let branches = valid.branches().to_vec();
        let (count, blocks) = (branches.len() as u32, valid.blocks().len() as u32);
        assert!(count > 8, "{count}");
        let mut kinds = [0; 3];
        for (number, branch) in branches.iter().enumerate() {
            for slot in 0..BRANCH_WIDTH {
                let (boxed, child) = branch.child(slot);
                let own = number as u32;
                match child {
                    Child::Branch(child) => {
                        kinds[0] += 1;
                        // To itself, back to the first, to a sibling, ahead, out of range; to a block; nowhere.
                        for other in [own, 0, child - 1, child + 1, count, Child::NUMBERS].map(Child::Branch) {
                            if other != Child::Branch(child) {
                                expect_bad(&valid, number, |branch| branch.put(slot, boxed, other));
                            }
                        }
                        expect_bad(&valid, number, |branch| branch.put(slot, boxed, Child::Block(0)));
                        expect_bad(&valid, number, |branch| branch.children[slot] = NONE);
                    }
                    Child::Block(_) => {
                        kinds[1] += 1;
                        for other in [blocks, Child::NUMBERS - 1] {
                            expect_bad(&valid, number, |branch| branch.put(slot, boxed, Child::Block(other)));
                        }
                        for other in [0, own, count] {
                            expect_bad(&valid, number, |branch| branch.put(slot, boxed, Child::Branch(other)));
                        }
                        expect_bad(&valid, number, |branch| branch.put(slot, CORNER, Child::Vacant));
                    }
                    Child::Vacant => {
                        kinds[2] += 1;
                        expect_bad(&valid, number, |branch| branch.put(slot, CORNER, Child::Block(0)));
                        expect_bad(&valid, number, |branch| branch.put(slot, CORNER, Child::Branch(own)));
                    }
                }
            }
        }
        assert!(kinds.iter().all(|count| *count > 4), "{kinds:?}");
    }
}

#[test]
fn boxes_are_those_of_the_children() {
    for mut valid in [levels(), chains()] {
        let branches = valid.branches().to_vec();
        for (number, branch) in branches.iter().enumerate() {
            for (slot, k) in (0..BRANCH_WIDTH).flat_map(|slot| (0..3).map(move |k| (slot, k))) {
                let ((lower, upper), child) = branch.child(slot);
                match child {
                    // The wrong way round.
                    Child::Block(_) => {
                        if upper[k] < u16::MAX {
                            expect_bad(&valid, number, |branch| branch.sides[k][0][slot] = upper[k] + 1);
                        }
                        if lower[k] > 0 {
                            expect_bad(&valid, number, |branch| branch.sides[k][1][slot] = lower[k] - 1);
                        }
                    }
                    _ => {
                        expect_bad(&valid, number, |branch| branch.sides[k][0][slot] ^= 1);
                        expect_bad(&valid, number, |branch| branch.sides[k][1][slot] ^= 1);
                    }
                }
            }
        }
    }
}

#[test]
fn a_branch_leads_somewhere() {
    let mut valid = levels();
    let count = valid.branches().len() as u32;
    let mut content = valid.section(Section::Branches).to_vec();
    content.extend_from_slice(bytemuck::cast_slice(&[Branch::VACANT]));
    let words = content.len() as u32;
    let error = refused(&valid, |file| file.replace(Section::Branches, &content));
    assert_eq!(error, DecodeError::SectionLength { section: Section::Branches, words });
    // The same, led to.
    let slots = |branch: &Branch| (0..BRANCH_WIDTH).find(|slot| branch.child(*slot).1 == Child::Vacant);
    let last_level = valid.branches().iter().rposition(|branch| slots(branch).is_some()).unwrap();
    let error = refused(&valid, |file| {
        file.replace(Section::Branches, &content);
        let slot = slots(&file.branches()[last_level]).unwrap();
        file.branches()[last_level].put(slot, Branch::VACANT.hull(), Child::Branch(count));
    });
    assert!(matches!(error, DecodeError::BadBranch { .. }), "{error}");
}

#[test]
fn no_branches_without_blocks_nor_blocks_without_branches() {
    let error = refused(&levels(), |file| file.replace(Section::Branches, &[]));
    assert_eq!(error, DecodeError::SectionLength { section: Section::Branches, words: 0 });
    let empty = Edited::new(&Builder::new().build(&Mesh::default()).unwrap());
    let error = refused(&empty, |file| file.replace(Section::Branches, bytemuck::cast_slice(&[Branch::VACANT])));
    assert!(matches!(error, DecodeError::BadBranch { branch: 0 }), "{error}");
}

/// One block at the end of a chain of branches.
fn chain(valid: &Edited, depth: usize) -> Edited {
    let mut file = valid.clone();
    let (boxed, block) = file.branches()[0].child(0);
    assert!(matches!(block, Child::Block(0)) && file.branches().len() == 1, "the mesh is to fill one block");
    let branch = |number: usize| {
        let mut branch = Branch::VACANT;
        branch.put(3, boxed, if number + 1 < depth { Child::Branch(number as u32 + 1) } else { block });
        branch
    };
    let branches: Vec<Branch> = (0..depth).map(branch).collect();
    file.replace(Section::Branches, bytemuck::cast_slice(&branches));
    file
}

#[test]
fn no_branch_is_too_deep() {
    let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 1.0]], vec![[0, 1, 2]]);
    let mut valid = Edited::new(&Builder::new().build(&mesh).unwrap());
    // Wherever the builder puts the only child, from here on it is the first.
    let single = valid.branches()[0];
    let slot = (0..BRANCH_WIDTH).find(|slot| single.child(*slot).1 != Child::Vacant).unwrap();
    let (boxed, child) = single.child(slot);
    valid.branches()[0] = Branch::VACANT;
    valid.branches()[0].put(0, boxed, child);
    assert!(valid.decode().is_ok());

    let octree = chain(&valid, MAX_DEPTH).decode_with(|_| ()).unwrap();
    let ray = leafwalk::Ray::new([0.3, 0.3, -1.0], [0.0, 0.0, 1.0]);
    assert!(leafwalk::CpuTracer::new(octree.view()).closest_hit(&ray).is_some());
    let error = refused(&chain(&valid, MAX_DEPTH + 1), |_| ());
    assert!(matches!(error, DecodeError::BadBranch { .. }), "{error}");
}
