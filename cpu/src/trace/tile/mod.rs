//! `Tile`: 64 rays that go much the same way, traced together: they share each node and each triangle.
//!
//! ```text
//! beam = four planes that hold all rays; each packet of eight has such planes as well
//! descend the BVH with the beam, nearest child first:
//!     a node:  its children that the beam may meet, before the farthest hit that any ray still waits for
//!     a block: each triangle that the beam may meet -> each packet whose planes may meet it -> eight rays
//! more than 24 triangles were tested: the rays share little, so from here on know which of them meet each box
//!     a node:  its children that some ray meets; with each waits the mask of these rays
//!     a block: by rays (eight triangles at once against each) or by triangles, whichever is cheaper
//! more than 30 tests a ray: give up, and leave the rays to other ways
//! ```
//! What a tile skips, it skips by bounds that each of its rays keeps: so it gives what each ray alone gives. The planes are
//! described in `beam`, with their source.

mod beam;
mod cull;
mod hits;
mod near;
mod range;

use leafwalk_core::lanes::{Bits as _, Mask as _};
use leafwalk_core::layout::{BLOCK_WIDTH, Block, BvhNode, NONE};
use leafwalk_core::triangle::{PERMUTATIONS, Shear, Sheared};
use leafwalk_core::unroll;

use super::bvh::node::{distances, test_block};
use super::bvh::stack::{END, TileStack, in_order};
use super::bvh::{BlockSource, Bvh, ROOT};
use super::packet::{PACKETS, Packet};
use super::query::Query;
use super::stream::column;
use crate::lanes::Eight;
use beam::{BEAM_MARGIN, Base, Beam, BoxTest};
use cull::RayCull;
use hits::TileHits;
use near::{EarliestEntry, along, along_from};

/// Rays of a tile.
const RAYS: usize = 8 * PACKETS;
/// Triangles tested from which on it is worth while to know which rays meet a box.
const BEAM_TESTS: usize = 24;
/// Tests above which rays are traced faster one by one: about as many as that takes.
const MOST_TESTS: usize = 30 * RAYS;
/// Up to this many rays are tested one by one against eight boxes, more of them eight by eight against one.
const FEW: u32 = 6;
/// About as many instructions as it takes to test a ray against a block.
const RAY_COST: u32 = 90;
/// About as many instructions as it takes to test a triangle against a tile: once, and for each packet.
const TRIANGLE_COST: u32 = 45;
const PACKET_COST: u32 = 80;

/// How tiles are traced: tests may spoil it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tiling {
    /// How far outside its planes a beam still looks, in lattice steps; in wide octrees it scales with [`BEAM_MARGIN`].
    pub(crate) beam_margin: f32,
    /// Makes a tile of every run, however short it is, and however many tiles gave up.
    pub(crate) takes_every_run: bool,
}

impl Tiling {
    pub(crate) const STANDARD: Self = Self { beam_margin: BEAM_MARGIN, takes_every_run: false };
}

/// A tile under way.
pub(crate) struct Tile<'a, L: Eight> {
    packets: &'a [Packet; PACKETS],
    /// The octant of all rays.
    neg: u32,
    order: L::Order,
    /// The axes in the order of the rays' shears, the main one last.
    axes: [usize; 3],
    boxes: BoxTest<L>,
    /// The beams of the packets, a packet a lane.
    of_packets: Beam<L>,
    /// The beam of all rays, the same in every lane.
    of_all: Beam<L>,
    entry: EarliestEntry<L>,
    /// Packets with rays that are not done, a bit each.
    asking: u32,
    /// Where the planes of a wide octree count from.
    base: Base<L>,
    hits: TileHits,
    /// The farthest t' that counts for any ray.
    last: f32,
    /// Triangles that were tested against packets, and rays against blocks, so far.
    tests: usize,
}

impl<'a, L: Eight> Tile<'a, L> {
    /// A tile of uniform packets that go with each other, given where the root's corner is; `None` where their rays have too little in common.
    #[inline(always)]
    pub(crate) fn new<B: BlockSource>(
        packets: &'a [Packet; PACKETS],
        corner: [f32; 3],
        tiling: Tiling,
    ) -> Option<Self> {
        let (neg, main_axis) = (packets[0].neg[0], packets[0].main_axis[0]);
        let axes = PERMUTATIONS[main_axis as usize % 3];
        let is_upper = neg >> axes[2] & 1 == 1;
        let (base, z, ends, margin) = if B::IS_WIDE {
            let base = Base::<L>::first(packets, tiling.beam_margin);
            let z = along_from(packets, corner[axes[2]], &base)?;
            let ends = z.nearer_first();
            (base.reaching(packets, ends.least), z, ends, 0.0)
        } else {
            let z = along::<L>(packets, corner[axes[2]]);
            (Base::anchor(), z, z, tiling.beam_margin)
        };
        let (of_packets, of_all) = Beam::around(packets, ends, &base, margin)?;
        let boxes = BoxTest::new(&of_all, axes, z);
        let (boxes, entry) = if B::IS_WIDE {
            (boxes, EarliestEntry::wide(packets, axes[2], is_upper, &base))
        } else {
            (boxes.in_root(corner), EarliestEntry::new(packets, axes[2], is_upper, corner[axes[2]]))
        };
        let hits = TileHits::new::<L>(packets);
        Some(Self {
            packets,
            neg,
            order: L::order(neg),
            axes,
            boxes,
            base,
            of_packets,
            of_all,
            asking: 0xff,
            entry,
            last: hits.last::<L>(),
            hits,
            tests: 0,
        })
    }

