//! What a caller waits for: a file is decoded, a mesh built, a batch traced.

use core::hint::black_box;

use criterion::Criterion;
use leafwalk::{Builder, CpuTracer, Hit, Octree};
use leafwalk_core::step::{Pluecker, Slab};
use leafwalk_core::testing::Standard;
use leafwalk_testing::meshes;
use leafwalk_testing::tracers::{Any, OneByOne, Stepping};
use leafwalk_testing::workloads::Workload;

use crate::{Scene, group};

/// Triangles of the mesh that is built.
const BUILT: u32 = 10_000;
/// Few, since each of them takes some milliseconds.
const SAMPLES: usize = 20;

pub(crate) fn measure(criterion: &mut Criterion, scene: &Scene) {
    decode(criterion, scene);
    build(criterion);
    batches(criterion, scene);
}

/// By the triangle.
fn decode(criterion: &mut Criterion, scene: &Scene) {
    let words = scene.octree.as_words();
    let mut group = group(criterion, "decode", scene.octree.parts().header.primitives as usize);
    group.sample_size(SAMPLES);
    group.bench_function("checksum and contents", |bencher| {
        bencher.iter(|| Octree::from_words(black_box(words)).expect("words of an octree"));
    });
    group.bench_function("contents", |bencher| {
        bencher.iter(|| Octree::from_sealed(black_box(words)).expect("words of an octree"));
    });
}

/// By the triangle.
fn build(criterion: &mut Criterion) {
    let mesh = meshes::shards(BUILT, 0.01..0.1, 4.0, 1);
    let mut group = group(criterion, "build", mesh.triangles.len());
    group.sample_size(SAMPLES);
    for (name, builder) in [("packed", Builder::new()), ("compact", Builder::new().compact())] {
        group.bench_function(name, |bencher| {
            bencher.iter_with_large_drop(|| builder.build(black_box(&mesh)).expect("a mesh that builds"));
        });
    }
}

/// By the ray: as a batch, one ray a call, and by walks with both kinds of step.
fn batches(criterion: &mut Criterion, scene: &Scene) {
    let batches = CpuTracer::new(scene.octree.view());
    let calls = OneByOne(&batches);
    let parts = scene.octree.parts();
    let (slabs, signs) = (Stepping::<Slab, Standard>::new(&parts), Stepping::<Pluecker, Standard>::new(&parts));
    let tracers: [(&str, Any<'_>); 4] =
        [("batch", &batches), ("one ray a call", &calls), ("walk by slabs", &slabs), ("walk by Plücker signs", &signs)];
    for Workload { name, rays, is_occlusion } in &scene.workloads {
        let mut group = group(criterion, &format!("rays {name}"), rays.len());
        group.sample_size(SAMPLES);
        let (mut hits, mut occluded) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
        for (way, tracer) in tracers {
            group.bench_function(way, |bencher| match is_occlusion {
                true => bencher.iter(|| tracer.occlusions(black_box(rays), &mut occluded).expect("equal lengths")),
                false => bencher.iter(|| tracer.closest_hits(black_box(rays), &mut hits).expect("equal lengths")),
            });
        }
    }
}
