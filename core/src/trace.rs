//! The scalar tracer: one ray, from leaf to leaf.

use crate::contract::{BOX_MARGIN, PADDING};
use crate::lanes::Lanes;
use crate::layout::{BLOCK_WIDTH, Block, Key, LATTICE, LINK_NONE, NONE, PAYLOAD_BLOCKS, Payload};
use crate::nearest::Nearest;
use crate::octree::Octree;
use crate::parts::Parts;
use crate::policy::{Policy, Standard};
use crate::ray::{CanonicalRay, Hit, Ray};
use crate::ray_f64::{HitF64, RayF64};
use crate::slabs::Slabs;
use crate::start::Span;
use crate::step::{Cell, Line, Slab, Step, cross, link_kind, neighbour};
use crate::triangle::{Candidate, Shear, Sheared};
use crate::unroll;

/// The work of one ray's walk through an octree, for charts and heat maps. It belongs to the walk: a tracer that goes
/// another way does other work for the same answer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Leaves visited, empty ones included.
    pub cells: u32,
    /// Block boxes that the ray met, whose eight triangles were then tested.
    pub blocks: u32,
}

impl<W: AsRef<[u32]>> Octree<W> {
    /// The closest hit with `t_min < t < t_max`: smallest distance, then smallest primitive. `None` for a miss or an
    /// invalid ray.
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        Walk::new(&self.parts()).closest_hit(ray)
    }

    /// The closest hit as by [`Octree::closest_hit`], and the work of the walk from leaf to leaf that found it.
    pub fn closest_hit_with_work(&self, ray: &Ray) -> (Option<Hit>, Work) {
        Walk::new(&self.parts()).closest_hit_with_work(ray)
    }

    /// Whether anything is hit with `t_min < t < t_max`.
    pub fn occluded(&self, ray: &Ray) -> bool {
        Walk::new(&self.parts()).occluded(ray)
    }

    /// As [`Octree::closest_hit`], in f64: `t_min < t < t_max` holds for the t of the answer.
    pub fn closest_hit_f64(&self, ray: &RayF64) -> Option<HitF64> {
        Walk::new(&self.parts()).closest_hit_f64(ray)
    }

    /// As [`Octree::occluded`], in f64.
    pub fn occluded_f64(&self, ray: &RayF64) -> bool {
        Walk::new(&self.parts()).occluded_f64(ray)
    }
}

/// The scalar walk over the sections of an octree, by a kind of step and under a policy.
#[derive(Clone, Copy, Debug)]
pub struct Walk<'a, S = Slab, P = Standard> {
    parts: &'a Parts<'a>,
    /// Lower and upper corner of the hull, dilated by the box margin.
    hull: [[f32; 3]; 2],
    kind: core::marker::PhantomData<(S, P)>,
}

/// A search under way.
struct Search<'a> {
    ray: &'a CanonicalRay,
    nearest: Nearest,
    work: Work,
}

impl<'a> Walk<'a> {
    /// The walk that serves: by slabs, under the contract.
    pub fn new(parts: &'a Parts<'a>) -> Self {
        Self::with(parts)
    }
}

impl<'a, S: Step, P: Policy> Walk<'a, S, P> {
    /// See [`crate::testing::walk`].
    pub(crate) fn with(parts: &'a Parts<'a>) -> Self {
        let hull = parts.hull.dilated(if P::DILATES_ROOT { BOX_MARGIN } else { 0.0 });
        Self { parts, hull, kind: core::marker::PhantomData }
    }

