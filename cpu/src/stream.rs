//! Rays that share an octant, on the way down together: each branch and each block is visited once, for all rays that
//! meet it (Barringer & Akenine-Möller, "Dynamic Ray Stream Traversal", 2014).
//!
//! What is loaded and converted serves many rays, and those do not wait for each other. Rays of an octant meet a
//! branch's children in one order, so each visits them as it would alone.

use leafwalk_core::Ray;
use leafwalk_core::layout::{BRANCH_WIDTH, MAX_DEPTH};

use crate::group::{EIGHTS, Group};
use crate::hierarchy::{Hierarchy, ROOT, Source};
use crate::lanes::{Eight, eight_times};
use crate::prepare::Prepared;
use crate::question::Question;
use crate::stack::FARTHEST_FIRST;

/// Of each branch on the way to the deepest one all children.
const WAITING: usize = MAX_DEPTH * BRANCH_WIDTH;

/// A child to visit, and the rays that meet it: a part of the lists.
#[derive(Clone, Copy, Debug)]
struct Visit {
    child: u32,
    /// The first eight of them.
    begin: u32,
    len: u32,
}

/// Rays under way, and room for them.
pub(crate) struct Stream {
    groups: [Group; 8],
    /// Rays by their places in the group: what each child that waits is met by, the child to visit next last.
    lists: Vec<[u32; 8]>,
    visits: Box<[Visit; WAITING]>,
}

impl Stream {
    pub(crate) fn new() -> Self {
        Self {
            groups: core::array::from_fn(|_| Group::new()),
            lists: Vec::new(),
            visits: Box::new([Visit { child: ROOT, begin: 0, len: 0 }; WAITING]),
        }
    }

    /// Answers rays; the answers are those of misses before. Returns how many rays met a branch that any met, on average.
    #[inline(always)]
    pub(crate) fn trace<L: Eight, B: Source, Q: Question>(
        &mut self,
        hierarchy: &Hierarchy<'_, B>,
        rays: &[Ray],
        answers: &mut [Q::Answer],
    ) -> f32 {
        let (mut branches, mut rays_at_branches) = (0, 0);
        let hull = hierarchy.hull();
        let mut eights = (0..).step_by(8).zip(rays.chunks(8));
        loop {
            let next = eights.next();
            if let Some((first, eight)) = next {
                let mut rays = Prepared::of::<L>(&hierarchy.frame, eight);
                rays.drop_beyond::<L>(&hull);
                Group::admit::<L>(&mut self.groups, &rays, first);
            }
            for octant in 0..8 {
                let group = &self.groups[octant];
                if group.is_full() || (next.is_none() && group.len() > 0) {
                    let (visited, by_rays) = self.descend::<L, B, Q>(hierarchy, octant);
                    branches += visited;
                    rays_at_branches += by_rays;
                    self.groups[octant].answer::<Q>(answers);
                }
            }
            if next.is_none() {
                return rays_at_branches as f32 / branches as f32;
            }
        }
    }

    /// Traces a group. Returns how many branches it visited, and the sum of the numbers of rays that met each.
    #[inline(always)]
    fn descend<L: Eight, B: Source, Q: Question>(&mut self, hierarchy: &Hierarchy<'_, B>, octant: usize) -> (u64, u64) {
        let Self { groups, lists, visits } = self;
        let group = &mut groups[octant];
        let neg = octant as u32;
        let order = L::order(neg);
        let mut visit = Visit { child: ROOT, begin: 0, len: group.len() as u32 };
        lists.clear();
        lists.extend((0..EIGHTS as u32).map(|eight| eight_times!(lane => 8 * eight + lane)));
        let (mut branches, mut rays_at_branches) = (0, 0);
        let (mut waiting, mut room) = (0, None);
        loop {
            let Visit { child, begin, len } = visit;
            let (begin, eights) = (begin as usize, len.div_ceil(8) as usize);
            if let Some(branch) = hierarchy.branch(child) {
                branches += 1;
                rays_at_branches += u64::from(len);
                // Room for the lists of all children.
                let end = begin + eights;
                if lists.len() < end + 8 * eights {
                    lists.resize(end + 8 * eights, [0; 8]);
                }
                let (lists, room) = lists.split_at_mut(end);
                let list = &lists[begin..];
                let (met, mut left) = group.meet::<L>(branch, order, neg, list, len as usize);
                let room = room.as_flattened_mut();
                let mut top = 0;
                while left != 0 {
                    let place = left.ilog2();
                    left ^= 1 << place;
                    let lane = if L::IS_BY_SLOT { place ^ neg } else { place };
                    let from = top;
                    for (rays, met) in list.iter().zip(&met) {
                        let met = column(*met, lane);
                        let rays = L::load(bytemuck::cast_ref(rays)).pick(&FARTHEST_FIRST[met as usize], 0).to_array();
                        room[top..top + 8].copy_from_slice(bytemuck::cast_slice(&rays));
                        top += met.count_ones() as usize;
                    }
                    let child = branch.children[(place ^ neg) as usize & 7];
                    hierarchy.prefetch::<L>(child);
                    visits[waiting] = Visit { child, begin: (end + from / 8) as u32, len: (top - from) as u32 };
                    waiting += 1;
                    top = top.next_multiple_of(8);
                }
            } else if let Some(block) = hierarchy.block(child, &mut room) {
                for ray in lists[begin..].as_flattened().iter().take(len as usize) {
                    group.test::<L, Q>(block, *ray as usize);
                }
            }
            if waiting == 0 {
                return (branches, rays_at_branches);
            }
            waiting -= 1;
            visit = visits[waiting];
        }
    }
}

/// Of eight rays' masks of lanes, eight bits each, the mask of rays that have a lane.
#[inline(always)]
pub(crate) fn column(met: u64, lane: u32) -> u32 {
    const LOWEST: u64 = 0x0101_0101_0101_0101;
    // Moves bit 8 i to bit 56 + i.
    const GATHER: u64 = 0x0102_0408_1020_4080;
    ((met >> lane & LOWEST).wrapping_mul(GATHER) >> 56) as u32
}
