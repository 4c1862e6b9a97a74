//! P6: whatever is wrong with the words, decoding says so, by name and number; and what it accepts is as it was.

mod bvh;
mod compact;
mod contents;
mod document;
mod embedded;
mod frozen;
mod lattices;
mod links;
mod preamble;
mod round_trip;
mod tree;

use leafwalk::{Builder, DecodeError};
use leafwalk_core::contract::{MESH_MARGIN, ROUNDOFF, SMALLEST};
use leafwalk_core::layout::LATTICE;
use leafwalk_testing::edited::Edited;
use leafwalk_testing::meshes;

/// Levels 0 to 4 or so, with neighbours of the same size, coarser and finer; the last of the blocks has vacant lanes.
fn levels() -> Edited {
    Edited::new(&Builder::new().step_cost(0.5).max_level(4).build(&meshes::soup(145, 21)).expect("a mesh that builds"))
}

/// Eight leaves of over 64 triangles each, which list nodes of the BVH.
fn nodes() -> Edited {
    Edited::new(&Builder::new().step_cost(0.5).max_level(1).build(&meshes::soup(1500, 22)).expect("a mesh that builds"))
}

/// Four leaves or so of a compact octree, in blocks that share vertices; the last of them has one triangle.
fn compact() -> Edited {
    let mut mesh = meshes::icosphere(1);
    mesh.triangles.truncate(73);
    Edited::new(&Builder::new().compact().step_cost(0.5).max_level(2).build(&mesh).expect("a mesh that builds"))
}

/// Nodes of a wide octree: a sphere in a sky box 500 times its size.
fn wide() -> Edited {
    let mesh = meshes::in_sky_box(&meshes::icosphere(3), 1e5, 0.0);
    Edited::new(&Builder::new().step_cost(0.5).max_level(1).build(&mesh).expect("a mesh that builds"))
}

/// Decodes after an edit, and expects an error.
#[track_caller]
fn refused(valid: &Edited, edit: impl FnOnce(&mut Edited)) -> DecodeError {
    valid.decode_with(edit).map(drop).expect_err("the edit must be refused")
}

/// What no coordinate of a vertex may be, given where the root's lower side is, such that 0 lies inside the root.
fn no_coordinates(root: f32) -> [f32; 11] {
    let upper = root + LATTICE as f32;
    assert!(root + MESH_MARGIN < 0.0 && upper - MESH_MARGIN > 0.0, "a root around 0");
    // Seen from the lower side, the upper one is where numbers are a roundoff of the root's edge apart.
    let apart = ROUNDOFF * LATTICE as f32;
    let in_margin = [root + MESH_MARGIN - apart, upper - MESH_MARGIN + apart];
    let tiny = [-0.0, f32::from_bits(1), SMALLEST.next_down(), -SMALLEST.next_down()];
    let far = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, root - 1.0, upper];
    core::array::from_fn(|i| [&in_margin[..], &tiny, &far].concat()[i])
}
