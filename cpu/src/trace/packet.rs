//! `Packet`: eight rays in canonical form, lane by lane, with all that box and triangle tests want to know of them.
//!
//! Every ray of a batch becomes part of a packet, once. Whatever traces it takes the packet as it is, or ray by ray.

use leafwalk_core::canonical::{CommonRays, PreparedFrame};
use leafwalk_core::lanes::{Bits, Lanes, Mask};
use leafwalk_core::layout::LatticeBox;
use leafwalk_core::slabs::Slabs;
use leafwalk_core::step::{Line, inverse};
use leafwalk_core::triangle::{PERMUTATIONS, Shear, main_axis};
use leafwalk_core::{Clock, Nearest, Ray, unroll};

use super::probe::Probe;
use crate::lanes::Eight;

/// Packets of a tile.
pub(crate) const PACKETS: usize = 8;

/// Eight numbers in memory, one a ray.
pub(crate) type Row = [f32; 8];

/// Eight rays. Where a batch ends with fewer, the last of them is repeated.
#[derive(Clone)]
pub(crate) struct Packet {
    /// The place of the first ray in the batch.
    pub(crate) first: u32,
    /// The origin as seen from the root's corner.
    within: [Row; 3],
    direction: [Row; 3],
    /// t' of a lattice step, per axis.
    pub(crate) inverse: [Row; 3],
    /// See [`Slabs::lower`].
    lower: [Row; 3],
    /// See [`Slabs::upper`].
    upper: [Row; 3],
    /// See [`Shear::origin`].
    pub(crate) origin: [Row; 3],
    /// See [`Shear::slope`].
    pub(crate) slope: [Row; 3],
    /// The direction along the main axis: lattice steps per unit of t'.
    pub(crate) speed: Row,
    /// The limits of t'.
    pub(crate) t_min: Row,
    pub(crate) t_max: Row,
    pub(crate) clocks: Clocks,
    /// The octant of each direction: bit k is set where component k is negative.
    pub(crate) neg: [u32; 8],
    /// The axis along which each direction is largest.
    pub(crate) main_axis: [u32; 8],
    /// The lanes that hold a ray that can be traced, repetitions included.
    valid: u32,
    /// Of these, the lanes whose rays still wait to be traced; repetitions never do.
    waiting: u32,
}

/// Canonical rays, lane by lane.
struct CanonicalRays<L> {
    origin: [L; 3],
    within: [L; 3],
    direction: [L; 3],
    t_min: L,
    t_max: L,
    clocks: Clocks,
    valid: u32,
}

/// The clocks of a packet's rays.
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

    /// The caller's t for each lane's t'.
    #[inline(always)]
    pub(crate) fn reported<L: Eight>(&self, t: L) -> L {
        let mut row = t.to_array();
        for (lane, t) in row.iter_mut().enumerate() {
            *t = self.get(lane).reported(*t);
        }
        L::load(&row)
    }
}

impl Packet {
    /// A packet without rays.
    pub(crate) const EMPTY: Self = {
        let rows = [[0.0; 8]; 3];
        Self {
            first: 0,
            within: rows,
            direction: rows,
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
            valid: 0,
            waiting: 0,
        }
    };

    /// The packet of one to eight rays, the first of which has this place in the batch.
    #[inline(always)]
    pub(crate) fn new<L: Eight>(frame: &PreparedFrame, rays: &[Ray], first: u32) -> Self {
        let mut repeated;
        let eight = match rays.first_chunk() {
            Some(eight) => eight,
            None => {
                repeated = [rays[rays.len() - 1]; 8];
                repeated[..rays.len()].copy_from_slice(rays);
                &repeated
            }
        };
        let ray = canonical::<L>(frame, eight);
        let slabs = Slabs::new(ray.within, inverse(ray.direction));
        let [is_x, is_y, _] = main_axis(ray.direction);
        let direction = permute(ray.direction, is_x, is_y);
        let shear = Shear::of_permuted(permute(ray.origin, is_x, is_y), direction);
        let one = L::Bits::splat(1);
        let [x, y, z]: [L::Bits; 3] = unroll!(k in 0..3 => L::indicator(ray.direction[k].less(L::splat(0.0))));
        let neg = x | (y | z << one) << one;
        let (is_x, is_y) = (L::indicator(is_x), L::indicator(is_y));
        let main_axis = L::Bits::splat(2).minus(is_x << one).minus(is_y);
        Self {
            first,
            within: rows(ray.within),
            direction: rows(ray.direction),
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
            valid: ray.valid,
            waiting: ray.valid & ((1 << rays.len().min(8)) - 1),
        }
    }

