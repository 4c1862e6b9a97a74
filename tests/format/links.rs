//! Each face of each leaf, led astray.

use leafwalk::DecodeError;
use leafwalk_core::layout::{LINK_COARSER, LINK_FINER, LINK_NONE, LINK_SAME, LINK_SHIFT};
use leafwalk_testing::edited::Edited;
use leafwalk_testing::random::Random;

use crate::{levels, refused};

#[track_caller]
fn expect(valid: &Edited, record: u32, face: u32, edit: impl FnOnce(&mut Edited)) {
    assert_eq!(refused(valid, edit), DecodeError::BadLink { record, face });
}

#[test]
fn every_face_leads_to_what_lies_across() {
    let mut valid = levels();
    let records = valid.records().to_vec();
    let is_leaf = |number: &usize| (*number == 0 || *number > 7) && !records[*number].head().is_inner();
    let leaves: Vec<usize> = (0..records.len()).filter(is_leaf).collect();
    let mut kinds = [0; 4];
    for (&number, face) in leaves.iter().flat_map(|number| (0..6).map(move |face| (number, face))) {
        let record = &records[number];
        let (kind, target) = (record.head().link(face), record.neighbours[face as usize]);
        kinds[kind as usize] += 1;
        let mut random = Random::new(5, (6 * number + face as usize) as u64);
        let any_leaf = leaves[random.below(leaves.len())] as u32;
        let opposite = record.neighbours[face as usize ^ 1];
        let others =
            [any_leaf, opposite, number as u32, 0, target ^ 1, target ^ 7, target + 8, records.len() as u32, u32::MAX];
        for other in others.into_iter().filter(|other| *other != target) {
            expect(&valid, number as u32, face, |file| file.records()[number].neighbours[face as usize] = other);
        }
        for other in [LINK_NONE, LINK_SAME, LINK_COARSER, LINK_FINER].into_iter().filter(|other| *other != kind) {
            expect(&valid, number as u32, face, |file| {
                file.records()[number].head ^= (kind ^ other) << (LINK_SHIFT + 2 * face);
            });
        }
    }
    println!("{} leaves, links of each kind: {kinds:?}", leaves.len());
    assert!(kinds.iter().all(|count| *count > 20), "the octree is to have links of every kind: {kinds:?}");
}

#[test]
fn two_links_cannot_be_exchanged() {
    let mut valid = levels();
    let records = valid.records().to_vec();
    for (number, record) in (0..).zip(&records).filter(|(number, r)| *number > 7 && !r.head().is_inner()) {
        for (a, b) in (0..6).flat_map(|a| (a + 1..6).map(move |b| (a, b))) {
            let kinds = [a, b].map(|face| record.head().link(face));
            if kinds == [LINK_NONE; 2] || record.neighbours[a as usize] == record.neighbours[b as usize] {
                continue;
            }
            expect(&valid, number, a, |file| {
                let record = &mut file.records()[number as usize];
                record.neighbours.swap(a as usize, b as usize);
                record.head ^= (kinds[0] ^ kinds[1]) << (LINK_SHIFT + 2 * a);
                record.head ^= (kinds[0] ^ kinds[1]) << (LINK_SHIFT + 2 * b);
            });
        }
    }
}
