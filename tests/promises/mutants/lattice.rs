//! Triangles next to the planes of cells: a mesh whose frame is the root cube itself, so that the caller's units are
//! lattice units, split to one level wherever a triangle lies.

use leafwalk::{Builder, Mesh, Octree};
use leafwalk_cpu::testing::{Spoiled, spoil};

/// `x`, some ULPs further up or down.
pub(crate) fn steps(x: f32, steps: usize, is_upward: bool) -> f32 {
    (0..steps).fold(x, |x, _| if is_upward { x.next_up() } else { x.next_down() })
}

/// The triangles, and two in opposite corners that make the frame 0..1.
pub(crate) fn on_lattice(triangles: &[[[f32; 3]; 3]], level: u32, spoiled: Spoiled) -> Octree<Vec<u32>> {
    let at = |c: f32, size: f32| [[c; 3], [c, c, c + size], [c, c + size, c]];
    let frame = [at(1.0 / 1024.0, 1.0 / 1024.0), at(1.0 - 1.0 / 1024.0, -1.0 / 1024.0)];
    let positions: Vec<_> = triangles.iter().chain(&frame).flatten().copied().collect();
    let indices = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let builder = spoil(Builder::new().step_cost(0.5).max_level(level), spoiled);
    let octree = builder.build(&Mesh::new(positions, indices)).expect("a mesh that builds");
    let frame = octree.parts().frame;
    assert_eq!((frame.origin, frame.scale()), ([0.0; 3], 1.0), "cells must have their planes where triangles are");
    octree
}
