//! From the root down: eight boxes of a payload at once, nearest octant first.
//!
//! The octree's payloads are a bounding volume hierarchy of eight children a node. A ray that descends it meets the box
//! of every block in which it hits something (ARCHITECTURE.md, "Descent"), so it gives what the walk gives.

use leafwalk_core::boxes::{Boxes, near_and_far};
use leafwalk_core::lanes::Mask as _;
use leafwalk_core::layout::{Block, LATTICE, MAX_LEVEL, Payload};
use leafwalk_core::step::Line;
use leafwalk_core::triangle::{Shear, Sheared};
use leafwalk_core::{CanonicalRay, Nearest, Parts};

use crate::lanes::Eight;

/// Nodes that wait: of each level at most the seven siblings of the one in work.
const STACK: usize = 7 * MAX_LEVEL as usize + 1;

/// A node to visit.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    payload: u32,
    /// t' where the ray enters its box.
    first: f32,
    place: Place,
}

/// A cell in 16-bit fields: the lower corner, and the binary logarithm of the edge.
#[derive(Clone, Copy, Debug)]
struct Place(u64);

impl Place {
    const ROOT: Self = Self((LATTICE.ilog2() as u64) << 48);

    fn corner(self) -> [u32; 3] {
        [0, 16, 32].map(|shift| (self.0 >> shift & 0xffff) as u32)
    }

    fn log_size(self) -> u32 {
        (self.0 >> 48) as u32
    }

    fn child(self, octant: u32) -> Self {
        const SPREAD: [u64; 8] = {
            let mut spread = [0; 8];
            let mut octant = 0;
            while octant < 8 {
                spread[octant] = (octant as u64 & 1) | (octant as u64 >> 1 & 1) << 16 | (octant as u64 >> 2) << 32;
                octant += 1;
            }
            spread
        };
        Self((self.0 - (1 << 48)) + (SPREAD[octant as usize] << (self.log_size() - 1)))
    }
}

/// Row n, column m: the octants in m, each XOR n.
const FLIPPED: [[u8; 256]; 8] = {
    let mut table = [[0; 256]; 8];
    let mut at = 0;
    while at < 8 * 256 * 8 {
        let (neg, mask, octant) = (at >> 11, at >> 3 & 0xff, at & 7);
        if mask >> octant & 1 == 1 {
            table[neg][mask] |= 1 << (octant ^ neg);
        }
        at += 1;
    }
    table
};

/// The nearest hit of one ray; with `ANY`, some hit.
#[inline(always)]
pub(crate) fn descend<L: Eight, const ANY: bool>(parts: &Parts<'_>, ray: &CanonicalRay) -> Nearest {
    let mut nearest = Nearest::new(ray);
    if parts.payloads.is_empty() {
        return nearest;
    }
    let line = Line::<f32>::new(ray);
    let (shear, axes) = Shear::<L>::new(ray);
    let root = Waiting { payload: 0, first: ray.t_min, place: Place::ROOT };
    let mut stack = [root; STACK];
    let mut waiting = 1;
    while waiting > 0 {
        waiting -= 1;
        let node = stack[waiting];
        if node.first > nearest.t {
            continue;
        }
        let mut payload = &parts.payloads[node.payload as usize];
        let boxes = Boxes::new(node.place.corner(), 1 << node.place.log_size(), &line);
        let (first, met) = meet::<L>(&boxes, line.neg, payload, &nearest);
        if payload.children != 0 {
            let mut ahead = FLIPPED[line.neg as usize][met as usize];
            while ahead != 0 {
                let farthest = ahead.ilog2();
                ahead ^= 1 << farthest;
                let octant = farthest ^ line.neg;
                let first = first[octant as usize];
                stack[waiting] = Waiting { payload: payload.child(octant), first, place: node.place.child(octant) };
                waiting += 1;
            }
            continue;
        }
        let (mut first, mut met) = (first, met);
        loop {
            while met != 0 {
                let b = met.trailing_zeros();
                met &= met - 1;
                if first[b as usize] <= nearest.t {
                    test_block::<L>(&parts.blocks[(payload.first + b) as usize], &shear, axes, &mut nearest);
                    if ANY && nearest.is_hit() {
                        return nearest;
                    }
                }
            }
            match parts.payloads.get(payload.next as usize) {
                Some(next) => payload = next,
                None => break,
            }
            (first, met) = meet::<L>(&boxes, line.neg, payload, &nearest);
        }
    }
    nearest
}

/// Which of a payload's eight boxes a ray meets, and where it enters them.
#[inline(always)]
fn meet<L: Eight>(boxes: &Boxes, neg: u32, payload: &Payload, nearest: &Nearest) -> ([f32; 8], u32) {
    let (near, far) = near_and_far(neg, payload.box_lower.each_ref(), payload.box_upper.each_ref());
    let (near, far) = (near.map(L::from_bytes), far.map(L::from_bytes));
    let (first, last) = boxes.clip(near, far, L::splat(nearest.t_min), L::splat(nearest.t));
    (first.to_array(), first.at_most(last).to_bits())
}

/// Tests the eight triangles of a block against one ray.
#[inline(always)]
fn test_block<L: Eight>(block: &Block, shear: &Shear<L>, axes: [usize; 3], nearest: &mut Nearest) {
    let corners = core::array::from_fn(|corner| axes.map(|axis| L::load(&block.vertices[corner][axis])));
    let sheared = Sheared::new(shear, corners);
    let candidates = sheared.is_candidate();
    if !candidates.any() {
        return;
    }
    let (accepted, found) = sheared.finish(shear);
    let mut accepted = (accepted & candidates).to_bits();
    let (t, u, v) = (found.t.to_array(), found.u.to_array(), found.v.to_array());
    while accepted != 0 {
        let lane = accepted.trailing_zeros() as usize;
        accepted &= accepted - 1;
        nearest.offer(t[lane], u[lane], v[lane], block.primitives[lane]);
    }
}
