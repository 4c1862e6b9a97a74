//! Mutants of the triangle test.

use leafwalk::{Mesh, Octree};
use leafwalk_testing::differences::{differences, hard};
use leafwalk_testing::meshes;
use leafwalk_testing::number::{Arithmetic, Fused, Lax, Number, Plain, Sound};
use leafwalk_testing::rays::Target;
use leafwalk_testing::tally::Tally;
use leafwalk_testing::tracers::{Every, Visited};

use crate::oracle;
use crate::scenes::Scene;
use crate::watertight::{Depth, aimed, inside, misses};

const RAYS: u64 = 20_000;

/// P1 by testing every triangle with an arithmetic.
fn leaks<A: Arithmetic>(mesh: &Mesh, target: Target) -> Tally {
    let scene = Scene::new(mesh);
    let inside = inside(mesh, Depth::Safe, 256, 51);
    let every = Every::<Number<A>>::of(&scene.octree);
    misses(aimed, &[("every triangle", &every)], mesh, &inside, target, RAYS, 51)
}

/// P2, the arithmetic being the same on both sides.
fn disagreements<A: Arithmetic>(mesh: &Mesh, octree: &Octree<Vec<u32>>) -> Tally {
    let parts = octree.parts();
    let visited = Visited::<Number<A>>::of(&parts);
    differences(&[("the visited leaves' triangles", &visited)], &Every::<Number<A>>::of(octree), &hard(mesh), RAYS, 52)
}

/// Hits off their triangles.
fn strays<A: Arithmetic>(mesh: &Mesh, octree: &Octree<Vec<u32>>) -> Tally {
    let every = Every::<Number<A>>::of(octree);
    oracle::faults(&every, &octree.parts().frame, mesh, &hard(mesh), RAYS, 53).0
}

#[test]
fn plain_differences_in_the_finish() {
    // Nearly in the plane of a needle, plain differences accept rays that pass far from it.
    let mesh = meshes::shards(500, 1e-3..4.0, 1e6, 54);
    let octree = Scene::new(&mesh).octree;
    disagreements::<Sound>(&mesh, &octree).passes("sound arithmetic, P2", 0.05);
    disagreements::<Plain>(&mesh, &octree).catches("plain U, V, W in the finish, by P2");
    strays::<Sound>(&mesh, &octree).passes("sound arithmetic, f64", 0.05);
    strays::<Plain>(&mesh, &octree).catches("plain U, V, W in the finish, by f64");
}

#[test]
fn at_most_instead_of_less() {
    let mesh = meshes::icosphere(2);
    for target in [Target::Edge, Target::Vertex] {
        leaks::<Sound>(&mesh, target).passes("sound arithmetic, P1", 1.0);
        leaks::<Lax>(&mesh, target).catches("<= for < in the triangle test, so that ties miss");
    }
}

#[test]
fn fused_products() {
    let mesh = meshes::icosphere(2);
    leaks::<Fused>(&mesh, Target::Edge).catches("fused multiply-add in the triangle test");
}
