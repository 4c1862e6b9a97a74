//! Compact octrees: their vertices, and blocks that name them.

use leafwalk::{Builder, DecodeError, Octree};
use leafwalk_core::layout::Section;
use leafwalk_core::layout::{IndexedBlock, NONE};
use leafwalk_testing::edited::Edited;
use leafwalk_testing::meshes;

use crate::{compact, levels, no_coordinates, refused};

/// The vertices that a lane names.
fn named(block: &IndexedBlock, lane: usize) -> [u32; 3] {
    block.numbers.map(|corner| block.base + u32::from(corner[lane]))
}

#[test]
fn the_words_hold_the_same_triangles_in_fewer_bytes() {
    let mesh = meshes::bumpy_sphere(4, 25);
    let packed = Builder::new().build(&mesh).expect("a mesh that builds");
    let compact = Octree::from_words(Builder::new().compact().build(&mesh).expect("a mesh that builds").into_words())
        .expect("words that decode");
    assert!(compact.is_compact() && !packed.is_compact());
    assert_eq!((compact.stats(), compact.bounds()), (packed.stats(), packed.bounds()));
    assert!(compact.blocks().iter().eq(packed.blocks().iter()), "a block differs");
    // Each vertex once: a closed mesh has half as many as triangles, and two.
    let vertices = compact.span(Section::Vertices).1 as usize / 3;
    assert_eq!(vertices, mesh.triangles.len() / 2 + 2);
    assert!(5 * compact.as_words().len() < 3 * packed.as_words().len());
}

