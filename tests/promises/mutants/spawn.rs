//! Mutants of the offset with which rays leave a triangle.

use leafwalk::{Builder, Mesh};
use leafwalk_core::testing::spawn_lifted;
use leafwalk_testing::meshes;

use crate::spawn::{Spawn, faults};

const RAYS: u64 = 10_000;

/// P7 with rays that leave by a function.
fn caught(mesh: &Mesh, spawn: Spawn, mutant: &str) {
    let octree = Builder::new().build(mesh).expect("a mesh that builds");
    faults(&octree, mesh, spawn, RAYS, 68).0.catches(mutant);
}

#[test]
fn no_offset() {
    let spawn: Spawn = |hit, _, corners, direction| spawn_lifted(hit, corners, direction, 0.0);
    caught(&meshes::icosphere(3), spawn, "rays start on the triangle that they leave");
}

/// Rounding the origin to f32 may bring it to the other side of its triangle.
#[test]
fn no_offset_for_large_coordinates() {
    let spawn: Spawn = |hit, frame, corners, direction| {
        let offset = frame.clearance(corners, [0.0; 3]);
        spawn_lifted(hit, corners, direction, offset)
    };
    caught(&meshes::placed(&meshes::soup(1000, 69), 1.0, 1e4), spawn, "offsets without the share of the coordinates");
}
