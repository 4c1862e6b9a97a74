//! Eight rays at a time made ready to trace: canonical, with what box and triangle tests want to know of them.

use leafwalk_core::boxes::Slabs;
use leafwalk_core::lanes::{Bits, Lanes, Mask as _};
use leafwalk_core::layout::{LATTICE, SMALLEST, SMALLEST_DIRECTION};
use leafwalk_core::step::inverse;
use leafwalk_core::triangle::{PERMUTATIONS, Shear, main_axis};
use leafwalk_core::{Clock, Frame, Nearest, Ray, per_axis};

use crate::lanes::Eight;

/// Eight numbers in memory.
type Row = [f32; 8];

/// Rays that wait, lane by lane.
pub(crate) struct Prepared {
    pub(crate) inverse: [Row; 3],
    near: [Row; 3],
    far: [Row; 3],
    pub(crate) origin: [Row; 3],
    pub(crate) slope: [Row; 3],
    pub(crate) t_min: Row,
    pub(crate) t_max: Row,
    pub(crate) clocks: [Clock; 8],
    /// Bit k: the lane's direction component k is negative.
    pub(crate) neg: [u32; 8],
    pub(crate) main_axis: [u8; 8],
    /// Lanes whose rays can hit anything, and still wait.
    pub(crate) waiting: u32,
}

/// One ray, ready.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ready<L> {
    pub(crate) slabs: Slabs<L>,
    pub(crate) shear: Shear<f32>,
    pub(crate) axes: [usize; 3],
    pub(crate) neg: u32,
    pub(crate) nearest: Nearest,
    pub(crate) clock: Clock,
}

/// Canonical rays, lane by lane.
struct Canonical<L> {
    origin: [L; 3],
    direction: [L; 3],
    t_min: Row,
    t_max: Row,
    clocks: [Clock; 8],
    valid: u32,
}