    /// Finds the nearest hit of each ray, or any hit where that is the query. `false`: the tile gave up, because its rays
    /// have too little in common for triangles as small as these.
    #[inline(always)]
    pub(crate) fn trace<B: BlockSource, Q: Query>(&mut self, bvh: &Bvh<'_, B>, waiting: &mut TileStack) -> bool {
        waiting.stack.clear();
        let mut child = ROOT;
        let mut room = None;
        while self.tests < BEAM_TESTS {
            if let Some(node) = bvh.node(child) {
                let (first, met) = self.boxes_hit(&bvh.blocks, child, node);
                if met != 0 {
                    child = waiting.stack.enter(node, self.neg, first, met);
                    continue;
                }
            } else if let Some(block) = bvh.block(child, &mut room) {
                self.test_triangles::<B, Q>(block, self.may_hit::<B>(block), self.asking);
            }
            child = waiting.stack.pop(self.last);
            if child == END {
                return true;
            }
        }
        waiting.set_all_rays(u64::MAX);
        let cull = RayCull::<L>::new::<B>(self.packets, self.neg);
        let mut rays = u64::MAX;
        while self.tests < MOST_TESTS {
            if let Some(node) = bvh.node(child) {
                let first = self.first(&bvh.blocks, child, node);
                let (met, each) = if rays.count_ones() > FEW {
                    let (_, met) = self.boxes_hit(&bvh.blocks, child, node);
                    cull.by_rays((&bvh.blocks, child), &self.hits, node, in_order::<L>(self.neg, met), rays)
                } else {
                    cull.by_boxes((&bvh.blocks, child), &self.hits, node, rays)
                };
                if met != 0 {
                    rays = each[met.trailing_zeros() as usize & 7];
                    waiting.set_rays(met, &each);
                    child = waiting.stack.enter_in_order(node, self.neg, first, met);
                    continue;
                }
            } else if let Some(block) = bvh.block(child, &mut room) {
                self.test_block::<B, Q>(block, rays);
            }
            child = waiting.stack.pop(self.last);
            if child == END {
                return true;
            }
            rays = waiting.rays();
        }
        false
    }

    /// The boxes of a node that rays may meet, a bit a lane, and the earliest t' at which they do.
    #[inline(always)]
    fn boxes_hit<B: BlockSource>(&self, blocks: &B, number: u32, node: &BvhNode) -> (L, u32) {
        let first = self.first(blocks, number, node);
        let may_hit = match blocks.lattice(number) {
            None => self.boxes.may_hit(node, self.order),
            Some(lattice) => {
                let (corner, step, margin) = self.base.lattice(lattice, self.axes);
                self.boxes.in_lattice(corner, step, margin).may_hit(node, self.order)
            }
        };
        (first, (may_hit & first.at_most(L::splat(self.last))).to_bits())
    }

    /// The earliest t' at which rays may meet the boxes of a node.
    #[inline(always)]
    fn first<B: BlockSource>(&self, blocks: &B, number: u32, node: &BvhNode) -> L {
        match blocks.lattice(number) {
            None => self.entry.of(node, self.order),
            Some(lattice) => {
                let (corner, step, margin) = self.base.lattice(lattice, self.axes);
                self.entry.in_lattice(corner, step, margin).of(node, self.order)
            }
        }
    }

    /// Lanes whose triangle may be hit by a ray of a beam.
    #[inline(always)]
    fn meets<B: BlockSource>(&self, beam: &Beam<L>, corners: &[[L; 3]; 3]) -> u32 {
        if B::IS_WIDE {
            let (corners, margin) = self.base.corners(corners);
            return beam.may_hit(&corners, Some(margin)).to_bits();
        }
        beam.may_hit(corners, None).to_bits()
    }

    /// The triangles of a block that rays may hit, a bit a lane.
    #[inline(always)]
    fn may_hit<B: BlockSource>(&self, block: &Block) -> u32 {
        let corners: [[L; 3]; 3] =
            unroll!(c in 0..3 => unroll!(k in 0..3 => L::load(&block.vertices[c][self.axes[k]])));
        self.meets::<B>(&self.of_all, &corners)
    }

