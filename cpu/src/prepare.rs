//! Eight rays at a time made ready to trace: canonical, with what box and triangle tests want to know of them.

use leafwalk_core::boxes::Slabs;
use leafwalk_core::canonical::Common;
use leafwalk_core::lanes::{Bits, Lanes, Mask as _};
use leafwalk_core::layout::{LATTICE, LatticeBox, SMALLEST};
use leafwalk_core::step::inverse;
use leafwalk_core::triangle::{PERMUTATIONS, Shear, main_axis};
use leafwalk_core::{Clock, Frame, Nearest, Ray, per_axis};

use crate::lanes::{Eight, eight_times};
use crate::ready::Ready;

/// Packets of eight rays that may be traced together.
pub(crate) const PACKETS: usize = 8;

/// Eight numbers in memory.
pub(crate) type Row = [f32; 8];

/// Rays that wait, lane by lane.
pub(crate) struct Prepared {
    pub(crate) inverse: [Row; 3],
    lower: [Row; 3],
    upper: [Row; 3],
    pub(crate) origin: [Row; 3],
    pub(crate) slope: [Row; 3],
    /// Along the main axis, per unit of t'.
    pub(crate) speed: Row,
    pub(crate) t_min: Row,
    pub(crate) t_max: Row,
    pub(crate) clocks: Clocks,
    /// Bit k: the lane's direction component k is negative.
    pub(crate) neg: [u32; 8],
    pub(crate) main_axis: [u32; 8],
    /// Lanes whose rays can hit anything, and still wait.
    pub(crate) waiting: u32,
}

/// Canonical rays, lane by lane.
struct Canonical<L> {
    origin: [L; 3],
    direction: [L; 3],
    t_min: L,
    t_max: L,
    clocks: Clocks,
    valid: u32,
}

/// Clocks, lane by lane.
#[derive(Clone, Copy)]
pub(crate) struct Clocks {
    entry: [f64; 8],
    unit: [f64; 8],
}

impl Clocks {
    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> Clock {
        Clock { entry: self.entry[lane], unit: self.unit[lane] }
    }

    /// What the lanes' clocks tell of their t'.
    #[inline(always)]
    pub(crate) fn reported<L: Eight>(&self, t: L) -> L {
        let mut row = t.to_array();
        for (lane, t) in row.iter_mut().enumerate() {
            *t = self.get(lane).reported(*t);
        }
        L::load(&row)
    }
}

impl Prepared {
    /// None.
    pub(crate) const fn none() -> Self {
        let rows = [[0.0; 8]; 3];
        Self {
            inverse: rows,
            lower: rows,
            upper: rows,
            origin: rows,
            slope: rows,
            speed: [0.0; 8],
            t_min: [0.0; 8],
            t_max: [0.0; 8],
            clocks: Clocks { entry: [0.0; 8], unit: [1.0; 8] },
            neg: [0; 8],
            main_axis: [0; 8],
            waiting: 0,
        }
    }

    /// Up to eight rays.
    #[inline(always)]
    pub(crate) fn of<L: Eight>(frame: &Frame, rays: &[Ray]) -> Self {
        let ray = canonical::<L>(frame, rays);
        let steps = L::splat(LATTICE as f32);
        let slabs =
            Slabs::new(per_axis!(k => ray.origin[k] * steps), inverse(per_axis!(k => ray.direction[k] * steps)));
        let [is_x, is_y, _] = main_axis(ray.direction);
        let direction = permute(ray.direction, is_x, is_y);
        let shear = Shear::of_permuted(permute(ray.origin, is_x, is_y), direction);
        let one = L::Bits::splat(1);
        let [x, y, z]: [L::Bits; 3] = per_axis!(k => L::indicator(ray.direction[k].less(L::splat(0.0))));
        let neg = x | (y | z << one) << one;
        let (is_x, is_y) = (L::indicator(is_x), L::indicator(is_y));
        let main_axis = L::Bits::splat(2).minus(is_x << one).minus(is_y);
        Self {
            inverse: rows(slabs.inverse),
            lower: rows(slabs.lower),
            upper: rows(slabs.upper),
            origin: rows(shear.origin),
            slope: rows(shear.slope),
            speed: direction[2].to_array(),
            t_min: ray.t_min.to_array(),
            t_max: ray.t_max.to_array(),
            clocks: ray.clocks,
            neg: integers::<L>(neg),
            main_axis: integers::<L>(main_axis),
            waiting: ray.valid,
        }
    }

    /// Lets no ray wait that passes a box by.
    #[inline(always)]
    pub(crate) fn drop_beyond<L: Eight>(&mut self, (lower, upper): &LatticeBox) {
        let slabs = Slabs::<L> {
            inverse: per_axis!(k => L::load(&self.inverse[k])),
            lower: per_axis!(k => L::load(&self.lower[k])),
            upper: per_axis!(k => L::load(&self.upper[k])),
        };
        let lower: [L; 3] = per_axis!(k => L::splat(f32::from(lower[k])));
        let upper: [L; 3] = per_axis!(k => L::splat(f32::from(upper[k])));
        let (first, last) = slabs.clip(lower, upper, L::load(&self.t_min), L::load(&self.t_max));
        self.waiting &= first.at_most(last).to_bits();
    }

    /// What is added to the near and the far sides of boxes, times the inverse.
    #[inline(always)]
    pub(crate) fn facing<L: Eight>(&self) -> [[L; 3]; 2] {
        let zero = L::splat(0.0);
        let (lower, upper): ([L; 3], [L; 3]) =
            (per_axis!(k => L::load(&self.lower[k])), per_axis!(k => L::load(&self.upper[k])));
        let negative: [L::Mask; 3] = per_axis!(k => L::load(&self.inverse[k]).less(zero));
        [
            per_axis!(k => upper[k].or_else(negative[k], lower[k])),
            per_axis!(k => lower[k].or_else(negative[k], upper[k])),
        ]
    }

