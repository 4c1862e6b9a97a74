//! Leaves that meet more than eight blocks, and list nodes: nothing is cut off.

use leafwalk::{BruteForce, Builder, Mesh, verify_against};
use leafwalk_core::layout::{BVH_WIDTH, BvhNode, Child};
use leafwalk_testing::meshes;
use leafwalk_testing::properties::trace::check_ray;
use leafwalk_testing::random::Random;
use leafwalk_testing::rays;
use rayon::prelude::*;

fn check(name: &str, mesh: &Mesh, level: u32) {
    let octree = Builder::new().max_level(level).build(mesh).expect("a mesh that builds");
    let lists_nodes = |payload: &BvhNode| (0..BVH_WIDTH).any(|slot| matches!(payload.child(slot).1, Child::Node(_)));
    assert!(octree.parts().payloads.iter().any(lists_nodes), "{name}: leaves are to list nodes");
    verify_against(&octree, mesh).expect("an octree that verifies");
    let oracle = BruteForce::new(mesh).expect("a mesh that builds");
    let (centre, size) = rays::extent(mesh);
    (0..3_000).into_par_iter().for_each(|index| {
        let ray = rays::hard(mesh, centre, size, &mut Random::new(91, index));
        check_ray(&octree, &oracle, &ray);
    });
}

#[test]
fn leaves_that_list_nodes_answer_as_brute_force_does() {
    check("soup, root alone", &meshes::soup(500, 92), 0);
    check("soup, level 2", &meshes::soup(2000, 93), 2);
    check("walls, level 1", &meshes::walls(600, 94), 1);
    check("sphere, level 1", &meshes::icosphere(4), 1);
}
