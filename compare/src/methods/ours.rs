//! What this library traces with.

use leafwalk_core::{Hit, LengthMismatch, Ray, Tracer, one_by_one};
use leafwalk_cpu::{BuildError, Builder, CpuTracer, MeshRef, Way};

use super::{Built, Handling, Method};

pub(super) const METHODS: &[Method] = &[
    ours("leafwalk", |mesh| batch(mesh, &Builder::new(), Way::Auto)),
    ours("leafwalk stream", |mesh| batch(mesh, &Builder::new(), Way::Stream)),
    ours("leafwalk interleaved", |mesh| batch(mesh, &Builder::new(), Way::Interleaved)),
    ours("leafwalk walk in lanes", |mesh| batch(mesh, &Builder::for_walks(), Way::Walk)),
    ours("leafwalk compact", |mesh| batch(mesh, &Builder::new().compact(), Way::Auto)),
    ours("leafwalk single", |mesh| {
        let octree = Builder::new().build(mesh)?;
        let bytes = size_of_val(octree.as_words());
        Ok(Built { tracer: Box::new(Single(CpuTracer::new(octree))), bytes })
    }),
    ours("leafwalk scalar walk", |mesh| {
        let octree = Builder::for_walks().build(mesh)?;
        let bytes = size_of_val(octree.as_words());
        Ok(Built { tracer: Box::new(octree), bytes })
    }),
];

const fn ours(name: &'static str, build: fn(MeshRef<'_>) -> Result<Built, BuildError>) -> Method {
    Method { name, family: "leafwalk", test: "exact", handling: Handling::Ours, source: "leafwalk_cpu", build }
}

fn batch(mesh: MeshRef<'_>, builder: &Builder, way: Way) -> Result<Built, BuildError> {
    let octree = builder.build(mesh)?;
    let bytes = size_of_val(octree.as_words());
    Ok(Built { tracer: Box::new(CpuTracer::new(octree).with_way(way)), bytes })
}

/// One ray a call.
struct Single(CpuTracer<Vec<u32>>);

impl Tracer for Single {
    type Error = LengthMismatch;

    fn closest_hits(&self, rays: &[Ray], hits: &mut [Hit]) -> Result<(), LengthMismatch> {
        one_by_one(rays, hits, |ray| Hit::from(self.0.closest_hit(ray)))
    }

    fn occlusions(&self, rays: &[Ray], occluded: &mut [bool]) -> Result<(), LengthMismatch> {
        one_by_one(rays, occluded, |ray| self.0.occluded(ray))
    }
}
