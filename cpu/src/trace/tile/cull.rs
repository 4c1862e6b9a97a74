//! `RayCull`: which rays of a tile meet which boxes, for tiles whose rays share too little to be taken for one beam.

use leafwalk_core::lanes::Mask as _;
use leafwalk_core::layout::{BVH_WIDTH, BvhNode};
use leafwalk_core::slabs::Slabs;
use leafwalk_core::unroll;

use super::hits::TileHits;
use crate::lanes::Eight;
use crate::trace::bvh::BlockSource;
use crate::trace::bvh::node::NearFarBoxes;
use crate::trace::bvh::stack::in_order;
use crate::trace::packet::{PACKETS, Packet, Row};

/// Which children of a node are met, a mask of places in the rays' order, and by which rays each, a bit a ray.
pub(crate) type ChildrenMet = (u32, [u64; BVH_WIDTH]);

/// What the boxes of nodes are tested with.
pub(crate) struct RayCull<L: Eight> {
    neg: u32,
    order: L::Order,
    /// See [`Packet::slabs`]; in wide octrees the origins, axis by axis, stand in the place of what sides add.
    slabs: [[[Row; 3]; 3]; PACKETS],
}

impl<L: Eight> RayCull<L> {
    /// The tests of the rays of a tile, which are of one octant.
    #[inline(always)]
    pub(crate) fn new<B: BlockSource>(packets: &[Packet; PACKETS], neg: u32) -> Self {
        let slabs = unroll!(packet in 0..8 => {
            let packet = &packets[packet];
            if B::IS_WIDE {
                let origins = packet.origins::<L>();
                let origins = unroll!(k in 0..3 => origins[k].to_array());
                [packet.inverse, origins, origins]
            } else {
                packet.slabs(neg)
            }
        });
        Self { neg, order: L::order(neg), slabs }
    }

    #[inline(always)]
    fn packet(&self, packet: usize) -> [[L; 3]; 3] {
        unroll!(i in 0..3 => unroll!(k in 0..3 => L::load(&self.slabs[packet][i][k])))
    }

    /// What a node's boxes are tested with, of eight rays, or of one.
    #[inline(always)]
    fn slabs_at<B: BlockSource>(&self, blocks: &B, number: u32, slabs: [[L; 3]; 3]) -> [[L; 3]; 3] {
        if !B::IS_WIDE {
            return slabs;
        }
        let [inverse, origin, _] = slabs;
        let own = blocks.slabs_of(number, &Slabs { inverse, lower: inverse, upper: inverse }, origin);
        let [near, far] = own.near_far();
        [own.inverse, near, far]
    }

    /// The children that some of `rays` meet, among those that are `met`, a mask of places: eight rays at a time against
    /// one box.
    #[inline(always)]
    pub(crate) fn by_rays<B: BlockSource>(
        &self,
        (blocks, number): (&B, u32),
        hits: &TileHits,
        node: &BvhNode,
        mut met: u32,
        rays: u64,
    ) -> ChildrenMet {
        let mut each = [0; BVH_WIDTH];
        let mut kept = 0;
        let own = B::IS_WIDE.then(|| unroll!(packet in 0..8 => self.slabs_at(blocks, number, self.packet(packet))));
        while met != 0 {
            let place = met.trailing_zeros() & 7;
            met &= met - 1;
            let child = NearFarBoxes::<L>::splat(node, (place ^ self.neg) as usize & 7, self.neg);
            let mut by = 0;
            for packet in 0..PACKETS {
                if rays >> (8 * packet) & 0xff != 0 {
                    let nearest = hits.packet::<L>(packet);
                    let slabs: [[L; 3]; 3] = match &own {
                        Some(own) => own[packet],
                        None => self.packet(packet),
                    };
                    by |= u64::from(child.hit_by(&slabs, nearest.t_min, nearest.t).to_bits()) << (8 * packet);
                }
            }
            each[place as usize] = rays & by;
            kept |= u32::from(rays & by != 0) << place;
        }
        (kept, each)
    }

    /// The children that some of `rays` meet, among all: eight boxes at a time against one ray, which suits few rays.
    #[inline(always)]
    pub(crate) fn by_boxes<B: BlockSource>(
        &self,
        (blocks, number): (&B, u32),
        hits: &TileHits,
        node: &BvhNode,
        mut rays: u64,
    ) -> ChildrenMet {
        let boxes = NearFarBoxes::<L>::new(node, self.order, self.neg);
        let mut each = [0; BVH_WIDTH];
        let mut kept = 0;
        while rays != 0 {
            let ray = rays.trailing_zeros() as usize;
            rays &= rays - 1;
            let (packet, lane) = (ray / 8 % PACKETS, ray % 8);
            let nearest = hits.ray(packet, lane);
            let slabs: [[L; 3]; 3] =
                unroll!(i in 0..3 => unroll!(k in 0..3 => L::splat(self.slabs[packet][i][k][lane])));
            let slabs = self.slabs_at(blocks, number, slabs);
            let met = boxes.hit_by(&slabs, L::splat(nearest.t_min), L::splat(nearest.t)).to_bits();
            let mut met = in_order::<L>(self.neg, met);
            kept |= met;
            while met != 0 {
                each[met.trailing_zeros() as usize & 7] |= 1 << ray;
                met &= met - 1;
            }
        }
        (kept, each)
    }
}
