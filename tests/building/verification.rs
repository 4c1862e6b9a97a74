//! `verify` finds what decoding cannot.

use leafwalk::{Builder, Mesh, Octree, VerifyError, verify, verify_against};
use leafwalk_core::layout::Section;
use leafwalk_core::layout::{Child, NONE};
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
    assert!(verified.references > verified.triangles);
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

#[test]
fn a_missing_entry_is_found() {
    let (_, octree) = scene();
    let valid = Edited::new(&octree);
    let parts = octree.parts();
    let mut tried = 0;
    for (number, leaf) in parts.leaves().filter(|(_, leaf)| leaf.head().t_count() > 0).step_by(7) {
        let payload = leaf.offset as usize;
        let used = |slot: &usize| parts.payloads[payload].child(*slot).1 != Child::Vacant;
        let slots: Vec<usize> = (0..8).filter(used).collect();
        // Twice the same, and not the other: as many as the leaf says.
        let [first, second, ..] = slots[..] else { continue };
        let (boxed, child) = parts.payloads[payload].child(first);
        let twice =
            valid.decode_with(|file| file.payloads()[payload].put(second, boxed, child)).expect("words that decode");
        let error = verify(&twice).expect_err("an octree that does not verify");
        assert!(matches!(error, VerifyError::MissingReference { leaf, .. } if leaf == number), "{error}");
        tried += 1;
    }
    assert!(tried > 20, "{tried}");
}

#[test]
fn a_triangle_in_two_lanes_is_found() {
    let (_, octree) = scene();
    let valid = Edited::new(&octree);
    for (number, block) in
        octree.blocks().iter().enumerate().filter(|(_, block)| block.primitives[1] != NONE).step_by(7)
    {
        let primitive = block.primitives[0];
        let twice = valid
            .decode_with(|file| {
                let block = &mut file.blocks()[number];
                block.primitives[1] = primitive;
                block.vertices.as_flattened_mut().iter_mut().for_each(|axis| axis[1] = axis[0]);
            })
            .expect("words that decode");
        assert_eq!(verify(&twice), Err(VerifyError::ListedTwice { primitive }));
    }
}

#[test]
fn a_box_that_is_too_small_is_found() {
    let (_, octree) = scene();
    let valid = Edited::new(&octree);
    let mut shrunk = 0;
    for (number, payload) in octree.parts().payloads.iter().enumerate().step_by(5) {
        for k in 0..3 {
            let slot = (0..8).find(|slot| payload.child(*slot).1 != Child::Vacant).expect("an entry");
            if payload.sides[k][0][slot] == payload.sides[k][1][slot] {
                continue;
            }
            let smaller =
                valid.decode_with(|file| file.payloads()[number].sides[k][1][slot] -= 1).expect("words that decode");
            let error = verify(&smaller).expect_err("an octree that does not verify");
            assert!(matches!(error, VerifyError::SmallBox { .. }), "payload {number}: {error}");
            let smaller =
                valid.decode_with(|file| file.payloads()[number].sides[k][0][slot] += 1).expect("words that decode");
            let error = verify(&smaller).expect_err("an octree that does not verify");
            assert!(matches!(error, VerifyError::SmallBox { .. }), "payload {number}: {error}");
            shrunk += 1;
        }
    }
    assert!(shrunk > 30, "{shrunk}");
}

#[test]
fn a_box_of_a_block_that_is_too_small_is_found() {
    // So few blocks that one node leads to them.
    let octree = Builder::new().build(&meshes::soup(40, 81)).expect("a mesh that builds");
    let valid = Edited::new(&octree);
    let mut tried = 0;
    // Smaller boxes decode only where those of the nodes above become smaller, too: at the first.
    for slot in 0..8 {
        let (boxed, child) = octree.parts().bvh[0].child(slot);
        let Child::Block(block) = child else { continue };
        for k in (0..3).filter(|k| boxed.lower[*k] < boxed.upper[*k]) {
            for (side, inward) in [(0, 1), (1, u16::MAX)] {
                let shrink = |file: &mut Edited| {
                    let side = &mut file.bvh()[0].sides[k][side][slot];
                    *side = side.wrapping_add(inward);
                };
                let smaller = valid.decode_with(shrink).expect("words that decode");
                let is_named =
                    |error: VerifyError| matches!(error, VerifyError::SmallBlockBox { block: b, .. } if b == block);
                assert!(is_named(verify(&smaller).expect_err("an octree that does not verify")));
                tried += 1;
            }
        }
    }
    assert!(tried > 5, "{tried}");
}

#[test]
fn a_moved_corner_is_found() {
    let (mesh, octree) = scene();
    let valid = Edited::new(&octree);
    let mut tried = 0;
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
        // A triangle stands in the file once, so only the mesh can tell.
        tried += 1;
        let error = verify_against(&moved, &mesh).expect_err("another mesh");
        assert_eq!(error, VerifyError::OtherMesh { what: "corners", primitive: Some(block.primitives[1]) });
    }
    assert!(tried > 8, "{tried}");
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