    /// t' of a lattice step, and what the near and the far sides of boxes add to it, where all rays are of one octant.
    #[inline(always)]
    pub(crate) fn slabs(&self, neg: u32) -> [[Row; 3]; 3] {
        let sides = [&self.lower, &self.upper];
        [
            self.inverse,
            per_axis!(k => sides[(neg >> k & 1) as usize][k]),
            per_axis!(k => sides[(!neg >> k & 1) as usize][k]),
        ]
    }

    /// Nothing yet, of any ray.
    #[inline(always)]
    pub(crate) fn nearest<L: Eight>(&self) -> Nearest<L> {
        Nearest::between(L::load(&self.t_min), L::load(&self.t_max))
    }

    /// The next ray that waits, with its lane.
    #[inline(always)]
    pub(crate) fn take<L: Eight>(&mut self) -> Option<(usize, Ready<L>)> {
        if self.waiting == 0 {
            return None;
        }
        let lane = self.waiting.trailing_zeros() as usize & 7;
        self.waiting &= self.waiting - 1;
        let ready = Ready {
            slabs: Slabs {
                inverse: per_axis!(k => L::splat(self.inverse[k][lane])),
                lower: per_axis!(k => L::splat(self.lower[k][lane])),
                upper: per_axis!(k => L::splat(self.upper[k][lane])),
            },
            shear: Shear { origin: per_axis!(k => self.origin[k][lane]), slope: per_axis!(k => self.slope[k][lane]) },
            order: L::order(self.neg[lane]),
            axes: PERMUTATIONS[self.main_axis[lane] as usize % 3],
            neg: self.neg[lane],
            nearest: Nearest::between(self.t_min[lane], self.t_max[lane]),
            clock: self.clocks.get(lane),
        };
        Some((lane, ready))
    }
}

/// In the order of each lane's permutation.
#[inline(always)]
fn permute<L: Lanes>(p: [L; 3], is_x: L::Mask, is_y: L::Mask) -> [L; 3] {
    per_axis!(k => {
        let [x, y, z] = per_axis!(main => PERMUTATIONS[main][k]);
        p[x].or_else(is_x, p[y].or_else(is_y, p[z]))
    })
}

#[inline(always)]
fn rows<L: Eight>(lanes: [L; 3]) -> [Row; 3] {
    per_axis!(k => lanes[k].to_array())
}

#[inline(always)]
pub(crate) fn integers<L: Eight>(lanes: L::Bits) -> [u32; 8] {
    bytemuck::cast(L::from_bits(lanes).to_array())
}

/// What [`Frame::canonical`] gives, in eight lanes where no ray is special, else one by one.
#[inline(always)]
fn canonical<L: Eight>(frame: &Frame, rays: &[Ray]) -> Canonical<L> {
    let far = Ray { origin: [f32::NAN; 3], t_min: 0.0, direction: [0.0; 3], t_max: 0.0 };
    let [x, y, z, t_min, dx, dy, dz, t_max] =
        L::transpose(eight_times!(lane => L::load(bytemuck::cast_ref(rays.get(lane).unwrap_or(&far)))));
    let given = [x.to_array(), y.to_array(), z.to_array()];
    let scale = 1.0 / frame.scale();
    let origin: [L; 3] = per_axis!(k => {
        let mut row = [0.0; 8];
        for lane in 0..8 {
            row[lane] = ((f64::from(given[k][lane]) - frame.origin[k]) * scale) as f32;
        }
        L::load(&row).flush(SMALLEST)
    });
    let common = Common::new(frame, [x, y, z], origin, [dx, dy, dz], t_min, t_max);
    let mut unit = [0.0; 8];
    for (lane, of_ray) in common.unit.to_array().into_iter().enumerate() {
        unit[lane] = f64::from(of_ray);
    }
    let mut out = Canonical {
        origin,
        direction: common.direction,
        t_min: common.t_min,
        t_max: common.t_max,
        clocks: Clocks { entry: [0.0; 8], unit },
        valid: common.is_common.to_bits(),
    };
    let special = !out.valid & ((1 << rays.len().min(8)) - 1);
    if special != 0 {
        one_by_one(frame, rays, special, &mut out);
    }
    out
}

/// Far, invalid and extreme rays.
#[inline(never)]
fn one_by_one<L: Eight>(frame: &Frame, rays: &[Ray], special: u32, out: &mut Canonical<L>) {
    let (mut origin, mut direction) = (rows(out.origin), rows(out.direction));
    let (mut t_min, mut t_max) = (out.t_min.to_array(), out.t_max.to_array());
    for (lane, ray) in rays.iter().enumerate().filter(|(lane, _)| special >> lane & 1 == 1) {
        let canonical = frame.canonical(ray);
        out.valid |= u32::from(canonical.is_some()) << lane;
        if let Some(ray) = canonical {
            for k in 0..3 {
                (origin[k][lane], direction[k][lane]) = (ray.origin[k], ray.direction[k]);
            }
            (t_min[lane], t_max[lane]) = (ray.t_min, ray.t_max);
            (out.clocks.entry[lane], out.clocks.unit[lane]) = (ray.clock.entry, ray.clock.unit);
        }
    }
    (out.t_min, out.t_max) = (L::load(&t_min), L::load(&t_max));
    out.origin = per_axis!(k => L::load(&origin[k]));
    out.direction = per_axis!(k => L::load(&direction[k]));
}
