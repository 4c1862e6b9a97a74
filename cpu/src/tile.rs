//! Rays that go much the same way, traced together: 64 rays share each branch and each triangle.
//!
//! What a tile skips, it skips by bounds that each of its rays keeps: so it gives what each ray alone gives.

use leafwalk_core::lanes::{Bits as _, Mask as _};
use leafwalk_core::layout::{BLOCK_WIDTH, Block, Branch, NONE};
use leafwalk_core::per_axis;
use leafwalk_core::triangle::{PERMUTATIONS, Shear, Sheared};

use crate::beam::{BEAM_MARGIN, Beam, BoxTest};
use crate::entry::{Entry, along};
use crate::found::Found;
use crate::hierarchy::{Hierarchy, ROOT, Source};
use crate::lanes::Eight;
use crate::node::test_block;
use crate::prepare::{PACKETS, Prepared};
use crate::question::Question;
use crate::sieve::Sieve;
use crate::stack::{END, Stack, in_order};
use crate::stream::column;

/// Rays a tile.
pub(crate) const RAYS: usize = 8 * PACKETS;
/// Triangles of which a tile remembers that it has tested them: a power of two.
const MAILBOXES: usize = 64;
/// Triangles tested above which rays share so little that it is worth to know which of them meet a box.
const SIFTED: usize = 24;
/// Tests above which rays had better be traced one by one: about what that takes.
const PATIENCE: usize = 30 * RAYS;
/// Rays that are sifted one by one at most.
const FEW: u32 = 6;
/// What it takes to test a ray against a block, and a triangle against a tile, once and a packet: about as many
/// instructions.
const RAY_COST: u32 = 90;
const TRIANGLE_COST: u32 = 45;
const PACKET_COST: u32 = 80;

/// Packets: all, also those without rays that still ask.
const ALL: u32 = u32::MAX;

/// How tiles are traced: tests may spoil it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tiling {
    /// How far outside its planes a beam still looks.
    pub(crate) beam_margin: f32,
    /// Takes a triangle for tested when only some of a tile's rays were tested against it.
    pub(crate) forgets_rays: bool,
}

impl Tiling {
    pub(crate) const STANDARD: Self = Self { beam_margin: BEAM_MARGIN, forgets_rays: false };
}

/// A tile under way.
pub(crate) struct Tile<'a, L: Eight> {
    prepared: &'a [Prepared; PACKETS],
    neg: u32,
    order: L::Order,
    axes: [usize; 3],
    boxes: BoxTest<L>,
    /// A packet a lane.
    of_packets: Beam<L>,
    of_all: Beam<L>,
    entry: Entry<L>,
    /// Packets with rays that still ask, a bit each.
    asking: u32,
    found: Found,
    /// The farthest t' that any ray still asks for.
    last: f32,
    mailboxes: [u32; MAILBOXES],
    forgets_rays: bool,
    /// Triangles that were tested against packets, and rays against blocks, so far.
    tests: usize,
}

impl<'a, L: Eight> Tile<'a, L> {
    /// A tile of 64 rays, or `None` where they have too little in common.
    #[inline(always)]
    pub(crate) fn new(prepared: &'a [Prepared; PACKETS], tiling: Tiling) -> Option<Self> {
        let (neg, main_axis) = (prepared[0].neg[0], prepared[0].main_axis[0]);
        for rays in prepared {
            if rays.waiting != 0xff || rays.neg != [neg; 8] || rays.main_axis != [main_axis; 8] {
                return None;
            }
        }
        let axes = PERMUTATIONS[main_axis as usize % 3];
        let z = along::<L>(prepared);
        let (of_packets, of_all) = Beam::around(prepared, z, tiling.beam_margin)?;
        let found = Found::new::<L>(prepared);
        Some(Self {
            prepared,
            neg,
            order: L::order(neg),
            axes,
            boxes: BoxTest::new(&of_all, axes, z),
            of_packets,
            of_all,
            asking: 0xff,
            entry: Entry::new(prepared, axes[2], neg >> axes[2] & 1 == 1),
            last: found.last::<L>(),
            found,
            mailboxes: [NONE; MAILBOXES],
            forgets_rays: tiling.forgets_rays,
            tests: 0,
        })
    }

