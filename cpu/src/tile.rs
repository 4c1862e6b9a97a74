//! Rays that go much the same way, traced together: 64 rays share each branch and each triangle.
//!
//! What a tile skips, it skips by bounds that each of its rays keeps: so it gives what each ray alone gives.

use leafwalk_core::lanes::Mask as _;
use leafwalk_core::layout::{BLOCK_WIDTH, BOX_MARGIN, Block, Branch, LATTICE, NONE};
use leafwalk_core::triangle::{PERMUTATIONS, Shear, Sheared};
use leafwalk_core::{Nearest, per_axis};

use crate::beam::{Beam, BoxTest, Range};
use crate::hierarchy::{Hierarchy, ROOT, Source};
use crate::lanes::{Eight, eight_times};
use crate::prepare::{PACKETS, Prepared};
use crate::question::Question;
use crate::stack::{END, Stack};

/// Rays a tile.
pub(crate) const RAYS: usize = 8 * PACKETS;
/// Triangles of which a tile remembers that it has tested them: a power of two.
const MAILBOXES: usize = 64;
/// Triangles tested above which rays had better be traced one by one: about what that takes.
const PATIENCE: usize = 10 * RAYS;
/// Edge of the root in lattice steps.
const STEPS: f32 = LATTICE as f32;

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
    nearest: [Nearest; RAYS],
    /// The farthest t' that any ray still asks for.
    last: f32,
    mailboxes: [u32; MAILBOXES],
    /// Triangles tested so far.
    tests: usize,
}