    /// Whether all lanes hold rays of one octant and one main axis.
    #[inline(always)]
    pub(crate) fn is_uniform(&self) -> bool {
        self.valid == 0xff && self.neg == [self.neg[0]; 8] && self.main_axis == [self.main_axis[0]; 8]
    }

    /// Whether two uniform packets have the same octant and the same main axis.
    #[inline(always)]
    pub(crate) fn goes_with(&self, other: &Self) -> bool {
        (self.neg[0], self.main_axis[0]) == (other.neg[0], other.main_axis[0])
    }

    /// Rays that still wait: bit i is set for lane i.
    #[inline(always)]
    pub(crate) fn waiting(&self) -> u32 {
        self.waiting
    }

    /// Lets no ray wait that passes a box by: it misses.
    #[inline(always)]
    pub(crate) fn drop_beyond<L: Eight>(&mut self, LatticeBox { lower, upper }: &LatticeBox) {
        let slabs = Slabs::<L> {
            inverse: unroll!(k in 0..3 => L::load(&self.inverse[k])),
            lower: unroll!(k in 0..3 => L::load(&self.lower[k])),
            upper: unroll!(k in 0..3 => L::load(&self.upper[k])),
        };
        let lower: [L; 3] = unroll!(k in 0..3 => L::splat(f32::from(lower[k])));
        let upper: [L; 3] = unroll!(k in 0..3 => L::splat(f32::from(upper[k])));
        let (first, last) = slabs.clip(lower, upper, L::load(&self.t_min), L::load(&self.t_max));
        self.keep(first.at_most(last));
    }

    /// Lets only these lanes wait, of those that do.
    #[inline(always)]
    pub(crate) fn keep(&mut self, lanes: impl Mask) {
        self.waiting &= lanes.to_bits();
    }

    /// What steps from cell to cell want to know of the rays.
    #[inline(always)]
    pub(crate) fn line<L: Eight>(&self) -> Line<L> {
        Line::with_inverse(
            unroll!(k in 0..3 => L::load(&self.within[k])),
            unroll!(k in 0..3 => L::load(&self.direction[k])),
            unroll!(k in 0..3 => L::load(&self.inverse[k])),
        )
    }

    /// What the near and the far sides of boxes add to t', per axis; each lane by its own octant.
    #[inline(always)]
    pub(crate) fn near_far<L: Eight>(&self) -> [[L; 3]; 2] {
        let rows = |rows: &[Row; 3]| unroll!(k in 0..3 => L::load(&rows[k]));
        Slabs { inverse: rows(&self.inverse), lower: rows(&self.lower), upper: rows(&self.upper) }.near_far()
    }

    /// t' of a lattice step, and what the near and the far sides of boxes add to it, where all rays are of one octant.
    #[inline(always)]
    pub(crate) fn slabs(&self, neg: u32) -> [[Row; 3]; 3] {
        let sides = [&self.lower, &self.upper];
        [
            self.inverse,
            unroll!(k in 0..3 => sides[(neg >> k & 1) as usize][k]),
            unroll!(k in 0..3 => sides[(!neg >> k & 1) as usize][k]),
        ]
    }

    /// The nearest hits before any triangle was tested: none.
    #[inline(always)]
    pub(crate) fn nearest<L: Eight>(&self) -> Nearest<L> {
        Nearest::between(L::load(&self.t_min), L::load(&self.t_max))
    }