    /// Finds the nearest hit of each ray; with `ANY`, some hit. `false`: gave up, because the rays have too little in
    /// common for triangles as small as these.
    #[inline(always)]
    pub(crate) fn trace<B: Source, const ANY: bool>(
        &mut self,
        hierarchy: &Hierarchy<'_, B>,
        stack: &mut Stack,
    ) -> bool {
        stack.clear();
        let mut child = ROOT;
        let mut room = None;
        while self.tests < SIFTED {
            if let Some(branch) = hierarchy.branch(child) {
                let (first, met) = self.meet(branch);
                if met != 0 {
                    child = stack.enter(branch, self.neg, first, met);
                    continue;
                }
            } else if let Some(block) = hierarchy.block(child, &mut room) {
                self.test_triangles::<ANY>(block, self.hit_by_all(block), ALL);
            }
            child = stack.pop(self.last);
            if child == END {
                return true;
            }
        }
        stack.tell_all(u64::MAX);
        let sieve = Sieve::<L>::new(self.prepared, self.neg);
        let mut rays = u64::MAX;
        while self.tests < PATIENCE {
            if let Some(branch) = hierarchy.branch(child) {
                let first = self.entry.of(branch, self.order);
                let (met, each) = if rays.count_ones() > FEW {
                    let (_, met) = self.meet(branch);
                    sieve.sift(&self.found, branch, in_order::<L>(self.neg, met), rays)
                } else {
                    sieve.sift_few(&self.found, branch, rays)
                };
                if met != 0 {
                    rays = each[met.trailing_zeros() as usize & 7];
                    stack.tell(met, &each);
                    child = stack.enter_in_order(branch, self.neg, first, met);
                    continue;
                }
            } else if let Some(block) = hierarchy.block(child, &mut room) {
                self.test_block::<ANY>(block, rays);
            }
            child = stack.pop(self.last);
            if child == END {
                return true;
            }
            rays = stack.rays();
        }
        false
    }

    /// Lanes of a branch that rays may meet, and the earliest t' at which they do.
    #[inline(always)]
    fn meet(&self, branch: &Branch) -> (L, u32) {
        let first = self.entry.of(branch, self.order);
        (first, (self.boxes.may_meet(branch, self.order) & first.at_most(L::splat(self.last))).to_bits())
    }

    /// Triangles of a block that rays may hit.
    #[inline(always)]
    fn hit_by_all(&self, block: &Block) -> u32 {
        let corners: [[L; 3]; 3] = per_axis!(c => per_axis!(k => L::load(&block.vertices[c][self.axes[k]])));
        self.of_all.may_hit(&corners).to_bits()
    }

    /// Answers its rays, after the trace; those beyond the answers are copies.
    #[inline(always)]
    pub(crate) fn answer<Q: Question>(&self, answers: &mut [Q::Answer]) {
        for (packet, answers) in answers.chunks_mut(8).enumerate() {
            let eight = Q::answers(&self.prepared[packet].clocks, &self.found.packet::<L>(packet));
            match <&mut [_; 8]>::try_from(&mut *answers) {
                Ok(answers) => *answers = eight,
                Err(_) => answers.copy_from_slice(&eight[..answers.len()]),
            }
        }
    }

    /// Tests the triangles of a block against rays, in the cheaper of two ways.
    #[inline(always)]
    fn test_block<const ANY: bool>(&mut self, block: &Block, rays: u64) {
        let triangles = self.hit_by_all(block);
        let packets = packets(rays);
        let by_triangles = triangles.count_ones() * (TRIANGLE_COST + PACKET_COST * packets.count_ones());
        if rays.count_ones() * RAY_COST < by_triangles {
            self.test_rays::<ANY>(block, rays);
        } else {
            self.test_triangles::<ANY>(block, triangles, packets);
        }
    }

