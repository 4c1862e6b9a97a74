//! `Group`: the rays of an octant that go down together; what is asked of each again and again lies close together.

use bytemuck::Zeroable;
use leafwalk_core::lanes::Mask as _;
use leafwalk_core::layout::{Block, BvhNode, NONE};
use leafwalk_core::slabs::Slabs;
use leafwalk_core::triangle::{PERMUTATIONS, Shear};
use leafwalk_core::{Clock, Nearest, unroll};

use crate::lanes::Eight;
use crate::trace::bvh::BlockSource;
use crate::trace::bvh::node::{NearFarBoxes, test_block};
use crate::trace::bvh::stack::in_order;
use crate::trace::packet::Packet;
use crate::trace::query::Query;

/// Rays that go down together at most: what boxes are tested with takes half of a core's first cache.
const GROUP: usize = 256;
/// A group's rays, counted in eights.
pub(crate) const EIGHTS: usize = GROUP / 8;

/// What the boxes of nodes are tested with, and the nearest hit so far: a cache line.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(64))]
struct GroupRay {
    inverse: [f32; 3],
    /// In a wide octree, where t' is 0 in lattice coordinates.
    near: [f32; 3],
    far: [f32; 3],
    t_min: f32,
    t: f32,
    u: f32,
    v: f32,
    primitive: u32,
    /// The place of the ray in the batch.
    index: u32,
    main_axis: u32,
}

/// Rays of an octant: the first `len` of each array.
pub(crate) struct Group {
    rays: Box<[GroupRay; GROUP]>,
    /// What triangles are tested with: origin and slope, the main axis last.
    shears: Box<[[f32; 8]; GROUP]>,
    clocks: Box<[Clock; GROUP]>,
    len: usize,
}

impl Group {
    pub(crate) fn new() -> Self {
        Self {
            rays: Box::new([GroupRay::zeroed(); GROUP]),
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

    /// Puts the rays of a packet that wait into the groups of their octants, none of which is full.
    #[inline(always)]
    pub(crate) fn admit<L: Eight, B: BlockSource>(groups: &mut [Self; 8], packet: &Packet) {
        let inverse: [L; 3] = unroll!(k in 0..3 => L::load(&packet.inverse[k]));
        let [near, far] = if B::IS_WIDE { [packet.origins::<L>(); 2] } else { packet.near_far::<L>() };
        let zero = L::splat(0.0);
        let index = unroll!(lane in 0..8 => packet.first + lane);
        let [x, y, z] = inverse;
        let head = L::transpose([x, y, z, near[0], near[1], near[2], far[0], far[1]]);
        let tail = L::transpose([
            far[2],
            L::load(&packet.t_min),
            L::load(&packet.t_max),
            zero,
            zero,
            L::load(bytemuck::cast_ref(&[NONE; 8])),
            L::load(bytemuck::cast_ref(&index)),
            L::load(bytemuck::cast_ref(&packet.main_axis)),
        ]);
        let [a, b, c, d, e, f]: [L; 6] = [
            L::load(&packet.origin[0]),
            L::load(&packet.origin[1]),
            L::load(&packet.origin[2]),
            L::load(&packet.slope[0]),
            L::load(&packet.slope[1]),
            L::load(&packet.slope[2]),
        ];
        let shears = L::transpose([a, b, c, d, e, f, zero, zero]);
        let rays: [[[f32; 8]; 2]; 8] = unroll!(lane in 0..8 => [head[lane].to_array(), tail[lane].to_array()]);
        let shears: [[f32; 8]; 8] = unroll!(lane in 0..8 => shears[lane].to_array());
        for lane in 0..8 {
            if packet.waiting() >> lane & 1 == 1 {
                let group = &mut groups[packet.neg[lane] as usize & 7];
                let at = group.len % GROUP;
                group.rays[at] = bytemuck::cast(rays[lane]);
                group.shears[at] = shears[lane];
                group.clocks[at] = packet.clocks.get(lane);
                group.len = at + 1;
            }
        }
    }

    /// Which boxes of a node each ray of a list meets: a byte a ray, with a bit a lane, eight rays a number. And which any
    /// meets: a mask of places in the rays' order.
    #[inline(always)]
    pub(crate) fn boxes_hit<L: Eight, B: BlockSource>(
        &self,
        (blocks, number): (&B, u32),
        node: &BvhNode,
        order: L::Order,
        neg: u32,
        list: &[[u32; 8]],
        len: usize,
    ) -> ([u64; EIGHTS], u32) {
        let boxes = NearFarBoxes::<L>::new(node, order, neg);
        let mut met = [0; EIGHTS];
        let mut union = 0;
        let mut left = len;
        for (rays, met) in list.iter().zip(&mut met) {
            let mut shift = 0;
            for ray in &rays[..left.min(8)] {
                let ray = &self.rays[*ray as usize % GROUP];
                let slabs: [[L; 3]; 3] = [
                    unroll!(k in 0..3 => L::splat(ray.inverse[k])),
                    unroll!(k in 0..3 => L::splat(ray.near[k])),
                    unroll!(k in 0..3 => L::splat(ray.far[k])),
                ];
                let slabs = if B::IS_WIDE {
                    let [inverse, ..] = slabs;
                    let own = blocks.slabs(number, &Slabs { inverse, lower: inverse, upper: inverse }, ray.near);
                    let [near, far] = own.near_far();
                    [own.inverse, near, far]
                } else {
                    slabs
                };
                *met |= u64::from(boxes.hit_by(&slabs, L::splat(ray.t_min), L::splat(ray.t)).to_bits()) << shift;
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

    /// Tests a block's triangles against a ray, by its place in the group.
    #[inline(always)]
    pub(crate) fn test<L: Eight, Q: Query>(&mut self, block: &Block, at: usize) {
        let (ray, shear) = (&mut self.rays[at % GROUP], &self.shears[at % GROUP]);
        if Q::ANY && ray.primitive != NONE {
            return;
        }
        let mut nearest = ray.nearest();
        let main_axis = ray.main_axis;
        let sheared = move || {
            let [x, y, z, a, b, c, ..] = *shear;
            (Shear { origin: [x, y, z], slope: [a, b, c] }, PERMUTATIONS[main_axis as usize % 3])
        };
        test_block::<L, Q>(block, sheared(), sheared, &mut nearest);
        (ray.t, ray.u, ray.v, ray.primitive) = (nearest.t, nearest.u, nearest.v, nearest.primitive);
        if Q::ANY && nearest.is_hit() {
            // No box is entered before it, so the ray is dropped from here on.
            ray.t = f32::NEG_INFINITY;
        }
    }

    /// Answers all rays, and forgets them.
    #[inline(always)]
    pub(crate) fn answer<Q: Query>(&mut self, answers: &mut [Q::Answer]) {
        for (ray, clock) in self.rays[..self.len].iter().zip(&*self.clocks) {
            answers[ray.index as usize] = Q::answer(clock, &ray.nearest());
        }
        self.len = 0;
    }
}

impl GroupRay {
    #[inline(always)]
    fn nearest(&self) -> Nearest {
        let Self { t_min, t, u, v, primitive, .. } = *self;
        Nearest { t_min, t, u, v, primitive }
    }
}