    /// See [`Octree::closest_hit`].
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.closest_hit_with_work(ray).0
    }

    /// See [`Octree::closest_hit_with_work`].
    pub fn closest_hit_with_work(&self, ray: &Ray) -> (Option<Hit>, Work) {
        let Some(canonical) = self.parts.frame.canonical_with::<P>(ray) else { return Default::default() };
        let search = self.walk::<false>(&canonical, &mut |_, _| {});
        (search.nearest.is_hit().then(|| search.nearest.hit(&canonical.clock)), search.work)
    }

    /// See [`Octree::occluded`].
    pub fn occluded(&self, ray: &Ray) -> bool {
        let canonical = self.parts.frame.canonical_with::<P>(ray);
        canonical.is_some_and(|canonical| self.walk::<true>(&canonical, &mut |_, _| {}).nearest.is_hit())
    }

    /// See [`Octree::closest_hit_f64`].
    pub fn closest_hit_f64(&self, ray: &RayF64) -> Option<HitF64> {
        let canonical = self.parts.frame.canonical_f64(ray)?;
        self.walk::<false>(&canonical, &mut |_, _| {}).nearest.hit_f64(&canonical.clock).ok()
    }

    /// See [`Octree::occluded_f64`].
    pub fn occluded_f64(&self, ray: &RayF64) -> bool {
        let canonical = self.parts.frame.canonical_f64(ray);
        canonical.is_some_and(|canonical| self.walk::<true>(&canonical, &mut |_, _| {}).nearest.is_hit())
    }

    /// The cells that a closest-hit walk visits, in order.
    pub fn visit(&self, ray: &Ray, mut visitor: impl FnMut(u32, Key)) {
        if let Some(canonical) = self.parts.frame.canonical_with::<P>(ray) {
            self.walk::<false>(&canonical, &mut |record, cell: &Cell<f32>| {
                visitor(record, Key { corner: cell.corner, level: LATTICE.ilog2() - cell.size.ilog2() });
            });
        }
    }

    fn walk<'r, const ANY: bool>(
        &self,
        ray: &'r CanonicalRay,
        visitor: &mut impl FnMut(u32, &Cell<f32>),
    ) -> Search<'r> {
        let mut search = Search { ray, nearest: Nearest::new(ray), work: Work::default() };
        let line = Line::new(ray.within, ray.direction);
        let span = Span::new(&line, ray.t_min, ray.t_max, &self.hull);
        if !span.is_met {
            return search;
        }
        let slabs = Slabs::new(line.origin, line.inverse);
        let (shear, axes) = Shear::<f32>::new(ray);
        let (mut number, mut cell) = self.parts.locate(span.start, line.neg);
        loop {
            visitor(number, &cell);
            search.work.cells += 1;
            let record = &self.parts.records[number as usize];
            let head = record.head();
            if head.t_count() != 0 {
                self.leaf::<ANY>(record.offset, &slabs, &shear, axes, &mut search);
                if (ANY || P::STOPS_AT_FIRST_HIT) && search.nearest.is_hit() {
                    return search;
                }
            }
            let exit = S::exit(&line, &cell);
            let margin = if P::STOP_MARGIN { PADDING } else { 0.0 };
            let is_done = Lanes::min(search.nearest.t, span.end) * exit.speed < exit.distance - margin;
            if is_done || link_kind::<f32>(head.0, exit.face) == LINK_NONE {
                return search;
            }
            let left = cell;
            (number, cell) = cross::<f32, S>(&line, &cell, &exit, head.0, neighbour(record, exit.face));
            debug_assert!(precedes(&left, &cell, line.neg), "a step must move forward: {ray:?}");
        }
    }

    /// Tests what a leaf lists: its tight box, then the blocks whose boxes the ray meets.
    #[inline(always)]
    fn leaf<const ANY: bool>(
        &self,
        first: u32,
        slabs: &Slabs<f32>,
        shear: &Shear<f32>,
        axes: [usize; 3],
        search: &mut Search<'_>,
    ) {
        let mut payload = &self.parts.payloads[first as usize];
        let mut room = None;
        if !search.meets(slabs, payload) {
            return;
        }
        loop {
            let met = search.blocks_met(slabs, payload);
            for b in (0..payload.count).filter(|b| met >> b & 1 == 1) {
                search.work.blocks += 1;
                if let Some(block) = self.parts.blocks.get((payload.first + b) as usize, &mut room) {
                    search.test_block::<ANY, P>(block, shear, axes);
                }
            }
            match self.parts.payloads.get(payload.next as usize) {
                Some(next) => payload = next,
                None => return,
            }
        }
    }
}