    /// Answers the rays of a tile that was traced; those beyond the answers are repetitions.
    #[inline(always)]
    pub(crate) fn answer<Q: Query>(&self, answers: &mut [Q::Answer]) {
        for (packet, answers) in answers.chunks_mut(8).enumerate() {
            let eight = Q::answers(&self.packets[packet].clocks, &self.hits.packet::<L>(packet));
            match <&mut [_; 8]>::try_from(&mut *answers) {
                Ok(answers) => *answers = eight,
                Err(_) => answers.copy_from_slice(&eight[..answers.len()]),
            }
        }
    }

    /// Tests the triangles of a block against rays, in the cheaper of two ways.
    #[inline(always)]
    fn test_block<B: BlockSource, Q: Query>(&mut self, block: &Block, rays: u64) {
        let triangles = self.may_hit::<B>(block);
        let packets = packets(rays);
        let by_triangles = triangles.count_ones() * (TRIANGLE_COST + PACKET_COST * packets.count_ones());
        if rays.count_ones() * RAY_COST < by_triangles {
            self.test_rays::<Q>(block, rays);
        } else {
            self.test_triangles::<B, Q>(block, triangles, packets);
        }
    }

    /// Tests eight triangles against each of some rays.
    #[inline(always)]
    fn test_rays<Q: Query>(&mut self, block: &Block, mut rays: u64) {
        let mut is_hit = false;
        while rays != 0 {
            let ray = rays.trailing_zeros() as usize;
            rays &= rays - 1;
            let (packet, lane) = (ray / 8 % PACKETS, ray % 8);
            let ray = &self.packets[packet];
            let mut nearest = self.hits.ray(packet, lane);
            let before = nearest.primitive;
            self.tests += 1;
            test_block::<L, Q>(block, (ray.shear_of(lane).0, self.axes), move || ray.shear_of(lane % 8), &mut nearest);
            if nearest.primitive != before {
                if Q::ANY {
                    nearest.finish();
                }
                is_hit = true;
                self.hits.set_ray(packet, lane, &nearest);
            }
        }
        if is_hit {
            self.update::<Q>();
        }
    }

    /// Tests some triangles against packets that they may be hit by.
    #[inline(always)]
    fn test_triangles<B: BlockSource, Q: Query>(&mut self, block: &Block, mut triangles: u32, packets: u32) {
        // Copies: behind the call that short hits take, compilers would read the tile's own again for each triangle.
        let (asking, axes, beams) = (packets & self.asking, self.axes, self.of_packets);
        let mut is_hit = false;
        while triangles != 0 {
            let lane = triangles.trailing_zeros() as usize % BLOCK_WIDTH;
            triangles &= triangles - 1;
            // A vacant lane repeats the first triangle.
            if block.primitives[lane] == NONE {
                continue;
            }
            self.tests += 1;
            let triangle: [[L; 3]; 3] =
                unroll!(c in 0..3 => unroll!(k in 0..3 => L::splat(block.vertices[c][axes[k]][lane])));
            let mut packets = self.meets::<B>(&beams, &triangle) & asking;
            while packets != 0 {
                let packet = packets.trailing_zeros() as usize % PACKETS;
                packets &= packets - 1;
                is_hit |= self.test_packet::<Q>(packet, triangle, block, lane);
            }
        }
        if is_hit {
            self.update::<Q>();
        }
    }

    /// Tests one triangle against eight rays.
    #[inline(always)]
    fn test_packet<Q: Query>(&mut self, packet: usize, triangle: [[L; 3]; 3], block: &Block, lane: usize) -> bool {
        let rays = &self.packets[packet];
        let shear = Shear {
            origin: unroll!(k in 0..3 => L::load(&rays.origin[k])),
            slope: unroll!(k in 0..3 => L::load(&rays.slope[k])),
        };
        let sheared = Sheared::new(&shear, triangle);
        let candidates = sheared.is_candidate();
        if !candidates.any() {
            return false;
        }
        let (accepted, found) = sheared.finish(shear.slope[2]);
        let accepted = accepted & candidates;
        let mut nearest = self.hits.packet::<L>(packet);
        let t = distances::<L, Q>(accepted, &found, [nearest.t_min, nearest.t], move |ray| {
            (rays.shear_of(ray % 8), block, lane)
        });
        nearest.offer(accepted, t, found.u, found.v, L::Bits::splat(block.primitives[lane]));
        if Q::ANY {
            nearest.finish();
        }
        self.hits.set_packet(packet, &nearest);
        accepted.any()
    }

    /// Brings up to date what depends on the hits so far.
    #[inline(always)]
    fn update<Q: Query>(&mut self) {
        self.last = self.hits.last::<L>();
        if Q::ANY {
            self.asking = self.hits.asking::<L>();
        }
    }
}

/// The packets that hold some of a tile's rays, a bit each.
#[inline(always)]
fn packets(rays: u64) -> u32 {
    // Any bit of a byte becomes its highest.
    const LOW: u64 = 0x7f7f_7f7f_7f7f_7f7f;
    column(((rays & LOW) + LOW) | rays, 7)
}
