//! Words to bytes and back; sections of a later writer; nothing at all.

use leafwalk::wire::{self, Header, PREAMBLE_WORDS, TABLE_ROW};
use leafwalk::{Builder, Hit, Mesh, Octree, Ray, Tracer, hit_hash};
use leafwalk_core::layout::Section;
use leafwalk_core::layout::{
    BLOCK_WORDS, BVH_NODE_WORDS, Block, BvhNode, INDEXED_BLOCK_WORDS, IndexedBlock, KEY_WORDS, Key, RECORD_WORDS,
    Record, SECTION_ALIGN,
};
use leafwalk_testing::random::Random;
use leafwalk_testing::{meshes, rays};

use crate::{compact, levels, nodes};

#[test]
fn items_have_the_sizes_of_the_format() {
    let words = size_of::<u32>();
    assert_eq!((size_of::<Record>(), RECORD_WORDS * words), (32, 32));
    assert_eq!((size_of::<BvhNode>(), BVH_NODE_WORDS * words), (128, 128));
    assert_eq!((size_of::<Block>(), BLOCK_WORDS * words), (320, 320));
    assert_eq!((size_of::<IndexedBlock>(), INDEXED_BLOCK_WORDS * words), (84, 84));
    assert_eq!((size_of_val(&Key::ROOT.to_words()), KEY_WORDS * words), (8, 8));
    assert_eq!((size_of::<Header>(), SECTION_ALIGN * words), (72, 64));
    assert_eq!([align_of::<Record>(), align_of::<BvhNode>(), align_of::<Block>(), align_of::<Header>()], [words; 4]);
}

fn traced<W: AsRef<[u32]>>(octree: &Octree<W>, mesh: &Mesh) -> u64 {
    let (centre, size) = rays::extent(mesh);
    let rays: Vec<Ray> = (0..2000).map(|i| rays::hard(mesh, centre, size, &mut Random::new(6, i))).collect();
    let mut hits = vec![Hit::MISS; rays.len()];
    octree.closest_hits(&rays, &mut hits).expect("equal lengths");
    assert!(hits.iter().filter(|hit| !hit.is_miss()).count() > 200);
    hit_hash(&hits)
}

#[test]
fn borrowed_and_owned_words_and_bytes_answer_alike() {
    let mesh = meshes::soup(300, 23);
    let octree = Builder::new().build(&mesh).expect("a mesh that builds");
    let expected = traced(&octree, &mesh);
    let words: Vec<u32> = octree.as_words().to_vec();
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    let mut aligned = vec![0u32; words.len()];
    bytemuck::cast_slice_mut(&mut aligned).copy_from_slice(&bytes);

    assert_eq!(traced(&octree.view(), &mesh), expected);
    assert_eq!(traced(&Octree::from_words(words.clone()).expect("words that decode"), &mesh), expected);
    assert_eq!(traced(&Octree::from_words(words.as_slice()).expect("words that decode"), &mesh), expected);
    assert_eq!(
        traced(&Octree::from_bytes(bytemuck::cast_slice(&aligned)).expect("words that decode"), &mesh),
        expected
    );
    assert_eq!(octree.into_words(), words);
}

#[test]
fn a_saved_octree_loads_as_it_was() {
    let mesh = meshes::soup(300, 24);
    let octree = Builder::new().build(&mesh).expect("a mesh that builds");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("soup.lwk");
    leafwalk::save_octree(&octree, &path).expect("a file that can be read");
    let loaded = leafwalk::load_octree(&path).expect("a file that can be read");
    assert_eq!(loaded.as_words(), octree.as_words());
    assert_eq!(traced(&loaded, &mesh), traced(&octree, &mesh));
    let stored: Vec<u8> = octree.as_words().iter().flat_map(|word| word.to_le_bytes()).collect();
    assert_eq!(std::fs::read(&path).expect("a file that can be read"), stored);
}

#[test]
fn unknown_sections_are_skipped() {
    for mut valid in [levels(), nodes(), compact()] {
        // The same sections behind a longer table, with one of a later writer first and one last.
        let unknown = u32::from_le_bytes(*b"late");
        let mut rows = vec![(unknown, vec![0xdead_beef; 5])];
        rows.extend(Section::ALL.map(|section| (section.tag(), valid.section(section).to_vec())));
        rows.push((unknown, vec![7; 33]));
        let mut words = vec![0; PREAMBLE_WORDS + TABLE_ROW * rows.len()];
        words[..PREAMBLE_WORDS].copy_from_slice(&valid.words[..PREAMBLE_WORDS]);
        words[4] = rows.len() as u32;
        for (row, (tag, content)) in rows.iter().enumerate() {
            let start = words.len().next_multiple_of(SECTION_ALIGN);
            let span = [*tag, start as u32, content.len() as u32];
            words[PREAMBLE_WORDS + TABLE_ROW * row..][..TABLE_ROW].copy_from_slice(&span);
            words.resize(start, 0);
            words.extend(content);
        }
        words[2] = words.len() as u32;
        words[3] = wire::checksum(&words);
        let longer = Octree::from_words(words).expect("words that decode");
        let original = valid.decode().expect("words that decode");
        assert_eq!(longer.stats(), original.stats());
        assert_eq!(longer.bounds(), original.bounds());
        for (x, y) in (0..400).map(|i| (i % 20, i / 20)) {
            let ray = Ray::new([x as f32 * 0.1 - 1.0, y as f32 * 0.1 - 1.0, -2.0], [0.01, 0.02, 1.0]);
            assert_eq!(longer.closest_hit(&ray), original.closest_hit(&ray));
        }
    }
}

#[test]
fn an_empty_mesh_is_an_octree_that_every_ray_misses() {
    let built = Builder::new().build(&Mesh::default()).expect("a mesh that builds");
    let octree = Octree::from_words(built.as_words()).expect("words that decode");
    let stats = octree.stats();
    assert_eq!((stats.primitives, stats.blocks, stats.leaves, stats.empty_leaves), (0, 0, 1, 1));
    let bounds = octree.bounds();
    assert!((0..3).all(|k| bounds.lower[k] > bounds.upper[k]), "{bounds:?}");
    for i in 0..2000 {
        let mut random = Random::new(7, i);
        let ray = Ray::new(random.vector(), random.direction());
        assert_eq!(octree.closest_hit(&ray), None);
        assert!(!octree.occluded(&ray));
    }
}