#[test]
fn triangles_that_share_no_vertices_are_welded() {
    let sphere = meshes::icosphere(3);
    let corners: Vec<_> = (0..sphere.triangles.len()).flat_map(|i| sphere.corners(i)).collect();
    let indices = (0..sphere.triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let build = |mesh| Builder::new().compact().build(mesh).expect("a mesh that builds").into_words();
    assert!(build(&leafwalk::Mesh::new(corners, indices)) == build(&sphere), "equal corners are one vertex");
}

#[test]
fn vertices_lie_inside_the_root() {
    let mut valid = compact();
    let root = valid.header().frame().corner;
    for vertex in 0..valid.vertices().len() {
        for value in no_coordinates(root[vertex % 3]) {
            let error = refused(&valid, |file| file.vertices()[vertex][vertex % 3] = value);
            assert_eq!(error, DecodeError::BadVertex { vertex: vertex as u32 }, "{value}");
        }
    }
}

#[test]
fn blocks_name_vertices_that_there_are_in_turn() {
    let mut valid = compact();
    let blocks = valid.indexed_blocks().to_vec();
    let primitives = valid.header().primitives;
    let vertices = valid.vertices().len() as u32;
    let (mut vacant, mut first, mut again, mut out_of_turn) = (0, 0, 0, 0);
    let mut next = 0;
    for (number, block) in blocks.iter().enumerate() {
        for lane in 0..8 {
            let expected = DecodeError::BadBlock { block: number as u32, lane: lane as u32 };
            let name =
                |primitive: u32| refused(&valid, |file| file.indexed_blocks()[number].primitives[lane] = primitive);
            let shift = |corner: usize, to: u16| {
                valid.decode_with(|file| file.indexed_blocks()[number].numbers[corner][lane] = to).map(drop)
            };
            if block.primitives[lane] == NONE {
                vacant += 1;
                for corner in 0..3 {
                    assert_eq!(shift(corner, block.numbers[corner][lane] ^ 1), Err(expected));
                }
                assert_eq!(name(0), DecodeError::Header { field: "dropped" });
                continue;
            }
            for primitive in [primitives, NONE - 1] {
                assert_eq!(name(primitive), expected, "{primitive}");
            }
            let repeats = lane > 0 && named(block, lane) == named(block, 0);
            let expected_vacant = if repeats { DecodeError::Header { field: "dropped" } } else { expected };
            if named(block, lane).iter().all(|vertex| *vertex < next) {
                assert_eq!(name(NONE), expected_vacant);
            }
            for corner in 0..3 {
                let (own, vertex) = (block.numbers[corner][lane], named(block, lane)[corner]);
                // Beyond all that were named so far and the next.
                for to in [own + 1 + (next - vertex.min(next)) as u16, u16::MAX] {
                    assert_eq!(shift(corner, to), Err(expected), "{to}");
                }
                if vertex == next {
                    // The first to name a vertex: without it, the vertex is named out of turn, or never; unless the next
                    // new one is the same.
                    let error = own.checked_sub(1).and_then(|to| shift(corner, to).err());
                    let is_bad = |error: &DecodeError| match error {
                        DecodeError::BadBlock { block, .. } => *block as usize >= number,
                        DecodeError::SectionLength { section, .. } => *section == Section::Vertices,
                        _ => false,
                    };
                    assert!(error.iter().all(is_bad), "{error:?}");
                    out_of_turn += usize::from(error.is_some());
                    (next, first) = (next + 1, first + 1);
                } else {
                    again += 1;
                }
            }
        }
        for base in [vertices, u32::MAX - 7, u32::MAX] {
            let error = refused(&valid, |file| file.indexed_blocks()[number].base = base);
            assert_eq!(error, DecodeError::BadBlock { block: number as u32, lane: 0 });
        }
    }
    assert!(first == vertices && again > 20 && vacant == 7, "{first} named first, {again} again, {vacant} vacant");
    assert!(out_of_turn > 20, "{out_of_turn} out of turn");
}

#[test]
fn no_block_or_vertex_is_left_over_or_left_out() {
    let valid = compact();
    for (section, item) in [(Section::IndexedBlocks, 21), (Section::Vertices, 3)] {
        let content = valid.clone().section(section).to_vec();
        let words = content.len() as u32;
        let cut = refused(&valid, |file| file.row(section)[2] = words - 1);
        assert_eq!(cut, DecodeError::SectionLength { section, words: words - 1 });
        let longer: Vec<u32> = content.iter().chain(&content[content.len() - item..]).copied().collect();
        let error = refused(&valid, |file| file.replace(section, &longer));
        assert_eq!(error, DecodeError::SectionLength { section, words: words + item as u32 });
        let shorter = refused(&valid, |file| file.replace(section, &content[item..]));
        let is_missed = matches!(shorter, DecodeError::BadBvhNode { .. } | DecodeError::BadBlock { .. });
        assert!(is_missed, "{section:?}: {shorter}");
        let none = refused(&valid, |file| file.row(section)[0] = u32::from_le_bytes(*b"none"));
        let is_missed = matches!(none, DecodeError::BadBvhNode { .. } | DecodeError::BadBlock { .. });
        assert!(is_missed, "{section:?}: {none}");
    }
}

#[test]
fn blocks_are_held_in_one_way() {
    let (packed, compact) = (levels(), compact());
    let sections = |from: &Edited, section| from.clone().section(section).to_vec();
    let blocks = sections(&packed, Section::Blocks);
    assert_eq!(refused(&compact, |file| file.replace(Section::Blocks, &blocks)), DecodeError::BlocksTwice);
    for section in [Section::IndexedBlocks, Section::Vertices] {
        let content = sections(&compact, section);
        assert_eq!(refused(&packed, |file| file.replace(section, &content)), DecodeError::BlocksTwice);
    }
    // Neither.
    let error = refused(&packed, |file| file.replace(Section::Blocks, &[]));
    assert!(matches!(error, DecodeError::BadBvhNode { .. }), "{error}");
    // Of a mesh without triangles there are none, in either way.
    let empty = Builder::new().compact().build(&leafwalk::Mesh::default()).expect("a mesh that builds");
    let stray = refused(&Edited::new(&empty), |file| file.replace(Section::Vertices, &[0x3f00_0000; 3]));
    assert_eq!(stray, DecodeError::SectionLength { section: Section::Vertices, words: 3 });
}
