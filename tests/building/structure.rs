//! Cells, balance and links, recomputed from the keys alone.

use std::collections::HashMap;

use leafwalk::{Builder, Mesh, Octree};
use leafwalk_core::layout::{Key, LATTICE, LINK_COARSER, LINK_FINER, LINK_NONE, LINK_SAME};
use leafwalk_testing::meshes;

fn scenes() -> Vec<(&'static str, Mesh)> {
    let mut clump = meshes::walls(20, 61);
    let small = meshes::placed(&meshes::soup(500, 62), 1e-3, 0.3);
    let first = clump.positions.len() as u32;
    clump.positions.extend_from_slice(&small.positions);
    clump.triangles.extend(small.triangles.iter().map(|triangle| triangle.map(|i| i + first)));
    vec![
        ("nothing", Mesh::default()),
        ("soup", meshes::soup(2000, 63)),
        ("needle box", meshes::needle_box(50)),
        ("clump", clump),
        ("sphere", meshes::icosphere(4)),
    ]
}

/// The leaf that holds a lattice cube.
fn holder(leaves: &HashMap<Key, u32>, corner: [u32; 3]) -> (Key, u32) {
    (0..=16)
        .find_map(|level| {
            let size = LATTICE >> level;
            let key = Key { corner: corner.map(|c| c / size * size), level };
            leaves.get(&key).map(|number| (key, *number))
        })
        .expect("leaves cover the root")
}

fn check(name: &str, octree: &Octree<Vec<u32>>) -> [u32; 4] {
    let parts = octree.parts();
    let leaves: HashMap<Key, u32> = parts.leaves().map(|(number, _)| (parts.key(number), number)).collect();
    assert_eq!(leaves.len(), parts.leaves().count(), "{name}: two leaves with one key");
    let volume: u64 = leaves.keys().map(|key| u64::from(key.size()).pow(3)).sum();
    assert_eq!(volume, u64::from(LATTICE).pow(3), "{name}: leaves are to fill the root");

    let mut kinds = [0; 4];
    for (number, leaf) in parts.leaves() {
        let key = parts.key(number);
        assert_eq!(leaf.head().level(), key.level);
        for face in 0..6 {
            let (axis, up) = (face as usize / 2, face % 2 == 1);
            let (kind, target) = (leaf.head().link(face), leaf.neighbours[face as usize]);
            kinds[kind as usize] += 1;
            // The four lattice cubes in the corners of the face, on its far side.
            let beyond = if up { key.corner[axis] + key.size() } else { key.corner[axis].wrapping_sub(1) };
            if beyond >= LATTICE {
                assert_eq!((kind, target), (LINK_NONE, 0), "{name}: leaf {number}, face {face}");
                continue;
            }
            for quarter in 0..4 {
                let mut corner = key.corner;
                corner[axis] = beyond;
                corner[(axis + 1) % 3] += (quarter & 1) * (key.size() - 1);
                corner[(axis + 2) % 3] += (quarter >> 1) * (key.size() - 1);
                let (across, found) = holder(&leaves, corner);
                let expected = match i64::from(across.level) - i64::from(key.level) {
                    0 => (LINK_SAME, found),
                    -1 => (LINK_COARSER, found),
                    1 => (LINK_FINER, found & !7),
                    gap => panic!("{name}: leaf {number}, face {face}: {gap} levels apart"),
                };
                assert_eq!((kind, target), expected, "{name}: leaf {number}, face {face}, quarter {quarter}");
            }
        }
    }
    kinds
}

#[test]
fn leaves_fill_the_root_and_differ_by_one_level_across_a_face() {
    for (name, mesh) in scenes() {
        for builder in [Builder::new(), Builder::new().step_cost(0.5), Builder::new().step_cost(0.5).max_level(4)] {
            let kinds = check(name, &builder.build(&mesh).expect("a mesh that builds"));
            println!("{name}: links of each kind {kinds:?}");
        }
    }
    let octree = Builder::new().step_cost(0.5).build(&meshes::soup(2000, 63)).expect("a mesh that builds");
    assert!(check("soup", &octree).iter().all(|count| *count > 100), "links of every kind are to occur");
}
