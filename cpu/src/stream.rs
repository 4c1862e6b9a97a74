//! Rays that share an octant, on the way down together: each branch and each block is visited once, for all rays that
//! meet it (Barringer & Akenine-Möller, "Dynamic Ray Stream Traversal", 2014).
//!
//! What is loaded and converted serves many rays, and those do not wait for each other. Rays of an octant meet a
//! branch's children in one order, so each visits them as it would alone.

use bytemuck::Zeroable;
use leafwalk_core::layout::{BRANCH_WIDTH, Block, Branch, MAX_DEPTH, NONE};
use leafwalk_core::triangle::{PERMUTATIONS, Shear};
use leafwalk_core::{Clock, Nearest, Ray, per_axis};

use crate::hierarchy::{Hierarchy, ROOT, Source};
use crate::lanes::{Eight, eight_times};
use crate::node::{Facing, test_block};
use crate::prepare::Prepared;
use crate::question::Question;
use crate::stack::FARTHEST_FIRST;

/// Rays that go down together at most: their probes take half of a core's first cache.
const GROUP: usize = 256;
/// A group's rays eight by eight.
const EIGHTS: usize = GROUP / 8;
/// Of each branch on the way to the deepest one all children.
const WAITING: usize = MAX_DEPTH * BRANCH_WIDTH;

/// What the boxes of branches are tested with, and the hit so far: a cache line.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(64))]
struct Probe {
    inverse: [f32; 3],
    near: [f32; 3],
    far: [f32; 3],
    t_min: f32,
    t: f32,
    u: f32,
    v: f32,
    primitive: u32,
    /// Which of the batch.
    index: u32,
    main_axis: u32,
}

