//! Rays of an octant: what of each is asked for again and again, close together.

use bytemuck::Zeroable;
use leafwalk_core::lanes::Mask as _;
use leafwalk_core::layout::{Block, Branch, NONE};
use leafwalk_core::triangle::{PERMUTATIONS, Shear};
use leafwalk_core::{Clock, Nearest, per_axis};

use crate::lanes::{Eight, eight_times};
use crate::node::{Facing, test_block};
use crate::prepare::Prepared;
use crate::question::Question;
use crate::stack::in_order;

/// Rays that go down together at most: their probes take half of a core's first cache.
const GROUP: usize = 256;
/// A group's rays eight by eight.
pub(crate) const EIGHTS: usize = GROUP / 8;

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
pub(crate) struct Group {
    probes: Box<[Probe; GROUP]>,
    /// Origin and slope, permuted.
    shears: Box<[[f32; 8]; GROUP]>,
    clocks: Box<[Clock; GROUP]>,
    len: usize,
}

impl Group {
    pub(crate) fn new() -> Self {
        Self {
            probes: Box::new([Probe::zeroed(); GROUP]),
            shears: Box::new([[0.0; 8]; GROUP]),
            clocks: Box::new([Clock { entry: 0.0, unit: 1.0 }; GROUP]),
            len: 0,
        }
    }

    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Whether there is no room for eight more.
    #[inline(always)]
    pub(crate) fn is_full(&self) -> bool {
        self.len > GROUP - 8
    }

    /// Puts eight rays into the groups of their octants, none of which is full; `first` is the number of the first ray.
    #[inline(always)]
    pub(crate) fn admit<L: Eight>(groups: &mut [Self; 8], rays: &Prepared, first: u32) {
        let inverse: [L; 3] = per_axis!(k => L::load(&rays.inverse[k]));
        let [near, far] = rays.facing::<L>();
        let zero = L::splat(0.0);
        let index = eight_times!(lane => first + lane);
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
            L::load(bytemuck::cast_ref(&rays.main_axis)),
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
                let group = &mut groups[rays.neg[lane] as usize & 7];
                let at = group.len % GROUP;
                group.probes[at] = bytemuck::cast(probes[lane]);
                group.shears[at] = shears[lane];
                group.clocks[at] = rays.clocks.get(lane);
                group.len = at + 1;
            }
        }
    }

    /// Which lanes of a branch each ray meets, eight rays a number; and a mask of those that any meets, in the rays'
    /// order.
    #[inline(always)]
    pub(crate) fn meet<L: Eight>(
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
                let slabs: [[L; 3]; 3] = [
                    per_axis!(k => L::splat(probe.inverse[k])),
                    per_axis!(k => L::splat(probe.near[k])),
                    per_axis!(k => L::splat(probe.far[k])),
                ];
                *met |= u64::from(boxes.met(&slabs, L::splat(probe.t_min), L::splat(probe.t)).to_bits()) << shift;
                shift += 8;
            }
            union |= *met;
            left = left.saturating_sub(8);
        }
        union |= union >> 32;
        union |= union >> 16;
        union |= union >> 8;
        (met, in_order::<L>(neg, union as u32 & 0xff))
    }

    /// Tests a block's triangles against a ray.
    #[inline(always)]
    pub(crate) fn test<L: Eight, Q: Question>(&mut self, block: &Block, ray: usize) {
        let (probe, [x, y, z, a, b, c, ..]) = (&mut self.probes[ray % GROUP], self.shears[ray % GROUP]);
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
    pub(crate) fn answer<Q: Question>(&mut self, answers: &mut [Q::Answer]) {
        for (probe, clock) in self.probes[..self.len].iter().zip(&*self.clocks) {
            let Probe { t_min, t, u, v, primitive, index, .. } = *probe;
            answers[index as usize] = Q::answer(clock, &Nearest { t_min, t, u, v, primitive });
        }
        self.len = 0;
    }
}
