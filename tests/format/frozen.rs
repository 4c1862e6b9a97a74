//! Files of version 2 are read, and answer as they once did; those of version 1 are refused by name.
//!
//! The files in version_2/ were written from the meshes below, by the builders that stand beside them. Version 2 is frozen:
//! they are never written again, and a release that builds other octrees still reads these.

use std::path::{Path, PathBuf};

use leafwalk::{AlignedBytes, Builder, Hit, Mesh, Octree, Ray, Tracer, hit_hash, verify_against};
use leafwalk_core::layout::Section;
use leafwalk_core::layout::{BVH_WIDTH, Child, LINK_COARSER, LINK_FINER, LINK_NONE, LINK_SAME, Record};
use leafwalk_testing::random::Random;
use leafwalk_testing::{meshes, rays};

/// A file, what it was built from, and what it answered.
struct Frozen {
    name: &'static str,
    mesh: Mesh,
    builder: Builder,
    hash: u64,
}

/// Links of every kind, in a packed octree with materials; a leaf that lists nodes of the BVH; blocks that share vertices;
/// nodes with lattices of their own.
fn all() -> [Frozen; 4] {
    let mut soup = meshes::soup(12, 21);
    soup.material_ids = (0..soup.triangles.len() as u32).map(|triangle| triangle % 3).collect();
    let small = Builder::new().step_cost(0.5);
    [
        Frozen { name: "levels", mesh: soup, builder: small.clone().max_level(3), hash: 0x62e9_f2d1_8e19_bbe3 },
        Frozen {
            name: "nodes",
            mesh: meshes::soup(70, 22),
            builder: small.clone().max_level(0),
            hash: 0x5fde_6155_9896_8bde,
        },
        Frozen {
            name: "wide",
            mesh: meshes::in_sky_box(&meshes::icosphere(2), 1e4, 0.1),
            builder: small.clone().max_level(3),
            hash: 0xdb91_1227_b6eb_1612,
        },
        Frozen {
            name: "compact",
            mesh: meshes::icosphere(1),
            builder: small.max_level(2).compact(),
            hash: 0x88c3_7f9a_40b7_ab10,
        },
    ]
}

/// A file of a version.
fn path(version: u32, name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/format/version_{version}/{name}.lwk"))
}

fn load(name: &str) -> Octree<Vec<u32>> {
    leafwalk::load_octree(path(2, name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn answers(octree: &impl Tracer<Error = leafwalk::LengthMismatch>, mesh: &Mesh) -> u64 {
    let (centre, size) = rays::extent(mesh);
    let rays: Vec<Ray> = (0..4000).map(|i| rays::hard(mesh, centre, size, &mut Random::new(8, i))).collect();
    let mut hits = vec![Hit::MISS; rays.len()];
    octree.closest_hits(&rays, &mut hits).expect("equal lengths");
    assert!(hits.iter().filter(|hit| !hit.is_miss()).count() > 400);
    hit_hash(&hits)
}

#[test]
fn a_file_in_the_program_is_read_where_it_lies() {
    static FILE: &AlignedBytes<[u8]> = &AlignedBytes { bytes: *include_bytes!("version_2/levels.lwk") };
    let octree = Octree::from_bytes(&FILE.bytes).expect("aligned bytes of a valid file");
    assert_eq!(octree.as_words().as_ptr().addr(), FILE.bytes.as_ptr().addr());
    assert_eq!(FILE.bytes.as_ptr().addr() % 64, 0);
    assert!(octree.as_words() == load("levels").as_words());
}

#[test]
fn files_of_version_2_answer_as_they_did() {
    for Frozen { name, mesh, builder, hash } in all() {
        let built = builder.build(&mesh).expect("a mesh that builds");
        let octree = load(name);
        assert_eq!(octree.as_words()[1], 2, "{name}");
        verify_against(&octree, &mesh).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(answers(&octree, &mesh), hash, "{name}: other hits than before");
        // Another octree, perhaps, but the same answers: the hash is of the numeric contract, which is frozen with it.
        assert_eq!(answers(&built, &mesh), hash, "{name}: other hits when built anew");
    }
}

#[test]
fn files_of_version_1_are_refused_by_name() {
    for name in ["levels", "chain", "compact"] {
        let error = leafwalk::load_octree(path(1, name)).expect_err("a file of version 1").to_string();
        assert!(error.contains("version 1") && error.contains("reads 2"), "{error}");
    }
}

#[test]
fn they_use_all_that_version_2_has() {
    let used = all().map(|frozen| Section::ALL.map(|section| load(frozen.name).span(section).1 > 0));
    for section in Section::ALL {
        assert!(used.iter().any(|used| used[section as usize]), "no file has section '{}'", section.name());
    }
    let [levels, nodes] = ["levels", "nodes"].map(load);
    let expected: Vec<u32> = (0..levels.stats().primitives).map(|triangle| triangle % 3).collect();
    assert_eq!(levels.parts().materials, expected);
    for kind in [LINK_NONE, LINK_SAME, LINK_COARSER, LINK_FINER] {
        let has_any = |record: &Record| (0..6).any(|face| record.head().link(face) == kind);
        let mut leaves = levels.parts().records.iter().filter(|record| !record.head().is_inner());
        assert!(leaves.any(has_any), "no link of kind {kind}");
    }
    let leads_to = |child: fn(&Child) -> bool| {
        let payloads = nodes.parts().payloads;
        payloads.iter().any(|payload| (0..BVH_WIDTH).any(|slot| child(&payload.child(slot).1)))
    };
    assert!(leads_to(|child| matches!(child, Child::Node(_))) && leads_to(|child| matches!(child, Child::Block(_))));
}
