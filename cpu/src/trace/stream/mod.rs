//! Rays that share an octant, on the way down together: each node and each block is visited once, for all rays that meet it.
//!
//! ```text
//! for each packet that comes in: its rays join the groups of their octants
//! a group is full, or no more rays come:
//!     visit the root with the list of all its rays
//!     visit(node, list):
//!         test all rays of the list against the node's eight boxes, one ray a time
//!         for each box that any ray meets, farthest first: a list of those that do waits with the child
//!     visit(block, list): test each ray of the list against the eight triangles
//!     go on with the list that waits last, until none does
//! ```
//! What is loaded and converted serves many rays, and those do not wait for each other. Rays of an octant meet a node's
//! children in one order, so each visits them as it would alone.
//!
//! Source: R. Barringer and T. Akenine-Möller, "Dynamic Ray Stream Traversal", ACM Transactions on Graphics 33(4), 2014,
//! <https://doi.org/10.1145/2601097.2601222>. Departures from it:
//! 1. A group holds rays of one octant only, so that one order of children serves all.
//! 2. Nodes have eight children, so each ray is tested against eight boxes at once, not each box against eight rays.
//! 3. A ray drops out of a list where its nearest hit lies before the box; the lists that wait are not sorted again.

mod group;

use leafwalk_core::layout::{BVH_WIDTH, MAX_DEPTH};
use leafwalk_core::unroll;

use super::bvh::stack::FARTHEST_FIRST;
use super::bvh::{BlockSource, Bvh, ROOT};
use super::packet::Packet;
use super::query::Query;
use crate::lanes::Eight;
use group::{EIGHTS, Group};

/// Children that may wait: all those of each node on the way to the deepest one.
const WAITING: usize = MAX_DEPTH * BVH_WIDTH;

/// A child to visit, and the rays that meet it: a part of the lists.
#[derive(Clone, Copy, Debug)]
struct Visit {
    child: u32,
    /// Where the part begins, counted in eights of rays.
    begin: u32,
    /// How many rays it has.
    len: u32,
}

/// Rays that wait or are under way, and room for their lists.
pub(crate) struct Stream {
    groups: [Group; 8],
    /// Rays by their places in the group: all of them, which the root is visited with, then those that meet each child that
    /// waits, the child to visit next last. What stands behind that is left over from earlier visits.
    lists: Vec<[u32; 8]>,
    visits: Box<[Visit; WAITING]>,
    /// Nodes visited since the sharing was last asked for, and the sum of the numbers of rays that met each.
    nodes: u64,
    rays_at_nodes: u64,
}

impl Stream {
    pub(crate) fn new() -> Self {
        Self {
            groups: core::array::from_fn(|_| Group::new()),
            lists: (0..EIGHTS as u32).map(|eight| unroll!(lane in 0..8 => 8 * eight + lane)).collect(),
            visits: Box::new([Visit { child: ROOT, begin: 0, len: 0 }; WAITING]),
            nodes: 0,
            rays_at_nodes: 0,
        }
    }

    /// Takes in the rays of a packet, and traces the groups that are full; without a packet, traces all. The answers of
    /// rays that miss were written before.
    #[inline(always)]
    pub(crate) fn admit<L: Eight, B: BlockSource, Q: Query>(
        &mut self,
        bvh: &Bvh<'_, B>,
        packet: Option<&mut Packet>,
        answers: &mut [Q::Answer],
    ) {
        let is_end = packet.is_none();
        if let Some(packet) = packet {
            Group::admit::<L, B>(&mut self.groups, packet);
        }
        for octant in 0..8 {
            let group = &self.groups[octant];
            if group.is_full() || (is_end && group.len() > 0) {
                self.descend::<L, B, Q>(bvh, octant);
                self.groups[octant].answer::<Q>(answers);
            }
        }
    }

    /// How many rays met a node that any met, on average since this was last asked; `None` where no node was visited.
    #[inline(always)]
    pub(crate) fn take_sharing(&mut self) -> Option<f32> {
        let (nodes, rays) = (core::mem::take(&mut self.nodes), core::mem::take(&mut self.rays_at_nodes));
        (nodes > 0).then(|| rays as f32 / nodes as f32)
    }

    /// Traces the rays of a group.
    #[inline(always)]
    fn descend<L: Eight, B: BlockSource, Q: Query>(&mut self, bvh: &Bvh<'_, B>, octant: usize) {
        let Self { groups, lists, visits, .. } = self;
        let group = &mut groups[octant];
        let neg = octant as u32;
        let order = L::order(neg);
        let mut visit = Visit { child: ROOT, begin: 0, len: group.len() as u32 };
        let (mut nodes, mut rays_at_nodes) = (0, 0);
        let (mut waiting, mut room) = (0, None);
        loop {
            let Visit { child, begin, len } = visit;
            let (begin, eights) = (begin as usize, len.div_ceil(8) as usize);
            if let Some(node) = bvh.node(child) {
                nodes += 1;
                rays_at_nodes += u64::from(len);
                // The lists of all children fit behind this one, and behind that of the root, which stays.
                let end = (begin + eights).max(EIGHTS);
                if lists.len() < end + 8 * eights {
                    lists.resize(end + 8 * eights, [0; 8]);
                }
                let (lists, room) = lists.split_at_mut(end);
                let list = &lists[begin..begin + eights];
                let (met, mut left) =
                    group.boxes_hit::<L, B>((&bvh.blocks, child), node, order, neg, list, len as usize);
                let room = room.as_flattened_mut();
                let mut top = 0;
                while left != 0 {
                    let place = left.ilog2();
                    left ^= 1 << place;
                    let lane = if L::IS_BY_SLOT { place ^ neg } else { place };
                    let from = top;
                    for (rays, met) in list.iter().zip(&met) {
                        let met = column(*met, lane);
                        let rays = L::load(bytemuck::cast_ref(rays))
                            .permute_lanes(&FARTHEST_FIRST[met as usize], 0)
                            .to_array();
                        room[top..top + 8].copy_from_slice(bytemuck::cast_slice(&rays));
                        top += met.count_ones() as usize;
                    }
                    let child = node.children[(place ^ neg) as usize & 7];
                    bvh.prefetch::<L>(child);
                    visits[waiting] = Visit { child, begin: (end + from / 8) as u32, len: (top - from) as u32 };
                    waiting += 1;
                    top = top.next_multiple_of(8);
                }
            } else if let Some(block) = bvh.block(child, &mut room) {
                for ray in lists[begin..].as_flattened().iter().take(len as usize) {
                    group.test::<L, Q>(block, *ray as usize);
                }
            }
            if waiting == 0 {
                self.nodes += nodes;
                self.rays_at_nodes += rays_at_nodes;
                return;
            }
            waiting -= 1;
            visit = visits[waiting];
        }
    }
}

/// Which of eight rays meet a lane, a bit a ray, given which lanes each ray meets, a byte a ray.
#[inline(always)]
pub(crate) fn column(met: u64, lane: u32) -> u32 {
    const LOWEST: u64 = 0x0101_0101_0101_0101;
    // Moves bit 8 i to bit 56 + i.
    const GATHER: u64 = 0x0102_0408_1020_4080;
    ((met >> lane & LOWEST).wrapping_mul(GATHER) >> 56) as u32
}
