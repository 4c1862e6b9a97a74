//! The scalar tracer: one ray, from leaf to leaf.

use crate::contract::{BOX_MARGIN, PADDING};
use crate::lanes::Lanes;
use crate::layout::{BLOCK_WIDTH, BVH_WIDTH, Block, Child, Key, LATTICE, LINK_NONE, MAX_DEPTH, NONE};
use crate::leaf::Leaf;
use crate::nearest::Nearest;
use crate::octree::Octree;
use crate::parts::Parts;
use crate::policy::{Policy, Standard};
use crate::probe::{Entered, Probe, Sides};
use crate::ray::{CanonicalRay, Hit, Ray};
use crate::ray_f64::{HitF64, RayF64};
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
    /// Where the walk ended.
    end: Leaf,
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
        self.find(ray, Leaf::UNKNOWN).0
    }

    /// See [`Octree::closest_hit_with_work`].
    pub fn closest_hit_with_work(&self, ray: &Ray) -> (Option<Hit>, Work) {
        let (hit, _, work) = self.find(ray, Leaf::UNKNOWN);
        (hit, work)
    }

    /// The closest hit, the leaf in which the walk ended, and its work.
    pub(crate) fn find(&self, ray: &Ray, leaf: Leaf) -> (Option<Hit>, Leaf, Work) {
        let Some(canonical) = self.parts.frame.canonical_with::<P>(ray) else { return Default::default() };
        let Search { nearest, work, end, .. } = self.search::<false>(&canonical, leaf);
        (nearest.is_hit().then(|| nearest.hit(&canonical.clock)), end, work)
    }

    /// See [`Octree::occluded`].
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.occluded_from(ray, Leaf::UNKNOWN)
    }

    /// See [`Octree::occluded_from`].
    pub fn occluded_from(&self, ray: &Ray, leaf: Leaf) -> bool {
        let canonical = self.parts.frame.canonical_with::<P>(ray);
        canonical.is_some_and(|canonical| self.search::<true>(&canonical, leaf).nearest.is_hit())
    }

    /// See [`Octree::closest_hit_f64`].
    pub fn closest_hit_f64(&self, ray: &RayF64) -> Option<HitF64> {
        let canonical = self.parts.frame.canonical_f64(ray)?;
        self.search::<false>(&canonical, Leaf::UNKNOWN).nearest.hit_f64(&canonical.clock).ok()
    }

    /// See [`Octree::occluded_f64`].
    pub fn occluded_f64(&self, ray: &RayF64) -> bool {
        let canonical = self.parts.frame.canonical_f64(ray);
        canonical.is_some_and(|canonical| self.search::<true>(&canonical, Leaf::UNKNOWN).nearest.is_hit())
    }

    /// The cells that a closest-hit walk visits, in order.
    pub fn visit(&self, ray: &Ray, mut visitor: impl FnMut(u32, Key)) {
        if let Some(canonical) = self.parts.frame.canonical_with::<P>(ray) {
            self.walk::<false>(&canonical, Leaf::UNKNOWN, &mut |record, cell: &Cell<f32>| {
                visitor(record, Key { corner: cell.corner, level: LATTICE.ilog2() - cell.size.ilog2() });
            });
        }
    }

    fn search<'r, const ANY: bool>(&self, ray: &'r CanonicalRay, leaf: Leaf) -> Search<'r> {
        self.walk::<ANY>(ray, leaf, &mut |_, _| {})
    }

    fn walk<'r, const ANY: bool>(
        &self,
        ray: &'r CanonicalRay,
        leaf: Leaf,
        visitor: &mut impl FnMut(u32, &Cell<f32>),
    ) -> Search<'r> {
        match self.parts.lattices {
            [] => self.walk_in::<ANY, false>(ray, leaf, visitor),
            _ => self.walk_in::<ANY, true>(ray, leaf, visitor),
        }
    }

    /// The walk through an octree that is wide, or is not.
    fn walk_in<'r, const ANY: bool, const WIDE: bool>(
        &self,
        ray: &'r CanonicalRay,
        leaf: Leaf,
        visitor: &mut impl FnMut(u32, &Cell<f32>),
    ) -> Search<'r> {
        let mut search = Search { ray, nearest: Nearest::new(ray), work: Work::default(), end: Leaf::UNKNOWN };
        let line = Line::new(ray.within, ray.direction);
        let span = Span::new(&line, ray.t_min, ray.t_max, &self.hull);
        if !span.is_met {
            return search;
        }
        let probe = Probe::new(ray, &line);
        // In a leaf, the nodes on the way down.
        let mut path = [Entered::NONE; MAX_DEPTH];
        let (mut number, mut cell) = self.parts.locate_with::<P>(span.start, line.neg, leaf);
        loop {
            visitor(number, &cell);
            search.work.cells += 1;
            let record = &self.parts.records[number as usize];
            let head = record.head();
            if head.t_count() != 0 {
                self.leaf::<ANY, WIDE>(record.offset, &probe, &mut search, &mut path);
                if (ANY || P::STOPS_AT_FIRST_HIT) && search.nearest.is_hit() {
                    break;
                }
            }
            let exit = S::exit(&line, &cell);
            let margin = if P::STOP_MARGIN { PADDING } else { 0.0 };
            let is_done = Lanes::min(search.nearest.t, span.end) * exit.speed < exit.distance - margin;
            if is_done || link_kind::<f32>(head.0, exit.face) == LINK_NONE {
                break;
            }
            let left = cell;
            (number, cell) = cross::<f32, S>(&line, &cell, &exit, head.0, neighbour(record, exit.face));
            debug_assert!(precedes(&left, &cell, line.neg), "a step must move forward: {ray:?}");
        }
        search.end = Leaf(number);
        search
    }

    /// The sides of the boxes of a node, or of what a leaf lists.
    #[inline(always)]
    fn sides<const WIDE: bool>(&self, probe: &Probe, node: u32) -> Sides {
        match self.parts.lattices.get(node as usize) {
            Some(lattice) if WIDE => probe.sides_in(lattice),
            _ => probe.sides,
        }
    }

    /// Descends from what a leaf lists to the blocks whose boxes the ray meets, and tests these.
    ///
    /// Below an entry only that part of the ray counts that lies in the entry's box, which is cut to the leaf's cell: what it
    /// meets outside belongs to other leaves.
    #[inline(always)]
    fn leaf<const ANY: bool, const WIDE: bool>(
        &self,
        payload: u32,
        probe: &Probe,
        search: &mut Search<'_>,
        path: &mut [Entered<'a>; MAX_DEPTH],
    ) {
        let mut room = None;
        let all = (search.ray.t_min, search.ray.t_max);
        let mut part = all;
        let mut entered = Entered { node: &self.parts.payloads[payload as usize], number: NONE, waiting: 0 };
        entered.waiting = probe.enter(&probe.sides, entered.node, part, search.nearest.t);
        let mut depth = 0;
        loop {
            let Entered { node, number, waiting } = &mut entered;
            if *waiting == 0 {
                if depth == 0 {
                    return;
                }
                depth -= 1;
                entered = path[depth];
                if depth == 0 {
                    part = all;
                }
                continue;
            }
            let slot = (waiting.trailing_zeros() ^ probe.neg) as usize % BVH_WIDTH;
            *waiting &= *waiting - 1;
            let met = if search.nearest.is_hit() || depth == 0 {
                probe.clip(&self.sides::<WIDE>(probe, *number), node, slot, part, search.nearest.t)
            } else {
                part
            };
            if met.0 > met.1 {
                // A nearer hit was found since the node was entered.
                continue;
            }
            match Child::from_word(node.children[slot]) {
                Child::Node(number) => {
                    if depth == 0 {
                        part = met;
                    }
                    path[depth] = entered;
                    depth += 1;
                    entered = Entered { node: &self.parts.bvh[number as usize], number, waiting: 0 };
                    let sides = self.sides::<WIDE>(probe, number);
                    entered.waiting = probe.enter(&sides, entered.node, part, search.nearest.t);
                }
                Child::Block(number) => {
                    search.work.blocks += 1;
                    if let Some(block) = self.parts.blocks.get(number as usize, &mut room) {
                        search.test_block::<ANY, P>(block, &probe.shear, probe.axes);
                        if ANY && search.nearest.is_hit() {
                            return;
                        }
                    }
                }
                Child::Vacant => {}
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
    #[inline(always)]
    fn test_block<const ANY: bool, P: Policy>(&mut self, block: &Block, shear: &Shear<f32>, axes: [usize; 3]) {
        let candidates = candidates(block, shear, axes);
        if candidates == [false; BLOCK_WIDTH] {
            return;
        }
        for (lane, is_candidate) in candidates.into_iter().enumerate() {
            if is_candidate {
                let corners = corners(block, axes, lane);
                let sheared = Sheared::new(shear, corners);
                let found = if P::MEETS_PLANES {
                    sheared.hit(shear, &corners)
                } else {
                    let (accepted, found) = sheared.finish(shear.slope[2]);
                    accepted.then_some(found)
                };
                if let Some(found) = found {
                    self.offer::<P>(found, block.primitives[lane]);
                }
            }
        }
    }

    #[inline(always)]
    fn offer<P: Policy>(&mut self, found: Candidate<f32>, primitive: u32) {
        let Candidate { t, u, v, .. } = found;
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

/// The lanes of a block whose triangles may be hit. Few blocks have any, so all lanes are sifted before any is finished, in a
/// loop without branches that compilers turn into SIMD; here, once, since copies in other crates were not always.
fn candidates(block: &Block, shear: &Shear<f32>, axes: [usize; 3]) -> [bool; BLOCK_WIDTH] {
    let mut candidates = [false; BLOCK_WIDTH];
    for (lane, is_candidate) in candidates.iter_mut().enumerate() {
        // A vacant lane would be finished as often as the lane that it repeats.
        *is_candidate =
            Sheared::new(shear, corners(block, axes, lane)).is_candidate() & (block.primitives[lane] != NONE);
    }
    candidates
}

/// A lane's corners, with the axes in the order of a ray's shear.
#[inline(always)]
fn corners(block: &Block, axes: [usize; 3], lane: usize) -> [[f32; 3]; 3] {
    unroll!(corner in 0..3 => unroll!(k in 0..3 => block.vertices[corner][axes[k]][lane]))
}