    /// What boxes are tested with against the ray of a lane, the same in every lane.
    #[inline(always)]
    pub(crate) fn slabs_of<L: Eight>(&self, lane: usize) -> Slabs<L> {
        Slabs {
            inverse: unroll!(k in 0..3 => L::splat(self.inverse[k][lane])),
            lower: unroll!(k in 0..3 => L::splat(self.lower[k][lane])),
            upper: unroll!(k in 0..3 => L::splat(self.upper[k][lane])),
        }
    }

    /// What triangles are tested with against the ray of a lane, and the axes in its order.
    #[inline(always)]
    pub(crate) fn shear_of(&self, lane: usize) -> (Shear<f32>, [usize; 3]) {
        let shear = Shear {
            origin: unroll!(k in 0..3 => self.origin[k][lane]),
            slope: unroll!(k in 0..3 => self.slope[k][lane]),
        };
        (shear, PERMUTATIONS[self.main_axis[lane] as usize % 3])
    }

    /// Where t' is 0 on the ray of a lane, in lattice coordinates.
    #[inline(always)]
    pub(crate) fn origin_of(&self, lane: usize) -> [f32; 3] {
        let axes = PERMUTATIONS[self.main_axis[lane] as usize % 3];
        let mut origin = [0.0; 3];
        for k in 0..3 {
            origin[axes[k]] = self.origin[k][lane];
        }
        origin
    }

    /// Where t' is 0 on each ray, in lattice coordinates.
    #[inline(always)]
    pub(crate) fn origins<L: Eight>(&self) -> [L; 3] {
        let main_axis = load_integers::<L>(&self.main_axis);
        let (is_x, is_xy) = (L::below(main_axis, L::Bits::splat(1)), L::below(main_axis, L::Bits::splat(2)));
        let rows: [L; 3] = unroll!(k in 0..3 => L::load(&self.origin[k]));
        // Each permutation is a rotation, which puts axis k in this place.
        const PLACES: [[usize; 3]; 3] = [[2, 0, 1], [1, 2, 0], [0, 1, 2]];
        unroll!(k in 0..3 => {
            let [x, y, z] = unroll!(main in 0..3 => rows[PLACES[main][k]]);
            x.or_else(is_x, y.or_else(is_xy, z))
        })
    }

    /// Takes a ray of another packet into a lane.
    #[inline(always)]
    pub(crate) fn set_ray(&mut self, lane: usize, other: &Self, from: usize) {
        for k in 0..3 {
            self.within[k][lane] = other.within[k][from];
            self.direction[k][lane] = other.direction[k][from];
            self.inverse[k][lane] = other.inverse[k][from];
            self.lower[k][lane] = other.lower[k][from];
            self.upper[k][lane] = other.upper[k][from];
            self.origin[k][lane] = other.origin[k][from];
            self.slope[k][lane] = other.slope[k][from];
        }
        self.speed[lane] = other.speed[from];
        (self.t_min[lane], self.t_max[lane]) = (other.t_min[from], other.t_max[from]);
        self.clocks.entry[lane] = other.clocks.entry[from];
        self.clocks.unit[lane] = other.clocks.unit[from];
        (self.neg[lane], self.main_axis[lane]) = (other.neg[from], other.main_axis[from]);
    }

    /// The lane of the next ray that waits, of which there must be one; from now on it does not.
    #[inline(always)]
    pub(crate) fn next(&mut self) -> usize {
        debug_assert!(self.waiting != 0);
        let lane = self.waiting.trailing_zeros() as usize & 7;
        self.waiting &= self.waiting.wrapping_sub(1);
        lane
    }

