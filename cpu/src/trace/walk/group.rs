//! `Group`: eight rays, each in its own cell, and what a round does with them.

use leafwalk_core::contract::PADDING;
use leafwalk_core::lanes::{Bits as _, Mask as _};
use leafwalk_core::layout::{Block, Child, LINK_NONE, NONE};
use leafwalk_core::step::{Cell, Slab, Step as _, cross, link_kind, neighbour};
use leafwalk_core::{Leaf, Nearest, Parts, unroll};

use super::{Pending, Visit};
use crate::lanes::Eight;
use crate::trace::bvh::BlockSource;
use crate::trace::bvh::node::{clip_boxes, test_block};
use crate::trace::bvh::stack::in_order;
use crate::trace::packet::{Packet, Row, integers, load_integers};
use crate::trace::query::Query;

/// Eight rays on their way. A lane without a ray stands in record 0, the root, from where no step leads on.
#[repr(align(64))]
pub(super) struct Group {
    rays: Packet,
    /// The places of the rays in the batch.
    index: [u32; 8],
    /// t' where each walk may end: see [`leafwalk_core::start::Span`].
    end: Row,
    /// The nearest hits so far: see [`Nearest`].
    t: Row,
    u: Row,
    v: Row,
    primitive: [u32; 8],
    /// The cells that the rays are in, and the numbers of their records.
    record: [u32; 8],
    corner: [[u32; 8]; 3],
    size: [u32; 8],
    /// The first words of the records.
    head: [u32; 8],
    /// The payloads of the leaves.
    payload: [u32; 8],
    /// The lanes that have a ray.
    busy: u32,
    /// The lanes whose leaves list anything.
    listing: u32,
}

impl Group {
    /// A group without rays.
    pub(super) const EMPTY: Self = Self {
        rays: Packet::EMPTY,
        index: [0; 8],
        end: [0.0; 8],
        t: [0.0; 8],
        u: [0.0; 8],
        v: [0.0; 8],
        primitive: [NONE; 8],
        record: [0; 8],
        corner: [[0; 8]; 3],
        size: [1; 8],
        head: [0; 8],
        payload: [0; 8],
        busy: 0,
        listing: 0,
    };

    /// A ray of a packet starts in a lane that has none, in the cell of a record.
    #[inline(always)]
    pub(super) fn start(
        &mut self,
        lane: usize,
        packet: &Packet,
        from: usize,
        end: f32,
        (record, Cell { corner, size }): (u32, Cell<f32>),
    ) {
        self.rays.set_ray(lane, packet, from);
        self.index[lane] = packet.first + from as u32;
        (self.end[lane], self.t[lane], self.primitive[lane]) = (end, packet.t_max[from], NONE);
        (self.record[lane], self.size[lane]) = (record, size);
        for k in 0..3 {
            self.corner[k][lane] = corner[k];
        }
        self.busy |= 1 << lane;
    }

    /// Looks at the records of the cells, and asks for what their leaves list.
    #[inline(always)]
    pub(super) fn look<L: Eight>(&mut self, parts: &Parts<'_>) {
        if self.busy == 0 {
            self.listing = 0;
            return;
        }
        let mut listing = 0;
        for lane in 0..8 {
            let record = &parts.records[self.record[lane] as usize];
            (self.head[lane], self.payload[lane]) = (record.head, record.offset);
            listing |= u32::from(record.head().t_count() != 0) << lane;
        }
        self.listing = listing & self.busy;
        let mut listing = self.listing;
        while listing != 0 {
            let lane = listing.trailing_zeros() as usize & 7;
            listing &= listing - 1;
            if let Some(payload) = parts.payloads.get(self.payload[lane] as usize) {
                L::prefetch(payload);
            }
        }
    }

