//! `verify` finds what decoding cannot.

use leafwalk::{Builder, Mesh, Octree, VerifyError, verify, verify_against};
use leafwalk_core::layout::Section;
use leafwalk_core::layout::{Child, NONE, Payload};
use leafwalk_cpu::testing::{Spoiled, spoil};
use leafwalk_testing::edited::Edited;
use leafwalk_testing::meshes;

fn scene() -> (Mesh, Octree<Vec<u32>>) {
    let mesh = meshes::soup(400, 81);
    let octree = Builder::new().step_cost(2.0).build(&mesh).expect("a mesh that builds");
    (mesh, octree)
}

#[test]
fn what_is_built_verifies() {
    let (mesh, octree) = scene();
    let verified = verify(&octree).expect("an octree that verifies");
    let stats = octree.stats();
    assert_eq!(verified.triangles, u64::from(stats.primitives - stats.dropped));
    assert_eq!(verified.references, u64::from(stats.references));
    assert_eq!(verify_against(&octree, &mesh), Ok(verified));
}

#[test]
fn triangles_binned_without_padding_are_found() {
    let mesh = super::listing::lattice_soup(300);
    let builder = Builder::new().step_cost(0.5).reference_budget(64.0);
    verify(&builder.build(&mesh).expect("a mesh that builds")).expect("an octree that verifies");
    let spoiled = spoil(builder, Spoiled::Padding).build(&mesh).expect("a mesh that builds");
    let error = verify(&spoiled).expect_err("an octree that does not verify");
    // Boxes of what is listed reach less far as well.
    assert!(matches!(error, VerifyError::MissingReference { .. } | VerifyError::SmallBox { .. }), "{error}");
}

/// Takes a lane out of a block, and out of the header's count.
fn remove(file: &mut Edited, block: usize, lane: usize) {
    file.header().references -= 1;
    let block = &mut file.blocks()[block];
    block.primitives[lane] = NONE;
    block.vertices.as_flattened_mut().iter_mut().for_each(|axis| axis[lane] = axis[0]);
}

#[test]
fn a_missing_reference_is_found() {
    let (_, octree) = scene();
    let valid = Edited::new(&octree);
    let parts = octree.parts();
    let owner = |block: usize| {
        let holds = |payload: &Payload| (payload.first as usize..).take(payload.count as usize).any(|b| b == block);
        parts.leaves().find(|(_, leaf)| parts.payloads_of(leaf).any(holds)).expect("every block has a leaf").0
    };
    let count =
        |primitive: u32| parts.blocks.iter().flat_map(|block| block.primitives).filter(|p| *p == primitive).count();
    let mut alone = 0;
    for (number, block) in parts.blocks.iter().enumerate().step_by(7) {
        let lane = 1 + number % 7;
        let primitive = block.primitives[lane];
        if primitive == NONE {
            continue;
        }
        let octree = valid.decode_with(|file| remove(file, number, lane)).expect("words that decode");
        let error = verify(&octree).expect_err("an octree that does not verify");
        if count(primitive) > 1 {
            assert_eq!(error, VerifyError::MissingReference { leaf: owner(number), primitive });
        } else {
            // Listed nowhere else: then it is the count that is wrong.
            alone += 1;
            assert!(matches!(error, VerifyError::TriangleCount { .. }), "{error}");
        }
    }
    println!("{alone} triangles were listed once");
}

#[test]
fn a_box_that_is_too_small_is_found() {
    let (_, octree) = scene();
    let valid = Edited::new(&octree);
    let mut shrunk = 0;
    for (number, payload) in octree.parts().payloads.iter().enumerate().step_by(5) {
        for k in 0..3 {
            if payload.sides[k][0][0] == payload.sides[k][1][0] {
                continue;
            }
            let smaller =
                valid.decode_with(|file| file.payloads()[number].sides[k][1][0] -= 1).expect("words that decode");
            let error = verify(&smaller).expect_err("an octree that does not verify");
            assert!(matches!(error, VerifyError::SmallBox { .. }), "payload {number}: {error}");
            let smaller =
                valid.decode_with(|file| file.payloads()[number].sides[k][0][0] += 1).expect("words that decode");
            let error = verify(&smaller).expect_err("an octree that does not verify");
            assert!(matches!(error, VerifyError::SmallBox { .. }), "payload {number}: {error}");
            shrunk += 1;
        }
    }
    assert!(shrunk > 30, "{shrunk}");
}

#[test]
fn a_block_that_the_bvh_does_not_lead_to_is_found() {
    let (_, octree) = scene();
    let valid = Edited::new(&octree);
    let mut tried = 0;
    for (number, node) in octree.parts().bvh.iter().enumerate() {
        for slot in 0..8 {
            let (boxed, Child::Block(block)) = node.child(slot) else { continue };
            // Another block twice: as many are led to as there are.
            let other = (block + 1) % octree.stats().blocks;
            let octree = valid
                .decode_with(|file| file.bvh()[number].put(slot, boxed, Child::Block(other)))
                .expect("words that decode");
            assert!(matches!(verify(&octree), Err(VerifyError::LostBlock { .. })), "block {block}");
            tried += 1;
        }
    }
    // Smaller boxes decode only where those of the nodes above become smaller, too: at the first.
    for slot in 0..8 {
        let (boxed, Child::Block(block)) = octree.parts().bvh[0].child(slot) else { continue };
        for k in (0..3).filter(|k| boxed.lower[*k] < boxed.upper[*k]) {
            let smaller = valid.decode_with(|file| file.bvh()[0].sides[k][1][slot] -= 1).expect("words that decode");
            assert_eq!(verify(&smaller), Err(VerifyError::LostBlock { block }));
            let smaller = valid.decode_with(|file| file.bvh()[0].sides[k][0][slot] += 1).expect("words that decode");
            assert_eq!(verify(&smaller), Err(VerifyError::LostBlock { block }));
        }
    }
    assert!(tried > 30, "{tried}");
}

