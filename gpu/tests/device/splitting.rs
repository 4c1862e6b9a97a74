//! Octrees larger than a binding, those that end anywhere, and those that shaders do not read.

use std::sync::OnceLock;

use leafwalk::wire::{self, PREAMBLE_WORDS, TABLE_ROW};
use leafwalk::{Builder, Octree};
use leafwalk_core::layout::Section;
use leafwalk_gpu::testing::split_tracer;
use leafwalk_gpu::{Flavour, Gpu, GpuError, GpuTracer};
use leafwalk_testing::meshes;
use leafwalk_testing::tally::differing;

use crate::Test;
use crate::answers::hits;
use crate::scenes::{self, Scene};

pub(crate) const TESTS: &[Test] = &[
    ("an octree in two to six bindings", small),
    ("an octree larger than 128 MiB", large),
    ("an octree in more than six bindings is refused", refused),
    ("an octree whose last word is the entry grid's", ragged),
    ("a compact octree is refused", compact),
];

fn small(gpu: &Gpu) {
    let scene = Scene::new("soup", meshes::soup(1500, 4));
    let bytes = size_of_val(scene.octree.as_words()) as u64;
    let rays = scenes::hard(&scene, 5000, 1);
    let expected = hits(&scene.octree, &rays);
    // Sections then begin and end anywhere in a binding.
    for limit in [bytes.next_power_of_two() / 2, bytes.next_power_of_two() / 4] {
        assert!(limit < bytes);
        let tracer = split_tracer(gpu, &scene.octree, limit).expect("six are enough");
        assert_eq!(differing(&hits(&tracer, &rays), &expected), 0, "{bytes} bytes in bindings of {limit}");
    }
}

fn large(gpu: &Gpu) {
    static LARGE: OnceLock<Scene> = OnceLock::new();
    // Small leaves: large, and built in seconds.
    let builder = Builder::new().step_cost(1.0).reference_budget(40.0);
    let scene = LARGE.get_or_init(|| Scene::built_by(&builder, "large", meshes::shards(600_000, 0.01..0.05, 10.0, 7)));
    let bytes = size_of_val(scene.octree.as_words());
    assert!(bytes > 128 << 20, "only {bytes} bytes");
    let tracer = GpuTracer::on(gpu, &scene.octree, Flavour::Exact).expect("six are enough");
    let mut rays = scenes::hard(scene, 3000, 1);
    rays.extend(scenes::chords(scene, 3000, 2));
    assert_eq!(differing(&hits(&tracer, &rays), &hits(&scene.octree, &rays)), 0);
}

fn refused(gpu: &Gpu) {
    let scene = Scene::new("soup", meshes::soup(1500, 4));
    let bytes = size_of_val(scene.octree.as_words()) as u64;
    let error = split_tracer(gpu, &scene.octree, 1024).map(|_| ());
    assert_eq!(error, Err(GpuError::OctreeTooLarge { bytes, most: 6 * 1024 }));
}

fn ragged(gpu: &Gpu) {
    let scene = Scene::built_by(&Builder::new().max_level(0), "one cell", meshes::soup(40, 5));
    let (start, count) = scene.octree.span(Section::Grid);
    let end = start + count;
    assert!(!end.is_multiple_of(4), "{end} words are whole quads");
    // Nothing stands behind the grid: no padding, and the materials are another writer's empty section.
    let mut words = scene.octree.as_words()[..end as usize].to_vec();
    let row = PREAMBLE_WORDS + TABLE_ROW * Section::Materials as usize;
    words[row..][..TABLE_ROW].copy_from_slice(&[u32::from_le_bytes(*b"none"), end, 0]);
    words[2] = end;
    words[3] = wire::checksum(&words);
    let cut = Octree::from_words(words).expect("a valid file");
    let rays = scenes::hard(&scene, 2000, 1);
    let tracer = GpuTracer::on(gpu, &cut, Flavour::Exact).expect("room");
    assert_eq!(differing(&hits(&tracer, &rays), &hits(&scene.octree, &rays)), 0);
}

fn compact(gpu: &Gpu) {
    let scene = Scene::built_by(&Builder::new().compact(), "compact soup", meshes::soup(300, 1));
    assert_eq!(GpuTracer::on(gpu, &scene.octree, Flavour::Exact).map(|_| ()), Err(GpuError::CompactOctree));
}
