//! Triangles next to the planes of cells: a mesh whose root cube is 1 wide and begins at a given place, split to one level
//! wherever a triangle lies.

use leafwalk::{Builder, Mesh, Octree};
use leafwalk_cpu::testing::{Spoiled, spoil};

/// `x`, some ULPs further up or down.
pub(crate) fn steps(x: f32, steps: usize, is_upward: bool) -> f32 {
    (0..steps).fold(x, |x, _| if is_upward { x.next_up() } else { x.next_down() })
}

/// Where roots begin: at the anchor, so that coordinates are the same as seen from either; and elsewhere, so that they are
/// rounded when they are seen from the root's corner. All are whole cells.
pub(crate) const CORNERS: [[f32; 3]; 2] = [[0.0; 3], [-0.5, -0.25, 0.75]];

/// The triangles, and two in opposite corners that make the root begin at `corner`.
pub(crate) fn on_lattice(
    triangles: &[[[f32; 3]; 3]],
    corner: [f32; 3],
    level: u32,
    spoiled: Spoiled,
) -> Octree<Vec<u32>> {
    let at = |c: f32, size: f32| {
        [[c; 3], [c, c, c + size], [c, c + size, c]].map(|[x, y, z]| [x + corner[0], y + corner[1], z + corner[2]])
    };
    let frame = [at(1.0 / 1024.0, 1.0 / 1024.0), at(1.0 - 1.0 / 1024.0, -1.0 / 1024.0)];
    let positions: Vec<_> = triangles.iter().chain(&frame).flatten().copied().collect();
    let indices = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let builder = spoil(Builder::new().step_cost(0.5).max_level(level), spoiled);
    let octree = builder.build(&Mesh::new(positions, indices)).expect("a mesh that builds");
    let frame = octree.parts().frame;
    let expected = (corner.map(f64::from), 1.0);
    assert_eq!(
        (frame.to_caller(frame.corner), frame.scale()),
        expected,
        "cells must have their planes where triangles are"
    );
    assert_eq!(frame.anchor, [0.0; 3]);
    octree
}
