//! The mutant that stops at the exit plane without a margin.
//!
//! Padding hides it: what a walk would stop before lies so close behind the plane that the leaf on this side lists it
//! as well. To be seen, a triangle more than 40 roundoffs (of the root's edge) behind the plane would need a t' that falls
//! before it. The bound is 48: e2, and what docs/contract.md, "Stop margin", has. The worst of 2.5e8 rays and triangles, found
//! by climbing, is 8.1. So the octree is binned without padding, and its rays pass through the
//! middle of faces, where no step goes wrong: there the margin alone decides.

use leafwalk::Ray;
use leafwalk_core::layout::BLOCK_WIDTH;
use leafwalk_core::testing::{Policy, Standard};
use leafwalk_cpu::testing::Spoiled;
use leafwalk_testing::random::Random;
use leafwalk_testing::rays::towards;

use super::clauses::under;
use super::lattice::{CORNERS, on_lattice, steps};

/// Leaves of 1/8 of the root.
const LEVEL: u32 = 3;
const CELLS: usize = 1 << LEVEL;

#[derive(Clone, Copy)]
struct NoMargin;
impl Policy for NoMargin {
    const STOP_MARGIN: bool = false;
}

/// Two triangles, a few ULPs to either side of the middle of a face: the axis across it, and the triangles.
fn pair(root: [f32; 3], seed: u64, index: u64) -> (usize, [[[f32; 3]; 3]; 2]) {
    let mut random = Random::new(seed, index);
    let across = random.below(3);
    let cell: [usize; 3] = core::array::from_fn(|_| 1 + random.below(CELLS - 2));
    let mut triangle = |is_upper: bool| {
        core::array::from_fn(|_| {
            core::array::from_fn(|k| match k == across {
                true => steps(root[k] + cell[k] as f32 / CELLS as f32, 1 + random.below(3), is_upper),
                false => root[k] + (cell[k] as f32 + 0.3 + 0.4 * random.unit()) / CELLS as f32,
            })
        })
    };
    let mut pair = [triangle(false), triangle(true)];
    // The one of the smaller index wins ties.
    pair.rotate_left(random.below(2));
    (across, pair)
}

#[test]
fn no_stop_margin() {
    CORNERS.into_iter().for_each(check);
}

fn check(root: [f32; 3]) {
    let pairs: Vec<_> = (0..60).map(|index| pair(root, 91, index)).collect();
    // Eight of each, which fill a block: what shares a block is tested together, on whichever side of the face it lies.
    let triangles: Vec<_> =
        pairs.iter().flat_map(|(_, pair)| *pair).flat_map(|triangle| [triangle; BLOCK_WIDTH]).collect();
    let rays = |random: &mut Random| -> Ray {
        let (across, pair) = pairs[random.below(pairs.len())];
        let corners = pair[random.below(2)];
        let (u, v) = (0.5 * random.unit(), 0.5 * random.unit());
        let target: [f32; 3] = core::array::from_fn(|k| {
            corners[0][k] + u * (corners[1][k] - corners[0][k]) + v * (corners[2][k] - corners[0][k])
        });
        let place = random.vector().map(|c| (0.5 + 1.5 * c).clamp(-0.99, 1.99));
        let mut origin = core::array::from_fn(|k| root[k] + place[k]);
        // Not along the face.
        if (origin[across] - target[across]).abs() < 0.2 {
            origin[across] = root[across] + if random.below(2) == 0 { -0.7 } else { 1.7 };
        }
        towards(origin, target)
    };
    let octree = on_lattice(&triangles, root, LEVEL, Spoiled::Padding);
    under::<Standard>(&octree, &rays, 92)
        .passes(&format!("binned without padding, stop margin kept, P2, root at {root:?}"), 0.5);
    under::<NoMargin>(&octree, &rays, 92).catches(&format!("stop margin 0, root at {root:?}"));
}