/// Whether one cell comes before another along a ray of octant `neg`: by the Morton order of the corners that the ray
/// reaches last, which are those that order cells of different sizes too.
fn precedes(a: &Cell<f32>, b: &Cell<f32>, neg: u32) -> bool {
    let far = |cell: &Cell<f32>, k: usize| match neg >> k & 1 {
        0 => cell.corner[k] + cell.size - 1,
        _ => LATTICE - 1 - cell.corner[k],
    };
    // The axis whose coordinates differ in the highest bit decides.
    let differing = |k: usize| far(a, k) ^ far(b, k);
    let axis =
        (1..3).fold(0, |axis, k| if differing(k).leading_zeros() < differing(axis).leading_zeros() { k } else { axis });
    far(a, axis) < far(b, axis)
}

impl Search<'_> {
    /// Whether the ray meets a payload's tight box.
    #[inline(always)]
    fn meets(&self, slabs: &Slabs<f32>, payload: &Payload) -> bool {
        let sides = |sides: &[u16; 3]| -> [f32; 3] { unroll!(k in 0..3 => f32::from(sides[k])) };
        let (first, last) = slabs.clip(sides(&payload.lower), sides(&payload.upper), self.ray.t_min, self.nearest.t);
        first <= last
    }

    /// Bit b: block b's box is met; bits from the payload's count on mean nothing. All eight at once, in a loop that
    /// compilers turn into SIMD.
    #[inline(always)]
    fn blocks_met(&self, slabs: &Slabs<f32>, payload: &Payload) -> u32 {
        let is_met: [bool; PAYLOAD_BLOCKS] = core::array::from_fn(|b| {
            let [x, y, z] = &payload.sides;
            let side = |at: usize| [x[at][b], y[at][b], z[at][b]].map(f32::from);
            let (first, last) = slabs.clip(side(0), side(1), self.ray.t_min, self.nearest.t);
            first <= last
        });
        (0..).zip(is_met).fold(0, |met, (b, is_met)| met | u32::from(is_met) << b)
    }

    #[inline(always)]
    fn test_block<const ANY: bool, P: Policy>(&mut self, block: &Block, shear: &Shear<f32>, axes: [usize; 3]) {
        // Few blocks hold a candidate, so all lanes are sifted before any is finished: a loop without branches.
        let mut is_candidate = [false; BLOCK_WIDTH];
        let corners = |lane: usize| core::array::from_fn(|corner| axes.map(|axis| block.vertices[corner][axis][lane]));
        for (lane, is_candidate) in is_candidate.iter_mut().enumerate() {
            // A vacant lane would be finished as often as the lane that it repeats.
            *is_candidate = Sheared::new(shear, corners(lane)).is_candidate() & (block.primitives[lane] != NONE);
        }
        for (lane, is_candidate) in is_candidate.into_iter().enumerate() {
            if is_candidate {
                let (accepted, found) = Sheared::new(shear, corners(lane)).finish(shear, &corners(lane));
                if accepted {
                    self.offer::<P>(found, block.primitives[lane]);
                }
            }
        }
    }

    #[inline(always)]
    fn offer<P: Policy>(&mut self, found: Candidate<f32>, primitive: u32) {
        let Candidate { t, u, v } = found;
        let nearest = &mut self.nearest;
        if !P::ORDERS_BY_REPORTED {
            return nearest.offer(true, t, u, v, primitive);
        }
        let (new, old) = (self.ray.clock.reported(t), self.ray.clock.reported(nearest.t));
        let is_nearer = !nearest.is_hit() || new < old || (new == old && primitive < nearest.primitive);
        if t > self.ray.t_min && t < self.ray.t_max && is_nearer {
            *nearest = Nearest { t, u, v, primitive, ..*nearest };
        }
    }
}
