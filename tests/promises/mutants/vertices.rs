//! Mutants of compact octrees: one vertex number off.

use leafwalk::{Builder, CpuTracer};
use leafwalk_testing::differences::{differences, hard};
use leafwalk_testing::edited::Edited;
use leafwalk_testing::meshes;
use leafwalk_testing::tally::scaled;
use leafwalk_testing::tracers::{Every, Named, OneByOne};

#[test]
fn one_vertex_number_off() {
    let mesh = meshes::bumpy_sphere(2, 72);
    let right = Builder::new().compact().build(&mesh).expect("a mesh that builds");
    let oracle = Every::<f32>::of(&right);
    let valid = Edited::new(&right);
    // Where a vertex was named before, and the other one, too, the decoder has nothing to say.
    let blocks = valid.clone().indexed_blocks().len();
    let wrong = (0..24 * blocks).rev().find_map(|i| {
        let edited = valid.decode_with(|file| file.indexed_blocks()[i / 24].numbers[i % 3][i % 24 / 3] ^= 1);
        edited.ok()
    });
    let wrong = wrong.expect("a number that decodes");
    let check = |octree: &leafwalk::Octree<Vec<u32>>| {
        let tracer = CpuTracer::new(octree.view());
        let tracers: [Named<'_>; 3] =
            [("the octree", octree), ("batches", &tracer), ("single rays", &OneByOne(&tracer))];
        differences(&tracers, &oracle, &hard(&mesh), scaled(10_000), 72)
    };
    check(&right).passes("every vertex number right, P2", 0.05);
    check(&wrong).catches("one vertex number off");
}