impl<'a, L: Eight> Tile<'a, L> {
    /// A tile of 64 rays, or `None` where they have too little in common.
    #[inline(always)]
    pub(crate) fn new(prepared: &'a [Prepared; PACKETS], beam_margin: f32) -> Option<Self> {
        let (neg, main_axis) = (prepared[0].neg[0], prepared[0].main_axis[0]);
        for rays in prepared {
            if rays.waiting != 0xff || rays.neg != [neg; 8] || rays.main_axis != [main_axis; 8] {
                return None;
            }
        }
        let axes = PERMUTATIONS[usize::from(main_axis).min(2)];
        let z = along(prepared);
        let (of_packets, of_all) = Beam::around(prepared, z, beam_margin)?;
        let nearest = core::array::from_fn(|ray| {
            let (packet, lane) = (&prepared[ray / 8], ray % 8);
            Nearest { t_min: packet.t_min[lane], t: packet.t_max[lane], u: 0.0, v: 0.0, primitive: NONE }
        });
        Some(Self {
            prepared,
            neg,
            order: L::order(neg),
            axes,
            boxes: BoxTest::new(&of_all, axes, z),
            of_packets,
            of_all,
            entry: Entry::new(prepared, axes[2], neg >> axes[2] & 1 == 1),
            nearest,
            last: Range::of_rows(eight_times!(packet => L::load(&prepared[packet].t_max))).whole().greatest,
            mailboxes: [NONE; MAILBOXES],
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
        loop {
            if let Some(branch) = hierarchy.branch(child) {
                let first = self.entry.of(branch, self.order);
                let met = (self.boxes.may_meet(branch, self.order) & first.at_most(L::splat(self.last))).to_bits();
                if met != 0 {
                    child = stack.enter(branch, self.neg, first, met);
                    continue;
                }
            } else if let Some(block) = hierarchy.block(child, &mut room) {
                self.test_block::<ANY>(block);
                if self.tests > PATIENCE {
                    return false;
                }
            }
            child = stack.pop(self.last);
            if child == END {
                return true;
            }
        }
    }

    /// What was asked of a ray, after the trace.
    #[inline(always)]
    pub(crate) fn answer<Q: Question>(&self, ray: usize) -> Q::Answer {
        Q::answer(&self.prepared[ray / 8].clocks[ray % 8], &self.nearest[ray])
    }

    #[inline(always)]
    fn test_block<const ANY: bool>(&mut self, block: &Block) {
        let corners: [[L; 3]; 3] = per_axis!(c => per_axis!(k => L::load(&block.vertices[c][self.axes[k]])));
        let mut triangles = self.of_all.may_hit(&corners).to_bits();
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
            *mailbox = primitive;
            self.tests += 1;
            let triangle: [[L; 3]; 3] = per_axis!(c => per_axis!(k => L::splat(block.vertices[c][self.axes[k]][lane])));
            let mut packets = self.of_packets.may_hit(&triangle).to_bits();
            while packets != 0 {
                let packet = packets.trailing_zeros() as usize % PACKETS;
                packets &= packets - 1;
                is_hit |= self.test_packet::<ANY>(packet, triangle, primitive);
            }
        }
        if is_hit {
            self.last = self.nearest.iter().map(|nearest| nearest.t).fold(f32::NEG_INFINITY, f32::max);
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
        let mut accepted = (accepted & candidates).to_bits();
        let (t, u, v) = (found.t.to_array(), found.u.to_array(), found.v.to_array());
        let is_hit = accepted != 0;
        while accepted != 0 {
            let lane = accepted.trailing_zeros() as usize & 7;
            accepted &= accepted - 1;
            let nearest = &mut self.nearest[8 * packet + lane];
            nearest.offer(t[lane], u[lane], v[lane], primitive);
            if ANY && nearest.is_hit() {
                // Nothing is nearer: the ray asks for no more.
                nearest.t = f32::NEG_INFINITY;
            }
        }
        is_hit
    }
}

/// Where along axis 2 rays may hit anything: inside the root, between their ends. Never empty.
#[inline(always)]
fn along(prepared: &[Prepared; PACKETS]) -> Range<f32> {
    let (mut least, mut greatest) = (1f32, 0f32);
    for rays in prepared {
        for lane in 0..8 {
            let at = |t: f32| (rays.origin[2][lane] + rays.speed[lane] * t).clamp(0.0, 1.0);
            let (a, b) = (at(rays.t_min[lane]), at(rays.t_max[lane]));
            least = least.min(a.min(b));
            greatest = greatest.max(a.max(b));
        }
    }
    // A lattice step more, which covers the rounding, too.
    Range { least: least - 1.0 / STEPS, greatest: greatest + 1.0 / STEPS }
}

/// The earliest t' at which a tile's rays enter boxes: where the first of them meets their near sides along axis 2.
struct Entry<L> {
    axis: usize,
    /// Upper sides are near.
    is_upper: bool,
    /// In lattice steps, the origin closest to what lies ahead, and the box margin.
    origin: L,
    /// t' a lattice step.
    inverse: Range<L>,
    t_min: L,
}

impl<L: Eight> Entry<L> {
    #[inline(always)]
    fn new(prepared: &[Prepared; PACKETS], axis: usize, is_upper: bool) -> Self {
        let origin = Range::of_rows(eight_times!(packet => L::load(&prepared[packet].origin[2]))).whole();
        let inverse = Range::of_rows(eight_times!(packet => L::load(&prepared[packet].inverse[axis]))).whole();
        let margin = BOX_MARGIN * STEPS;
        let origin = if is_upper { origin.least * STEPS - (1.0 + margin) } else { origin.greatest * STEPS + margin };
        Self {
            axis,
            is_upper,
            origin: L::splat(origin),
            inverse: Range::splat(inverse),
            t_min: L::splat(Range::of_rows(eight_times!(packet => L::load(&prepared[packet].t_min))).whole().least),
        }
    }

    #[inline(always)]
    fn of(&self, branch: &Branch, order: L::Order) -> L {
        let distance = L::from_steps(&branch.sides[self.axis][usize::from(self.is_upper)], order) - self.origin;
        self.t_min.max((distance * self.inverse.least).min(distance * self.inverse.greatest))
    }
}
