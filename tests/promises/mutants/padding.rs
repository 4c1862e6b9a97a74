//! The mutant that bins without padding: it survives ordinary rays, for only where a rounded step enters the wrong one
//! of four cells around an edge, and a speck lies in the right one, is a hit lost.

use leafwalk::{Octree, Ray};
use leafwalk_core::testing::Standard;
use leafwalk_cpu::testing::Spoiled;
use leafwalk_testing::differences::Source;
use leafwalk_testing::random::Random;
use leafwalk_testing::rays::towards;
use leafwalk_testing::tally::Tally;

use super::clauses::{in_lanes, under};
use super::lattice::{CORNERS, on_lattice, steps};

/// Leaves of 1/16 of the root.
const LEVEL: u32 = 4;
const CELLS: usize = 1 << LEVEL;

/// A triangle of a few ULPs in one of the four cells around an edge of the lattice.
struct Speck {
    corners: [[f32; 3]; 3],
    /// The axis that the edge is parallel to.
    along: usize,
    /// Bit k: the speck's cell is the upper one on axis k.
    upper: usize,
}

fn speck(root: [f32; 3], seed: u64, index: u64) -> Speck {
    let mut random = Random::new(seed, index);
    let (along, upper) = (random.below(3), random.below(8));
    let edge: [f32; 3] = core::array::from_fn(|_| (1 + random.below(CELLS - 1)) as f32 / CELLS as f32);
    // In the middle third of a cell, so that only the one edge is near.
    let middle = edge[along] + (random.unit() + 1.0) / (3 * CELLS) as f32;
    let mut corner = || {
        core::array::from_fn(|k| {
            let from = if k == along { middle } else { edge[k] };
            steps(root[k] + from, 1 + random.below(6), upper >> k & 1 == 1)
        })
    };
    Speck { corners: [corner(), corner(), corner()], along, upper }
}

/// A ray at a speck that cuts only the edge off its cell.
fn across_the_edge(root: [f32; 3], specks: &[Speck], random: &mut Random) -> Ray {
    let speck = &specks[random.below(specks.len())];
    let target = speck.corners[random.below(3)];
    // In the plane across the edge, the ray passes from one of the two other cells to the other.
    let sign = if random.below(2) == 0 { 1.0 } else { -1.0 };
    let (a, b) = ((speck.along + 1) % 3, (speck.along + 2) % 3);
    let same_side = (speck.upper >> a & 1) == (speck.upper >> b & 1);
    let mut away = [0.0; 3];
    away[speck.along] = random.signed();
    away[a] = sign * (0.1 + random.unit());
    away[b] = if same_side { -sign } else { sign } * (0.1 + random.unit());
    let distance = 1.5 * random.unit() + 0.1;
    // Up to one root edge outside, where origins stay where they are.
    let origin = core::array::from_fn(|k| (target[k] - distance * away[k]).clamp(root[k] - 0.99, root[k] + 1.99));
    towards(origin, target)
}

type Check = fn(&Octree<Vec<u32>>, Source<'_>, u64) -> Tally;

#[test]
fn no_padding() {
    for root in CORNERS {
        let specks: Vec<Speck> = (0..400).map(|index| speck(root, 81, index)).collect();
        let triangles: Vec<_> = specks.iter().map(|speck| speck.corners).collect();
        let rays = |random: &mut Random| across_the_edge(root, &specks, random);
        let [padded, unpadded] =
            [Spoiled::Nothing, Spoiled::Padding].map(|spoiled| on_lattice(&triangles, root, LEVEL, spoiled));
        for (walk, name) in [(under::<Standard> as Check, "one by one"), (in_lanes, "in lanes")] {
            walk(&padded, &rays, 82).passes(&format!("specks binned with padding, P2 {name}, root at {root:?}"), 0.05);
            walk(&unpadded, &rays, 82).catches(&format!("padding 0, {name}, root at {root:?}"));
        }
    }
}
