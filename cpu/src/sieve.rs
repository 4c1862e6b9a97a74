//! Which rays of a tile meet which boxes: for tiles whose rays share too little to be taken for one.

use leafwalk_core::lanes::Mask as _;
use leafwalk_core::layout::{BRANCH_WIDTH, Branch};
use leafwalk_core::per_axis;

use crate::found::Found;
use crate::lanes::{Eight, eight_times};
use crate::node::Facing;
use crate::prepare::{PACKETS, Prepared, Row};
use crate::stack::in_order;

/// What the boxes of branches are tested with.
pub(crate) struct Sieve<L: Eight> {
    neg: u32,
    order: L::Order,
    /// See [`Prepared::slabs`].
    slabs: [[[Row; 3]; 3]; PACKETS],
}

impl<L: Eight> Sieve<L> {
    /// For rays of one octant.
    #[inline(always)]
    pub(crate) fn new(prepared: &[Prepared; PACKETS], neg: u32) -> Self {
        Self { neg, order: L::order(neg), slabs: eight_times!(packet => prepared[packet].slabs(neg)) }
    }

    /// Of the children of a branch that are `met`, a mask by their places in the rays' order, those that some of `rays`
    /// meet; and of each which, a bit a ray: eight rays against a box.
    #[inline(always)]
    pub(crate) fn sift(&self, found: &Found, branch: &Branch, mut met: u32, rays: u64) -> (u32, [u64; BRANCH_WIDTH]) {
        let mut each = [0; BRANCH_WIDTH];
        let mut kept = 0;
        while met != 0 {
            let place = met.trailing_zeros() & 7;
            met &= met - 1;
            let child = Facing::<L>::splat(branch, (place ^ self.neg) as usize & 7, self.neg);
            let mut by = 0;
            for packet in 0..PACKETS {
                if rays >> (8 * packet) & 0xff != 0 {
                    let nearest = found.packet::<L>(packet);
                    let slabs: [[L; 3]; 3] = per_axis!(i => per_axis!(k => L::load(&self.slabs[packet][i][k])));
                    by |= u64::from(child.met(&slabs, nearest.t_min, nearest.t).to_bits()) << (8 * packet);
                }
            }
            each[place as usize] = rays & by;
            kept |= u32::from(rays & by != 0) << place;
        }
        (kept, each)
    }

    /// The same for few rays, of all children: eight boxes against a ray.
    #[inline(always)]
    pub(crate) fn sift_few(&self, found: &Found, branch: &Branch, mut rays: u64) -> (u32, [u64; BRANCH_WIDTH]) {
        let boxes = Facing::<L>::new(branch, self.order, self.neg);
        let mut each = [0; BRANCH_WIDTH];
        let mut kept = 0;
        while rays != 0 {
            let ray = rays.trailing_zeros() as usize;
            rays &= rays - 1;
            let (packet, lane) = (ray / 8 % PACKETS, ray % 8);
            let nearest = found.ray(packet, lane);
            let slabs: [[L; 3]; 3] = per_axis!(i => per_axis!(k => L::splat(self.slabs[packet][i][k][lane])));
            let met = boxes.met(&slabs, L::splat(nearest.t_min), L::splat(nearest.t)).to_bits();
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