/// Rays of an octant: the first `len` of each array.
struct Group {
    probes: Box<[Probe; GROUP]>,
    /// Origin and slope, permuted.
    shears: Box<[[f32; 8]; GROUP]>,
    clocks: Box<[Clock; GROUP]>,
    len: usize,
}

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
        let group = || Group {
            probes: Box::new([Probe::zeroed(); GROUP]),
            shears: Box::new([[0.0; 8]; GROUP]),
            clocks: Box::new([Clock { entry: 0.0, unit: 1.0 }; GROUP]),
            len: 0,
        };
        Self {
            groups: core::array::from_fn(|_| group()),
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
        let mut first = 0;
        while first < rays.len() || self.groups.iter().any(|group| group.len > 0) {
            let mut octant = 0;
            if first < rays.len() {
                let eight = &rays[first..rays.len().min(first + 8)];
                self.admit::<L>(&Prepared::of::<L>(&hierarchy.frame, eight), first as u32);
                first += 8;
            }
            while octant < 8 {
                let len = self.groups[octant].len;
                if len > GROUP - 8 || (first >= rays.len() && len > 0) {
                    let (visited, by_rays) = self.descend::<L, B, Q>(hierarchy, octant);
                    branches += visited;
                    rays_at_branches += by_rays;
                    self.groups[octant].answer::<Q>(answers);
                }
                octant += 1;
            }
        }
        rays_at_branches as f32 / branches as f32
    }

    /// Puts rays into the groups of their octants.
    #[inline(always)]
    fn admit<L: Eight>(&mut self, rays: &Prepared, first: u32) {
        let inverse: [L; 3] = per_axis!(k => L::load(&rays.inverse[k]));
        let [near, far] = rays.facing::<L>();
        let zero = L::splat(0.0);
        let (index, axis) = (eight_times!(lane => first + lane), rays.main_axis.map(u32::from));
        let [x, y, z] = inverse;
        let head = L::transpose([x, y, z, near[0], near[1], near[2], far[0], far[1]]);
        let tail = L::transpose([
            far[2],
            L::load(&rays.t_min),
            L::load(&rays.t_max),
            zero,
            zero,
            L::load(bytemuck::cast_ref(&[NONE; 8])),
            L::load(bytemuck::cast_ref(&index)),
            L::load(bytemuck::cast_ref(&axis)),
        ]);
        let [a, b, c, d, e, f]: [L; 6] = [
            L::load(&rays.origin[0]),
            L::load(&rays.origin[1]),
            L::load(&rays.origin[2]),
            L::load(&rays.slope[0]),
            L::load(&rays.slope[1]),
            L::load(&rays.slope[2]),
        ];
        let shears = L::transpose([a, b, c, d, e, f, zero, zero]);
        let probes: [[[f32; 8]; 2]; 8] = eight_times!(lane => [head[lane].to_array(), tail[lane].to_array()]);
        let shears: [[f32; 8]; 8] = eight_times!(lane => shears[lane].to_array());
        for lane in 0..8 {
            if rays.waiting >> lane & 1 == 1 {
                let group = &mut self.groups[rays.neg[lane] as usize & 7];
                let at = group.len % GROUP;
                group.probes[at] = bytemuck::cast(probes[lane]);
                group.shears[at] = shears[lane];
                group.clocks[at] = rays.clocks[lane];
                group.len = at + 1;
            }
        }
    }

    /// Traces a group. Returns how many branches it visited, and the sum of the numbers of rays that met each.
    #[inline(always)]
    fn descend<L: Eight, B: Source, Q: Question>(&mut self, hierarchy: &Hierarchy<'_, B>, octant: usize) -> (u32, u32) {
        let Self { groups, lists, visits } = self;
        let group = &mut groups[octant];
        let neg = octant as u32;
        let order = L::order(neg);
        let mut visit = Visit { child: ROOT, begin: 0, len: group.len as u32 };
        lists.clear();
        lists.extend((0..EIGHTS as u32).map(|eight| eight_times!(lane => 8 * eight + lane)));
        let (mut branches, mut rays_at_branches) = (0, 0);
        let (mut waiting, mut room) = (0, None);
        loop {
            let Visit { child, begin, len } = visit;
            let (begin, eights) = (begin as usize, len.div_ceil(8) as usize);
            if let Some(branch) = hierarchy.branch(child) {
                branches += 1;
                rays_at_branches += len;
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
                    group.test::<L, Q>(block, *ray as usize % GROUP);
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
fn column(met: u64, lane: u32) -> u32 {
    const LOWEST: u64 = 0x0101_0101_0101_0101;
    // Moves bit 8 i to bit 56 + i.
    const GATHER: u64 = 0x0102_0408_1020_4080;
    ((met >> lane & LOWEST).wrapping_mul(GATHER) >> 56) as u32
}

impl Group {
    /// Which lanes of a branch each ray meets, eight rays a number; and a mask of those that any meets, in the rays' order.
    #[inline(always)]
    fn meet<L: Eight>(
        &self,
        branch: &Branch,
        order: L::Order,
        neg: u32,
        list: &[[u32; 8]],
        len: usize,
    ) -> ([u64; EIGHTS], u32) {
        let boxes = Facing::<L>::new(branch, order, neg);
        let mut met = [0; EIGHTS];
        let mut union = 0;
        let mut left = len;
        for (rays, met) in list.iter().zip(&mut met) {
            let mut shift = 0;
            for ray in &rays[..left.min(8)] {
                let probe = &self.probes[*ray as usize % GROUP];
                let (inverse, near, far) = (&probe.inverse, &probe.near, &probe.far);
                let a: [L; 3] = per_axis!(k => boxes.near[k].about_mul_add(L::splat(inverse[k]), L::splat(near[k])));
                let b: [L; 3] = per_axis!(k => boxes.far[k].about_mul_add(L::splat(inverse[k]), L::splat(far[k])));
                let first = L::splat(probe.t_min).max(a[0]).max(a[1].max(a[2]));
                let last = L::splat(probe.t).min(b[0]).min(b[1].min(b[2]));
                *met |= u64::from(leafwalk_core::lanes::Mask::to_bits(first.at_most(last))) << shift;
                shift += 8;
            }
            union |= *met;
            left = left.saturating_sub(8);
        }
        union |= union >> 32;
        union |= union >> 16;
        union |= union >> 8;
        (met, crate::stack::in_order::<L>(neg, union as u32 & 0xff))
    }

    /// Tests a block's triangles against a ray.
    #[inline(always)]
    fn test<L: Eight, Q: Question>(&mut self, block: &Block, ray: usize) {
        let (probe, [x, y, z, a, b, c, ..]) = (&mut self.probes[ray], self.shears[ray]);
        if Q::ANY && probe.primitive != NONE {
            return;
        }
        let Probe { t_min, t, u, v, primitive, .. } = *probe;
        let mut nearest = Nearest { t_min, t, u, v, primitive };
        let shear = Shear::<L>::splat(&Shear { origin: [x, y, z], slope: [a, b, c] });
        test_block(block, &shear, PERMUTATIONS[probe.main_axis as usize % 3], &mut nearest);
        (probe.t, probe.u, probe.v, probe.primitive) = (nearest.t, nearest.u, nearest.v, nearest.primitive);
        if Q::ANY && nearest.is_hit() {
            // Nothing is nearer: the ray asks for no more.
            probe.t = f32::NEG_INFINITY;
        }
    }

    /// Answers all rays, and forgets them.
    #[inline(always)]
    fn answer<Q: Question>(&mut self, answers: &mut [Q::Answer]) {
        for (probe, clock) in self.probes[..self.len].iter().zip(&*self.clocks) {
            let Probe { t_min, t, u, v, primitive, index, .. } = *probe;
            answers[index as usize] = Q::answer(clock, &Nearest { t_min, t, u, v, primitive });
        }
        self.len = 0;
    }
}
