//! Tracers that differ from the one that serves: by the kind of step, by the policy, by the arithmetic of the triangle
//! test. Whatever the variant, the suite is the same.

use core::marker::PhantomData;

use leafwalk::{CanonicalRay, CpuTracer, Frame, Hit, LengthMismatch, Octree, Parts, Ray, Tracer};
use leafwalk_core::lanes::Lanes;
use leafwalk_core::step::Step;
use leafwalk_core::triangle::{Shear, intersect};
use leafwalk_core::{Policy, Walk, one_by_one};

/// Implements [`Tracer`] by a method `answer(&self, &Ray) -> Option<Hit>`.
macro_rules! tracer {
    ($name:ident<$($kind:ident: $bound:path),*>) => {
        impl<$($kind: $bound),*> Tracer for $name<'_, $($kind),*> {
            type Error = LengthMismatch;

            fn closest_hits(&self, rays: &[Ray], hits: &mut [Hit]) -> Result<(), LengthMismatch> {
                one_by_one(rays, hits, |ray| self.answer(ray).unwrap_or(Hit::MISS))
            }

            fn occlusions(&self, rays: &[Ray], occluded: &mut [bool]) -> Result<(), LengthMismatch> {
                one_by_one(rays, occluded, |ray| self.is_occluded(ray))
            }
        }
    };
}

/// The scalar walk by a kind of step, under a policy.
pub(crate) struct Stepping<'a, S, P>(Walk<'a, S, P>);

impl<'a, S: Step, P: Policy> Stepping<'a, S, P> {
    pub(crate) fn new(parts: &'a Parts<'a>) -> Self {
        Self(Walk::with(parts))
    }

    fn answer(&self, ray: &Ray) -> Option<Hit> {
        self.0.closest_hit(ray)
    }

    fn is_occluded(&self, ray: &Ray) -> bool {
        self.0.occluded(ray)
    }
}
tracer!(Stepping<S: Step, P: Policy>);

/// The batch tracer asked ray by ray.
pub(crate) struct OneByOne<'a, W>(pub(crate) &'a CpuTracer<W>);

impl<W: AsRef<[u32]> + Sync> OneByOne<'_, W> {
    fn answer(&self, ray: &Ray) -> Option<Hit> {
        self.0.closest_hit(ray)
    }

    fn is_occluded(&self, ray: &Ray) -> bool {
        self.0.occluded(ray)
    }
}
tracer!(OneByOne<W: Words>);

/// Words of an octree.
pub(crate) trait Words: AsRef<[u32]> + Sync {}
impl<W: AsRef<[u32]> + Sync> Words for W {}

/// Every triangle that an octree lists, tested by any arithmetic.
pub(crate) struct Every<'a, L> {
    frame: Frame,
    triangles: Vec<(u32, [[f32; 3]; 3])>,
    kind: PhantomData<&'a L>,
}

impl<L: Lanes<Mask = bool, Bits = u32>> Every<'_, L> {
    pub(crate) fn of<W: AsRef<[u32]>>(octree: &Octree<W>) -> Self {
        let parts = octree.parts();
        let mut triangles: Vec<_> = parts.leaves().flat_map(|(_, leaf)| parts.triangles_of(leaf)).collect();
        triangles.sort_unstable_by_key(|(primitive, _)| *primitive);
        triangles.dedup_by_key(|(primitive, _)| *primitive);
        Self { frame: parts.frame, triangles, kind: PhantomData }
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

/// The triangles of the leaves that a walk visits, tested by any arithmetic.
pub(crate) struct Visited<'a, L> {
    parts: &'a Parts<'a>,
    kind: PhantomData<L>,
}

impl<'a, L: Lanes<Mask = bool, Bits = u32>> Visited<'a, L> {
    pub(crate) fn of(parts: &'a Parts<'a>) -> Self {
        Self { parts, kind: PhantomData }
    }

    fn answer(&self, ray: &Ray) -> Option<Hit> {
        let mut triangles = Vec::new();
        Walk::new(self.parts).visit(ray, |record, _| {
            triangles.extend(self.parts.triangles_of(&self.parts.records[record as usize]));
        });
        closest::<L>(&self.parts.frame.canonical(ray)?, triangles.into_iter())
    }

    fn is_occluded(&self, ray: &Ray) -> bool {
        self.answer(ray).is_some()
    }
}
tracer!(Visited<L: ScalarLanes>);

/// Lanes of one number.
pub(crate) trait ScalarLanes: Lanes<Mask = bool, Bits = u32> {}
impl<L: Lanes<Mask = bool, Bits = u32>> ScalarLanes for L {}

/// What a canonical ray hits, with t'.
fn hits<L: ScalarLanes>(
    ray: &CanonicalRay,
    triangles: impl Iterator<Item = (u32, [[f32; 3]; 3])>,
) -> impl Iterator<Item = Hit> {
    let number = |x: L| f32::from_bits(x.bits());
    let (shear, axes) = Shear::<L>::new(ray);
    triangles.filter_map(move |(primitive, corners)| {
        let (accepted, found) = intersect(&shear, corners.map(|corner| axes.map(|axis| L::splat(corner[axis]))));
        let t = number(found.t);
        let hit = Hit { t, u: number(found.u), v: number(found.v), primitive };
        (accepted && ray.t_min < t && t < ray.t_max).then_some(hit)
    })
}

/// The smallest (t', primitive) of the triangles that a canonical ray hits.
fn closest<L: ScalarLanes>(ray: &CanonicalRay, triangles: impl Iterator<Item = (u32, [[f32; 3]; 3])>) -> Option<Hit> {
    let order = |a: &Hit, b: &Hit| a.t.total_cmp(&b.t).then(a.primitive.cmp(&b.primitive));
    hits::<L>(ray, triangles).min_by(order).map(|hit| Hit { t: ray.clock.reported(hit.t), ..hit })
}
