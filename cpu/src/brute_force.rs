//! The oracle: every triangle against every ray, on the same canonical ray and with the same triangle test.

use core::fmt;

use leafwalk_core::layout::{NONE, Triangle};
use leafwalk_core::triangle::{Shear, intersect};
use leafwalk_core::{
    CanonicalRay, Frame, Hit, HitF64, LengthMismatch, Ray, RayF64, Tracer, one_by_one, unroll, weight_of_vertex_2,
};

use crate::build::{BuildError, normalise};
use crate::mesh::MeshRef;

/// Tests all triangles of a mesh; what an octree of the same mesh must agree with bit for bit.
#[derive(Clone)]
pub struct BruteForce {
    pub(crate) frame: Frame,
    /// Every triangle that can be hit.
    pub(crate) triangles: Vec<Triangle>,
}

impl BruteForce {
    /// Normalises the mesh as the builder does.
    ///
    /// # Errors
    /// For the meshes that the builder refuses.
    pub fn new<'a>(mesh: impl Into<MeshRef<'a>>) -> Result<Self, BuildError> {
        let normalised = normalise(mesh.into())?;
        Ok(Self { frame: normalised.frame, triangles: normalised.triangles })
    }

    /// The closest hit of one ray.
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let canonical = self.frame.canonical(ray)?;
        let (t, hit) = self.closest(&canonical)?;
        Some(Hit { t: canonical.clock.reported(t), v: weight_of_vertex_2(hit.u, hit.v), ..hit })
    }

    /// The closest hit of one ray, in f64.
    pub fn closest_hit_f64(&self, ray: &RayF64) -> Option<HitF64> {
        let canonical = self.frame.canonical_f64(ray)?;
        let (t, Hit { u, v, primitive, .. }) = self.closest(&canonical)?;
        Some(HitF64 { t: canonical.clock.reported_f64(t), u, v: weight_of_vertex_2(u, v), primitive })
    }

    /// Every hit of one ray, by its t, then by its primitive.
    pub fn every_hit(&self, ray: &Ray) -> Vec<Hit> {
        let Some(canonical) = self.frame.canonical(ray) else { return Vec::new() };
        let mut found: Vec<_> = self.hits(&canonical).filter(|(_, t, ..)| *t < canonical.t_max).collect();
        found.sort_by(|(a, s, ..), (b, t, ..)| s.total_cmp(t).then(a.cmp(b)));
        let reported =
            |(primitive, t, u, v)| Hit { t: canonical.clock.reported(t), u, v: weight_of_vertex_2(u, v), primitive };
        found.into_iter().map(reported).collect()
    }

    /// The closest hit of a canonical ray with its canonical distance; the hit's own t is not set.
    fn closest(&self, ray: &CanonicalRay) -> Option<(f32, Hit)> {
        let mut best = (ray.t_max, Hit::MISS);
        for (primitive, t, u, v) in self.hits(ray) {
            if t < best.0 || (t == best.0 && primitive < best.1.primitive && best.1.primitive != NONE) {
                best = (t, Hit { t: 0.0, u, v, primitive });
            }
        }
        (!best.1.is_miss()).then_some(best)
    }

    /// All hits beyond `t_min`, as (primitive, t', u, v).
    fn hits<'a>(&'a self, ray: &'a CanonicalRay) -> impl Iterator<Item = (u32, f32, f32, f32)> + 'a {
        let (shear, axes) = Shear::<f32>::new(ray);
        self.triangles.iter().filter_map(move |Triangle { primitive, corners }| {
            let found = intersect(&shear, &unroll!(c in 0..3 => unroll!(k in 0..3 => corners[c][axes[k]])))?;
            (found.t > ray.t_min).then_some((*primitive, found.t, found.u, found.v))
        })
    }
}

impl Tracer for BruteForce {
    type Error = LengthMismatch;

    fn closest_hits(&self, rays: &[Ray], hits: &mut [Hit]) -> Result<(), LengthMismatch> {
        one_by_one(rays, hits, |ray| Hit::from(self.closest_hit(ray)))
    }

    fn occlusions(&self, rays: &[Ray], occluded: &mut [bool]) -> Result<(), LengthMismatch> {
        one_by_one(rays, occluded, |ray| self.closest_hit(ray).is_some())
    }
}

/// Counts instead of triangles, of which there may be millions.
impl fmt::Debug for BruteForce {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("BruteForce").field("triangles", &self.triangles.len()).finish_non_exhaustive()
    }
}