    /// Tests eight triangles against each of some rays.
    #[inline(always)]
    fn test_rays<const ANY: bool>(&mut self, block: &Block, mut rays: u64) {
        let mut is_hit = false;
        while rays != 0 {
            let ray = rays.trailing_zeros() as usize;
            rays &= rays - 1;
            let (packet, lane) = (ray / 8 % PACKETS, ray % 8);
            let ray = &self.prepared[packet];
            let shear = Shear {
                origin: per_axis!(k => L::splat(ray.origin[k][lane])),
                slope: per_axis!(k => L::splat(ray.slope[k][lane])),
            };
            let mut nearest = self.found.ray(packet, lane);
            let before = nearest.primitive;
            self.tests += 1;
            test_block(block, &shear, self.axes, &mut nearest);
            if nearest.primitive != before {
                if ANY {
                    nearest.rest();
                }
                is_hit = true;
                self.found.set_ray(packet, lane, &nearest);
            }
        }
        if is_hit {
            self.update::<ANY>();
        }
    }

    /// Tests some triangles against packets that they may be hit by.
    #[inline(always)]
    fn test_triangles<const ANY: bool>(&mut self, block: &Block, mut triangles: u32, packets: u32) {
        let asking = packets & self.asking;
        let mut is_hit = false;
        while triangles != 0 {
            let lane = triangles.trailing_zeros() as usize % BLOCK_WIDTH;
            triangles &= triangles - 1;
            let primitive = block.primitives[lane];
            let mailbox = &mut self.mailboxes[primitive as usize % MAILBOXES];
            // Vacant lanes look like triangles that were tested.
            if *mailbox == primitive || primitive == NONE {
                continue;
            }
            // Only what all rays were tested against need not be tested again.
            if packets == ALL || self.forgets_rays {
                *mailbox = primitive;
            }
            self.tests += 1;
            let triangle: [[L; 3]; 3] = per_axis!(c => per_axis!(k => L::splat(block.vertices[c][self.axes[k]][lane])));
            let mut packets = self.of_packets.may_hit(&triangle).to_bits() & asking;
            while packets != 0 {
                let packet = packets.trailing_zeros() as usize % PACKETS;
                packets &= packets - 1;
                is_hit |= self.test_packet::<ANY>(packet, triangle, primitive);
            }
        }
        if is_hit {
            self.update::<ANY>();
        }
    }

    /// Tests one triangle against eight rays.
    #[inline(always)]
    fn test_packet<const ANY: bool>(&mut self, packet: usize, triangle: [[L; 3]; 3], primitive: u32) -> bool {
        let rays = &self.prepared[packet];
        let shear =
            Shear { origin: per_axis!(k => L::load(&rays.origin[k])), slope: per_axis!(k => L::load(&rays.slope[k])) };
        let sheared = Sheared::new(&shear, triangle);
        let candidates = sheared.is_candidate();
        if !candidates.any() {
            return false;
        }
        let (accepted, found) = sheared.finish(&shear);
        let accepted = accepted & candidates;
        let mut nearest = self.found.packet::<L>(packet);
        nearest.offer(accepted, found.t, found.u, found.v, L::Bits::splat(primitive));
        if ANY {
            nearest.rest();
        }
        self.found.set_packet(packet, &nearest);
        accepted.any()
    }

    /// After hits.
    #[inline(always)]
    fn update<const ANY: bool>(&mut self) {
        self.last = self.found.last::<L>();
        if ANY {
            self.asking = self.found.asking::<L>();
        }
    }
}

/// Packets that hold some of a tile's rays.
#[inline(always)]
fn packets(rays: u64) -> u32 {
    // Any bit of a byte becomes its highest.
    const LOW: u64 = 0x7f7f_7f7f_7f7f_7f7f;
    column(((rays & LOW) + LOW) | rays, 7)
}