impl Prepared {
    /// None.
    pub(crate) fn none() -> Self {
        let rows = [[0.0; 8]; 3];
        Self {
            inverse: rows,
            near: rows,
            far: rows,
            origin: rows,
            slope: rows,
            t_min: [0.0; 8],
            t_max: [0.0; 8],
            clocks: [Clock { entry: 0.0, unit: 1.0 }; 8],
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
        let shear = Shear::of_permuted(permute(ray.origin, is_x, is_y), permute(ray.direction, is_x, is_y));
        let (is_x, is_y) = (is_x.to_bits(), is_y.to_bits());
        let negative: [u32; 3] = per_axis!(k => ray.direction[k].less(L::splat(0.0)).to_bits());
        let (mut neg, mut main_axis) = ([0; 8], [0; 8]);
        for lane in 0..8 {
            let bit = |mask: u32| mask >> lane & 1;
            neg[lane] = bit(negative[0]) | bit(negative[1]) << 1 | bit(negative[2]) << 2;
            main_axis[lane] = (2 - 2 * bit(is_x) - bit(is_y)) as u8;
        }
        Self {
            inverse: rows(slabs.inverse),
            near: rows(slabs.near),
            far: rows(slabs.far),
            origin: rows(shear.origin),
            slope: rows(shear.slope),
            t_min: ray.t_min,
            t_max: ray.t_max,
            clocks: ray.clocks,
            neg,
            main_axis,
            waiting: ray.valid,
        }
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
                near: per_axis!(k => L::splat(self.near[k][lane])),
                far: per_axis!(k => L::splat(self.far[k][lane])),
            },
            shear: Shear { origin: per_axis!(k => self.origin[k][lane]), slope: per_axis!(k => self.slope[k][lane]) },
            axes: PERMUTATIONS[usize::from(self.main_axis[lane]).min(2)],
            neg: self.neg[lane],
            nearest: Nearest { t_min: self.t_min[lane], t: self.t_max[lane], u: 0.0, v: 0.0, primitive: u32::MAX },
            clock: self.clocks[lane],
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

/// Origins in this range surely lie within one root edge of the root, rounding or not.
const NEAR: (f32, f32) = (-0.999, 1.999);

/// What [`Frame::canonical`] gives, in eight lanes where no ray is special, else one by one.
#[inline(always)]
fn canonical<L: Eight>(frame: &Frame, rays: &[Ray]) -> Canonical<L> {
    let far = Ray { origin: [f32::NAN; 3], t_min: 0.0, direction: [0.0; 3], t_max: 0.0 };
    let ray = |lane: usize| rays.get(lane).unwrap_or(&far);
    let mut given = [[0.0; 8]; 8];
    for lane in 0..8 {
        let ray = ray(lane);
        for k in 0..3 {
            given[k][lane] = ray.origin[k];
            given[3 + k][lane] = ray.direction[k];
        }
        given[6][lane] = ray.t_min;
        given[7][lane] = ray.t_max;
    }
    let scale = 1.0 / frame.scale();
    let origin: [L; 3] = per_axis!(k => {
        let mut row = [0.0; 8];
        for lane in 0..8 {
            row[lane] = ((f64::from(given[k][lane]) - frame.origin[k]) * scale) as f32;
        }
        L::load(&row).flush(SMALLEST)
    });
    let direction: [L; 3] = per_axis!(k => L::load(&given[3 + k]));
    let (t_min, t_max) = (L::load(&given[6]), L::load(&given[7]));

    // The largest component's exponent, biased.
    let largest = direction[0].abs().max(direction[1].abs()).max(direction[2].abs());
    let [a, b, c]: [L; 3] = per_axis!(k => self_difference(direction[k]) + self_difference(L::load(&given[k])));
    let is_finite = (((a + b) + c) + self_difference(t_min)).equal(L::splat(0.0)) & t_max.equal(t_max);
    let is_near = in_range(origin[0], NEAR) & in_range(origin[1], NEAR) & in_range(origin[2], NEAR);
    // Powers of two from 2^-60 to 2^60 for the direction, and for the root, keep all factors normal numbers.
    const MOST: f32 = (1u64 << 60) as f32;
    let is_common = in_range(largest, (1.0 / MOST, MOST));
    let mut plain = (is_finite & is_near & is_common).to_bits();
    if !(-60..=60).contains(&frame.scale_exponent) {
        plain = 0;
    }

    let exponent = largest.bits() >> L::Bits::splat(23);
    let shrink = power::<L>(L::Bits::splat(254).minus(exponent));
    let per_t = power::<L>(exponent.minus(L::Bits::splat(frame.scale_exponent as u32)));
    let mut out = Canonical {
        origin,
        direction: per_axis!(k => (direction[k] * shrink).flush(SMALLEST_DIRECTION)),
        t_min: (t_min * per_t).to_array(),
        t_max: (t_max * per_t).to_array(),
        clocks: [Clock { entry: 0.0, unit: 1.0 }; 8],
        valid: plain,
    };
    let per_t = per_t.to_array();
    for lane in 0..8 {
        out.clocks[lane].unit = 1.0 / f64::from(per_t[lane]);
    }
    let special = !plain & ((1 << rays.len().min(8)) - 1);
    if special != 0 {
        one_by_one(frame, rays, special, &mut out);
    }
    out
}

/// 0, but NaN for what is not finite.
#[inline(always)]
fn self_difference<L: Lanes>(x: L) -> L {
    let same = x;
    x - same
}

#[inline(always)]
fn in_range<L: Lanes>(x: L, (low, high): (f32, f32)) -> L::Mask {
    L::splat(low).at_most(x) & x.at_most(L::splat(high))
}

/// 2 to a power, given with the bias of 127.
#[inline(always)]
fn power<L: Lanes>(biased: L::Bits) -> L {
    L::from_bits(biased << L::Bits::splat(23))
}

/// Far, invalid and extreme rays.
#[inline(never)]
fn one_by_one<L: Eight>(frame: &Frame, rays: &[Ray], special: u32, out: &mut Canonical<L>) {
    let (mut origin, mut direction) = (rows(out.origin), rows(out.direction));
    for (lane, ray) in rays.iter().enumerate().filter(|(lane, _)| special >> lane & 1 == 1) {
        let canonical = frame.canonical(ray);
        out.valid |= u32::from(canonical.is_some()) << lane;
        if let Some(ray) = canonical {
            for k in 0..3 {
                (origin[k][lane], direction[k][lane]) = (ray.origin[k], ray.direction[k]);
            }
            (out.t_min[lane], out.t_max[lane], out.clocks[lane]) = (ray.t_min, ray.t_max, ray.clock);
        }
    }
    out.origin = per_axis!(k => L::load(&origin[k]));
    out.direction = per_axis!(k => L::load(&direction[k]));
}