#[test]
fn a_moved_corner_is_found() {
    let (mesh, octree) = scene();
    let valid = Edited::new(&octree);
    let (mut tried, mut inconsistent, mut unlike) = (0, 0, 0);
    for (number, block) in octree.parts().blocks.iter().enumerate().step_by(5) {
        // Vacant lanes repeat the first.
        if block.primitives[1] == NONE {
            continue;
        }
        let moved = valid
            .decode_with(|file| {
                let c = &mut file.blocks()[number].vertices[1][number % 3][1];
                *c = c.next_up();
            })
            .expect("words that decode");
        // Two leaves contradict each other, or else only the mesh can tell.
        tried += 1;
        inconsistent += usize::from(matches!(verify(&moved), Err(VerifyError::CornersDiffer { .. })));
        unlike += usize::from(verify_against(&moved, &mesh).is_err());
    }
    assert!(tried > 20 && unlike == tried && inconsistent > tried / 2, "{inconsistent} and {unlike} of {tried}");
}

#[test]
fn a_vertex_number_that_is_off_is_found() {
    let mesh = meshes::bumpy_sphere(3, 83);
    let octree = Builder::new().compact().step_cost(2.0).build(&mesh).expect("a mesh that builds");
    verify_against(&octree, &mesh).expect("an octree that verifies");
    let valid = Edited::new(&octree);
    let (mut tried, mut alone) = (0, 0);
    for (number, i) in (0..octree.stats().blocks as usize).map(|number| (number, number * 5 % 24)) {
        let off = valid.decode_with(|file| file.indexed_blocks()[number].numbers[i % 3][i / 3] ^= 1);
        // Only vertices that were named before can be named instead.
        let Ok(off) = off else { continue };
        assert!(verify_against(&off, &mesh).is_err(), "block {number}, number {i}");
        tried += 1;
        alone += usize::from(verify(&off).is_err());
    }
    assert!(tried > 30 && alone > tried / 2, "{alone} of {tried} without the mesh");
}

#[test]
fn swapped_vertices_are_found() {
    let mesh = meshes::bumpy_sphere(3, 84);
    let octree = Builder::new().compact().step_cost(2.0).build(&mesh).expect("a mesh that builds");
    let valid = Edited::new(&octree);
    let count = valid.clone().vertices().len();
    for vertex in (1..count).step_by(17) {
        let swapped = valid.decode_with(|file| file.vertices().swap(vertex - 1, vertex)).expect("words that decode");
        assert!(verify(&swapped).is_err(), "vertices {} and {vertex}", vertex - 1);
    }
}

#[test]
fn another_mesh_is_told_apart() {
    let (mesh, octree) = scene();
    let differs = |mesh: &Mesh| match verify_against(&octree, mesh) {
        Err(VerifyError::OtherMesh { what, primitive }) => (what, primitive),
        other => panic!("{other:?}"),
    };
    assert_eq!(differs(&meshes::icosphere(1)).0, "number of triangles");
    let mut moved = mesh.clone();
    moved.positions.iter_mut().for_each(|p| p[0] += 64.0);
    assert_eq!(differs(&moved).0, "frame");
    // One corner, by a little; of a triangle that was not dropped.
    let listed = octree.blocks().iter().nth(5).expect("six blocks").primitives[0];
    let mut other = mesh.clone();
    let vertex = other.triangles[listed as usize][1];
    other.positions[vertex as usize][1] += 1e-3;
    let (what, primitive) = differs(&other);
    assert_eq!(what, "corners");
    assert!(other.triangles[primitive.expect("a triangle") as usize].contains(&vertex));
    // Turned triangles have the same corners in another order.
    let mut turned = mesh.clone();
    turned.triangles[listed as usize].rotate_left(1);
    assert_eq!(differs(&turned), ("corners", Some(listed)));
    let mut painted = mesh.clone();
    painted.material_ids = vec![0; mesh.triangles.len()];
    assert_eq!(differs(&painted).0, "list of materials");
    let mut broken = mesh.clone();
    broken.triangles[0][0] = u32::MAX;
    assert!(matches!(verify_against(&octree, &broken), Err(VerifyError::Mesh(_))));
}

#[test]
fn materials_are_compared() {
    let mut mesh = meshes::soup(50, 82);
    mesh.material_ids = (0..mesh.triangles.len() as u32).collect();
    let octree = Builder::new().build(&mesh).expect("a mesh that builds");
    verify_against(&octree, &mesh).expect("an octree that verifies");
    let repainted =
        Edited::new(&octree).decode_with(|file| file.section(Section::Materials)[9] = 0).expect("words that decode");
    verify(&repainted).expect("an octree that verifies");
    let error = verify_against(&repainted, &mesh).expect_err("an octree that does not verify");
    assert_eq!(error, VerifyError::OtherMesh { what: "list of materials", primitive: None });
}

#[test]
fn counts_of_a_hostile_header_cost_no_memory() {
    let (_, octree) = scene();
    let hostile = Edited::new(&octree)
        .decode_with(|file| {
            file.header().primitives = NONE - 1;
            (file.header().dropped, file.header().collapsed) = (0, 0);
        })
        .expect("words that decode");
    let listed = u64::from(octree.stats().primitives - octree.stats().dropped);
    let expected = VerifyError::TriangleCount { listed, expected: u64::from(NONE - 1) };
    assert_eq!(verify(&hostile), Err(expected));
}