    /// Descends from what the leaves list to the blocks whose boxes the rays meet, and asks for them.
    ///
    /// Below an entry only that part of the ray counts that lies in the entry's box, which is cut to the leaf's cell: what it
    /// meets outside belongs to other leaves.
    #[inline(always)]
    pub(super) fn meet<L: Eight, B: BlockSource>(
        &self,
        parts: &Parts<'_>,
        blocks: &B,
        first_lane: u32,
        pending: &mut Vec<Pending>,
        visits: &mut Vec<Visit>,
    ) {
        let mut listing = self.listing;
        while listing != 0 {
            let lane = listing.trailing_zeros() as usize & 7;
            listing &= listing - 1;
            let (slabs, origin) = (self.rays.slabs_of::<L>(lane), self.rays.origin_of(lane));
            let neg = self.rays.neg[lane];
            let order = L::order(neg);
            let Some(mut node) = parts.payloads.get(self.payload[lane] as usize) else { continue };
            let (mut part, mut is_payload) = ((self.rays.t_min[lane], self.t[lane]), true);
            let mut own = slabs;
            loop {
                let (first, last) = clip_boxes(&own, order, node, part);
                let mut met = in_order::<L>(neg, first.at_most(last).to_bits());
                let (first, last) = (first.to_array(), last.to_array());
                let waiting = pending.len();
                while met != 0 {
                    let place = met.trailing_zeros();
                    met &= met - 1;
                    let slot = (place ^ neg) as usize & 7;
                    let at = if L::IS_BY_SLOT { slot } else { place as usize & 7 };
                    match Child::from_word(node.children[slot]) {
                        Child::Block(block) => {
                            blocks.prefetch::<L>(block as usize);
                            visits.push(Visit { lane: first_lane + lane as u32, block, first: first[at] });
                        }
                        Child::Node(node) => {
                            let part = if is_payload { (first[at], last[at]) } else { part };
                            pending.push(Pending { node, part });
                        }
                        Child::Vacant => {}
                    }
                }
                // The nearest is taken next.
                pending[waiting..].reverse();
                let Some(next) = pending.pop() else { break };
                let Some(below) = parts.bvh.get(next.node as usize) else { break };
                (node, part, is_payload) = (below, next.part, false);
                own = blocks.slabs(next.node, &slabs, origin);
            }
        }
    }

    /// Tests a block's triangles against a ray, unless it has a hit before them.
    #[inline(always)]
    pub(super) fn visit<L: Eight, B: BlockSource, Q: Query>(
        &mut self,
        lane: usize,
        blocks: &B,
        block: u32,
        first: f32,
        room: &mut Option<Block>,
    ) {
        if first > self.t[lane] {
            return;
        }
        let Some(block) = blocks.block(block as usize, room) else { return };
        let mut nearest = self.nearest(lane);
        let rays = &self.rays;
        test_block::<L, Q>(block, rays.shear_of(lane), move || rays.shear_of(lane % 8), &mut nearest);
        if Q::ANY {
            nearest.finish();
        }
        let Nearest { t, u, v, primitive, .. } = nearest;
        (self.t[lane], self.u[lane], self.v[lane], self.primitive[lane]) = (t, u, v, primitive);
    }

    #[inline(always)]
    fn nearest(&self, lane: usize) -> Nearest {
        let (t_min, t, primitive) = (self.rays.t_min[lane], self.t[lane], self.primitive[lane]);
        Nearest { t_min, t, u: self.u[lane], v: self.v[lane], primitive }
    }

    /// Brings the rays into their next cells and asks for the records of these; answers the rays that end, tells the leaves
    /// where they do as far as there is room, and gives their lanes.
    #[inline(always)]
    pub(super) fn step<L: Eight, Q: Query>(
        &mut self,
        parts: &Parts<'_>,
        answers: &mut [Q::Answer],
        ends: &mut [Leaf],
    ) -> u32 {
        if self.busy == 0 {
            return 0;
        }
        let line = self.rays.line::<L>();
        let cell = Cell::<L> {
            corner: unroll!(k in 0..3 => load_integers::<L>(&self.corner[k])),
            size: load_integers::<L>(&self.size),
        };
        let head = load_integers::<L>(&self.head);
        let exit = Slab::exit(&line, &cell);
        let last = L::load(&self.t).min(L::load(&self.end));
        let is_done = (last * exit.speed).less(exit.distance - L::splat(PADDING));
        const { assert!(LINK_NONE == 0) };
        let has_next = !L::below(link_kind::<L>(head, exit.face), L::Bits::splat(1)) & !is_done;
        let faces = integers::<L>(exit.face);
        let next: [u32; 8] = unroll!(lane in 0..8 => {
            neighbour(&parts.records[self.record[lane] as usize], faces[lane])
        });
        let (record, cell) = cross::<L, Slab>(&line, &cell, &exit, head, load_integers::<L>(&next));
        let left_behind = self.record;
        self.record = integers::<L>(record & L::indicator(has_next).spread());
        self.corner = unroll!(k in 0..3 => integers::<L>(cell.corner[k]));
        self.size = integers::<L>(cell.size);
        for lane in 0..8 {
            L::prefetch(&parts.records[self.record[lane] as usize]);
        }
        let ended = self.busy & !has_next.to_bits();
        self.busy &= !ended;
        let mut left = ended;
        while left != 0 {
            let lane = left.trailing_zeros() as usize & 7;
            left &= left - 1;
            let index = self.index[lane] as usize;
            answers[index] = Q::answer(&self.rays.clocks.get(lane), &self.nearest(lane));
            if let Some(end) = ends.get_mut(index) {
                *end = Leaf(left_behind[lane]);
            }
        }
        ended
    }
}
