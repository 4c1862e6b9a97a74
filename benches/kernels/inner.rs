//! The innermost loops: rays become canonical, and meet boxes, triangles and exit faces.

use core::hint::black_box;

use criterion::Criterion;
use leafwalk::{Ray, Walk};
use leafwalk_core::layout::{BLOCK_WIDTH, BVH_WIDTH, Record};
use leafwalk_core::step::{Cell, Line, Pluecker, Slab, Step, cross, neighbour};
use leafwalk_core::{Blocks, CanonicalRay};
use leafwalk_cpu::testing;

use crate::{Scene, group};

/// Rays that become canonical.
const RAYS: usize = 1024;
/// Rays that go from leaf to leaf.
const WALKS: usize = 64;
/// Nodes, and blocks, that a ray is tested against: few enough to stay in the first cache.
const TESTED: usize = 64;

pub(crate) fn measure(criterion: &mut Criterion, scene: &Scene) {
    canonical_rays(criterion, scene);
    boxes_and_triangles(criterion, scene);
    steps(criterion, scene);
}

/// Primary rays of all parts of the picture.
fn primary(scene: &Scene, count: usize) -> Vec<Ray> {
    let rays = &scene.workloads[0].rays;
    rays.iter().step_by(rays.len() / count).take(count).copied().collect()
}

/// One by one, of the kind that f32 serves and from so far away that f64 must; and eight at a time, as packets.
fn canonical_rays(criterion: &mut Criterion, scene: &Scene) {
    let frame = scene.octree.frame();
    let near = primary(scene, RAYS);
    let back = |ray: &Ray| Ray { origin: ray.at(-1e3), ..*ray };
    let far: Vec<Ray> = near.iter().map(back).collect();
    let mut group = group(criterion, "canonical rays", RAYS);
    for (name, rays) in [("near", &near), ("far", &far)] {
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                for ray in black_box(rays) {
                    black_box(frame.canonical(ray));
                }
            });
        });
    }
    for (registers, tracer) in scene.tracers() {
        group.bench_function(format!("packets, {registers}"), |bencher| {
            bencher.iter(|| testing::traceable(&tracer, black_box(&near)));
        });
    }
}

fn boxes_and_triangles(criterion: &mut Criterion, scene: &Scene) {
    let frame = scene.octree.frame();
    // Through the middle of the picture, so that it meets something.
    let rays = primary(scene, 2);
    let ray: CanonicalRay = frame.canonical(&rays[1]).expect("a ray at the scene");
    let nodes = &scene.octree.bvh()[..TESTED];
    let Blocks::Packed(blocks) = scene.octree.blocks() else { unreachable!("built without `compact`") };
    let blocks = &blocks[..TESTED];
    let mut boxes = group(criterion, "boxes of nodes", BVH_WIDTH * TESTED);
    for (registers, tracer) in scene.tracers() {
        boxes.bench_function(registers, |bencher| {
            bencher.iter(|| testing::boxes_met(&tracer, black_box(nodes), black_box(&ray)));
        });
    }
    boxes.finish();
    let mut triangles = group(criterion, "triangles of blocks", BLOCK_WIDTH * TESTED);
    for (registers, tracer) in scene.tracers() {
        triangles.bench_function(registers, |bencher| {
            bencher.iter(|| testing::nearest(&tracer, black_box(blocks), black_box(&ray)));
        });
    }
}

/// A ray, and the cells of its walk with their records.
type Way<'a> = (Line<f32>, Vec<(Cell<f32>, &'a Record)>);

fn steps(criterion: &mut Criterion, scene: &Scene) {
    let parts = scene.octree.parts();
    let way = |ray: &Ray| -> Option<Way<'_>> {
        let canonical = parts.frame.canonical(ray)?;
        let line = Line::new(canonical.within, canonical.direction);
        let mut cells = Vec::new();
        Walk::new(&parts).visit(ray, |number, key| cells.push((Cell::new(key), &parts.records[number as usize])));
        Some((line, cells))
    };
    let ways: Vec<Way<'_>> = primary(scene, WALKS).iter().filter_map(way).collect();
    let mut group = group(criterion, "steps", ways.iter().map(|(_, cells)| cells.len()).sum());
    group.bench_function("by slabs", |bencher| bencher.iter(|| step_all::<Slab>(black_box(&ways))));
    group.bench_function("by Plücker signs", |bencher| bencher.iter(|| step_all::<Pluecker>(black_box(&ways))));
}

fn step_all<S: Step>(ways: &[Way<'_>]) {
    for (line, cells) in ways {
        for (cell, record) in cells {
            let exit = S::exit(line, cell);
            black_box(cross::<f32, S>(line, cell, &exit, record.head().0, neighbour(record, exit.face)));
        }
    }
}