    /// The next ray that waits, of which there must be one, with its place in the batch.
    #[inline(always)]
    pub(crate) fn take<L: Eight>(&mut self) -> (usize, Probe<L>) {
        let lane = self.next();
        let (shear, axes) = self.shear_of(lane);
        let probe = Probe {
            origin: self.origin_of(lane),
            slabs: self.slabs_of(lane),
            shear,
            order: L::order(self.neg[lane]),
            axes,
            neg: self.neg[lane],
            nearest: Nearest::between(self.t_min[lane], self.t_max[lane]),
            clock: self.clocks.get(lane),
        };
        (self.first as usize + lane, probe)
    }
}

/// A vector's components in the order of each lane's permutation, which puts the main axis last.
#[inline(always)]
fn permute<L: Lanes>(p: [L; 3], is_x: L::Mask, is_y: L::Mask) -> [L; 3] {
    unroll!(k in 0..3 => {
        let [x, y, z] = unroll!(main in 0..3 => PERMUTATIONS[main][k]);
        p[x].or_else(is_x, p[y].or_else(is_y, p[z]))
    })
}

#[inline(always)]
fn rows<L: Eight>(lanes: [L; 3]) -> [Row; 3] {
    unroll!(k in 0..3 => lanes[k].to_array())
}

/// Integers from memory.
#[inline(always)]
pub(crate) fn load_integers<L: Eight>(row: &[u32; 8]) -> L::Bits {
    L::load(bytemuck::cast_ref(row)).bits()
}

#[inline(always)]
pub(crate) fn integers<L: Eight>(lanes: L::Bits) -> [u32; 8] {
    bytemuck::cast(L::from_bits(lanes).to_array())
}

/// What [`Frame::canonical`] gives, in eight lanes where all rays are of the common kind, the others one by one.
#[inline(always)]
fn canonical<L: Eight>(frame: &PreparedFrame, rays: &[Ray; 8]) -> CanonicalRays<L> {
    let [x, y, z, t_min, dx, dy, dz, t_max] =
        L::transpose(unroll!(lane in 0..8 => L::load(bytemuck::cast_ref(&rays[lane]))));
    let common = CommonRays::new(frame, [x, y, z], [dx, dy, dz], t_min, t_max);
    let mut unit = [0.0; 8];
    for (lane, of_lane) in common.unit.to_array().into_iter().enumerate() {
        unit[lane] = f64::from(of_lane);
    }
    let mut canonical = CanonicalRays {
        origin: common.origin,
        within: common.within,
        direction: common.direction,
        t_min: common.t_min,
        t_max: common.t_max,
        clocks: Clocks { entry: [0.0; 8], unit },
        valid: common.is_common.to_bits(),
    };
    if canonical.valid != 0xff {
        one_by_one(frame, rays, !canonical.valid, &mut canonical);
    }
    canonical
}

/// Makes the rays of some lanes canonical that are far, extreme or invalid.
#[inline(never)]
fn one_by_one<L: Eight>(frame: &PreparedFrame, rays: &[Ray; 8], lanes: u32, out: &mut CanonicalRays<L>) {
    let (mut origin, mut within, mut direction) = (rows(out.origin), rows(out.within), rows(out.direction));
    let (mut t_min, mut t_max) = (out.t_min.to_array(), out.t_max.to_array());
    for (lane, ray) in rays.iter().enumerate().filter(|(lane, _)| lanes >> lane & 1 == 1) {
        let canonical = frame.canonical(ray);
        out.valid |= u32::from(canonical.is_some()) << lane;
        if let Some(ray) = canonical {
            for k in 0..3 {
                (origin[k][lane], within[k][lane]) = (ray.origin[k], ray.within[k]);
                direction[k][lane] = ray.direction[k];
            }
            (t_min[lane], t_max[lane]) = (ray.t_min, ray.t_max);
            (out.clocks.entry[lane], out.clocks.unit[lane]) = (ray.clock.entry, ray.clock.unit);
        }
    }
    (out.t_min, out.t_max) = (L::load(&t_min), L::load(&t_max));
    out.origin = unroll!(k in 0..3 => L::load(&origin[k]));
    out.within = unroll!(k in 0..3 => L::load(&within[k]));
    out.direction = unroll!(k in 0..3 => L::load(&direction[k]));
}
