//! Mutants of the links: every face of every leaf redirected, the file sealed anew.

use leafwalk::wire::seal;
use leafwalk::{Builder, DecodeError, Octree};
use leafwalk_core::layout::RECORD_WORDS;
use leafwalk_core::layout::Section;
use leafwalk_testing::meshes;

/// Words of a record before its neighbours.
const BEFORE_NEIGHBOURS: usize = 2;

#[test]
fn one_link_off_by_a_face() {
    let mesh = meshes::bumpy_sphere(1, 71);
    let octree = Builder::new().step_cost(2.0).build(&mesh).expect("a mesh that builds");
    let spans = Section::ALL.map(|section| octree.span(section));
    let records = spans[Section::Records as usize].0 as usize;
    let mut checked = 0;
    for (number, leaf) in octree.parts().leaves() {
        for face in 0..6 {
            // The face after it, and the one across the leaf.
            for other in [(face + 1) % 6, face ^ 1] {
                let (right, wrong) = (leaf.neighbours[face], leaf.neighbours[other]);
                if right == wrong {
                    continue;
                }
                let mut words = octree.as_words().to_vec();
                words[records + number as usize * RECORD_WORDS + BEFORE_NEIGHBOURS + face] = wrong;
                seal(&mut words, &spans);
                let error = Octree::from_words(words).expect_err("a link to another leaf");
                assert_eq!(error, DecodeError::BadLink { record: number, face: face as u32 });
                checked += 1;
            }
        }
    }
    let mut same = octree.as_words().to_vec();
    seal(&mut same, &spans);
    assert!(Octree::from_words(same).is_ok(), "sealing alone must change nothing");
    println!("mutant, one link off by a face: {checked} of {checked} found");
    assert!(checked > 1000);
}
