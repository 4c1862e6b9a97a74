//! Tracers that differ from those that serve: by the kind of step, by the clauses of the contract they keep, by the
//! arithmetic of the triangle test, or by how they are called. The same checks judge them all.

use core::marker::PhantomData;

use crate::listing::triangles_of;
use crate::random::Random;
use leafwalk_core::lanes::Lanes;
use leafwalk_core::layout::Triangle;
use leafwalk_core::step::Step;
use leafwalk_core::testing::{self, Policy};
use leafwalk_core::triangle::{Shear, intersect};
use leafwalk_core::{
    CanonicalRay, Frame, Hit, Leaf, LengthMismatch, Octree, Parts, Ray, Tracer, Walk, one_by_one, weight_of_vertex_2,
};
use leafwalk_cpu::CpuTracer;

/// Any tracer, whatever it traces.
pub type Any<'a> = &'a (dyn Tracer<Error = LengthMismatch> + Sync);

/// A tracer, and what messages call it.
pub type Named<'a> = (&'a str, Any<'a>);

/// Implements [`Tracer`] by a method `answer(&self, &Ray) -> Option<Hit>`.
macro_rules! tracer {
    ($name:ident<$($kind:ident: $bound:path),*>) => {
        impl<$($kind: $bound),*> Tracer for $name<'_, $($kind),*> {
            type Error = LengthMismatch;

            fn closest_hits(&self, rays: &[Ray], hits: &mut [Hit]) -> Result<(), LengthMismatch> {
                one_by_one(rays, hits, |ray| Hit::from(self.answer(ray)))
            }

            fn occlusions(&self, rays: &[Ray], occluded: &mut [bool]) -> Result<(), LengthMismatch> {
                one_by_one(rays, occluded, |ray| self.is_occluded(ray))
            }
        }
    };
}

/// The scalar walk with steps of one kind, which keeps the clauses that a policy names.
pub struct Stepping<'a, S, P>(Walk<'a, S, P>);

impl<'a, S: Step, P: Policy> Stepping<'a, S, P> {
    /// Walks this octree.
    pub fn new(parts: &'a Parts<'a>) -> Self {
        Self(testing::walk(parts))
    }

    fn answer(&self, ray: &Ray) -> Option<Hit> {
        self.0.closest_hit(ray)
    }

    fn is_occluded(&self, ray: &Ray) -> bool {
        self.0.occluded(ray)
    }
}
tracer!(Stepping<S: Step, P: Policy>);

/// A leaf to tell a walk of, right or wrong, chosen by the ray's bits: the one in which the walk begins, one beside it, the
/// one in which it ends, any record, those of inner nodes and vacant ones included, no record, or none.
pub fn told(parts: &Parts<'_>, ray: &Ray) -> Leaf {
    let words: &[u32] = bytemuck::cast_slice(core::slice::from_ref(ray));
    let mut random = Random::new(words.iter().fold(0, |seed, word| seed.rotate_left(7) ^ u64::from(*word)), 0);
    let mut visited = Vec::new();
    Walk::new(parts).visit(ray, |record, _| visited.push(record));
    let (first, last) = (visited.first().map_or(0, |first| *first), visited.last().map_or(0, |last| *last));
    let count = parts.records.len();
    Leaf(match random.below(6) {
        0 => first,
        1 => parts.records[first as usize].neighbours[random.below(6)],
        2 => last,
        3 => random.below(count) as u32,
        4 => (count + random.below(3)) as u32,
        _ => return Leaf::UNKNOWN,
    })
}

/// As [`Stepping`], by walks that are [`told`] leaves.
pub struct SteppingFrom<'a, S, P> {
    parts: &'a Parts<'a>,
    walk: Walk<'a, S, P>,
}

impl<'a, S: Step, P: Policy> SteppingFrom<'a, S, P> {
    /// Walks this octree.
    pub fn new(parts: &'a Parts<'a>) -> Self {
        Self { parts, walk: testing::walk(parts) }
    }

    fn answer(&self, ray: &Ray) -> Option<Hit> {
        self.walk.closest_hit_from(ray, told(self.parts, ray)).0
    }

    fn is_occluded(&self, ray: &Ray) -> bool {
        self.walk.occluded_from(ray, told(self.parts, ray))
    }
}
tracer!(SteppingFrom<S: Step, P: Policy>);

/// The CPU's walks in lanes, which are [`told`] leaves.
pub struct LanesFrom<'a, W>(pub &'a CpuTracer<W>);

impl<W: Words> LanesFrom<'_, W> {
    fn told(&self, rays: &[Ray]) -> Vec<Leaf> {
        let parts = self.0.octree().parts();
        rays.iter().map(|ray| told(&parts, ray)).collect()
    }
}

impl<W: Words> Tracer for LanesFrom<'_, W> {
    type Error = LengthMismatch;

    fn closest_hits(&self, rays: &[Ray], hits: &mut [Hit]) -> Result<(), LengthMismatch> {
        self.0.closest_hits_from(rays, &self.told(rays), hits, &mut vec![Leaf::UNKNOWN; rays.len()])
    }

    fn occlusions(&self, rays: &[Ray], occluded: &mut [bool]) -> Result<(), LengthMismatch> {
        self.0.occlusions_from(rays, &self.told(rays), occluded)
    }
}

/// The CPU's tracer, called with one ray at a time.
pub struct OneByOne<'a, W>(pub &'a CpuTracer<W>);

impl<W: AsRef<[u32]> + Sync> OneByOne<'_, W> {
    fn answer(&self, ray: &Ray) -> Option<Hit> {
        self.0.closest_hit(ray)
    }

    fn is_occluded(&self, ray: &Ray) -> bool {
        self.0.occluded(ray)
    }
}
tracer!(OneByOne<W: Words>);

/// A tracer one of whose hits is wrong: a batch's first has the lowest bit of its v flipped.
pub struct Flipped<T>(pub T);

impl<T: Tracer> Tracer for Flipped<T> {
    type Error = T::Error;

    fn closest_hits(&self, rays: &[Ray], hits: &mut [Hit]) -> Result<(), T::Error> {
        self.0.closest_hits(rays, hits)?;
        if let Some(hit) = hits.iter_mut().find(|hit| !hit.is_miss()) {
            hit.v = f32::from_bits(hit.v.to_bits() ^ 1);
        }
        Ok(())
    }

    fn occlusions(&self, rays: &[Ray], occluded: &mut [bool]) -> Result<(), T::Error> {
        self.0.occlusions(rays, occluded)
    }
}

/// The words of an octree, which several threads read.
pub trait Words: AsRef<[u32]> + Sync {}
impl<W: AsRef<[u32]> + Sync> Words for W {}

/// Tests every triangle that an octree lists, in the arithmetic `L`.
pub struct Every<'a, L> {
    frame: Frame,
    triangles: Vec<Triangle>,
    kind: PhantomData<&'a L>,
}

impl<L: Lanes<Mask = bool, Bits = u32>> Every<'_, L> {
    /// Collects the triangles of an octree.
    pub fn of<W: AsRef<[u32]>>(octree: &Octree<W>) -> Self {
        let parts = octree.parts();
        Self { frame: parts.frame, triangles: parts.triangles().collect(), kind: PhantomData }
    }

    fn answer(&self, ray: &Ray) -> Option<Hit> {
        closest::<L>(&self.frame.canonical(ray)?, self.triangles.iter().copied())
    }

    fn is_occluded(&self, ray: &Ray) -> bool {
        let canonical = self.frame.canonical(ray);
        canonical.is_some_and(|ray| hits::<L>(&ray, self.triangles.iter().copied()).next().is_some())
    }
}
tracer!(Every<L: ScalarLanes>);

/// Tests the triangles of the leaves that a walk visits, in the arithmetic `L`.
pub struct Visited<'a, L> {
    parts: &'a Parts<'a>,
    kind: PhantomData<L>,
}

impl<'a, L: Lanes<Mask = bool, Bits = u32>> Visited<'a, L> {
    /// Walks this octree.
    pub fn of(parts: &'a Parts<'a>) -> Self {
        Self { parts, kind: PhantomData }
    }

    fn answer(&self, ray: &Ray) -> Option<Hit> {
        let mut triangles = Vec::new();
        Walk::new(self.parts).visit(ray, |record, _| {
            triangles.extend(triangles_of(self.parts, &self.parts.records[record as usize]));
        });
        closest::<L>(&self.parts.frame.canonical(ray)?, triangles.into_iter())
    }

    fn is_occluded(&self, ray: &Ray) -> bool {
        self.answer(ray).is_some()
    }
}
tracer!(Visited<L: ScalarLanes>);

/// The arithmetic of single numbers.
pub trait ScalarLanes: Lanes<Mask = bool, Bits = u32> {}
impl<L: Lanes<Mask = bool, Bits = u32>> ScalarLanes for L {}

/// All triangles that a canonical ray hits; `t` is that of the canonical ray.
fn hits<L: ScalarLanes>(ray: &CanonicalRay, triangles: impl Iterator<Item = Triangle>) -> impl Iterator<Item = Hit> {
    let number = |x: L| f32::from_bits(x.bits());
    let (shear, axes) = Shear::<L>::new(ray);
    triangles.filter_map(move |Triangle { primitive, corners }| {
        let found = intersect(&shear, &corners.map(|corner| axes.map(|axis| L::splat(corner[axis]))))?;
        let t = number(found.t);
        let hit = Hit { t, u: number(found.u), v: number(found.v), primitive };
        (ray.t_min < t && t < ray.t_max).then_some(hit)
    })
}

/// The smallest (t', primitive) of the triangles that a canonical ray hits.
fn closest<L: ScalarLanes>(ray: &CanonicalRay, triangles: impl Iterator<Item = Triangle>) -> Option<Hit> {
    let order = |a: &Hit, b: &Hit| a.t.total_cmp(&b.t).then(a.primitive.cmp(&b.primitive));
    hits::<L>(ray, triangles).min_by(order).map(|hit| Hit {
        t: ray.clock.reported(hit.t),
        v: weight_of_vertex_2(hit.u, hit.v),
        ..hit
    })
}
