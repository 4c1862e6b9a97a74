//! The tracers that we compare with, each behind the same two questions.
#![forbid(unsafe_code)]

use core::time::Duration;
use std::time::Instant;

use leafwalk::{Mesh, Octree, Ray};
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::RayHit;
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;
use parry3d::math::Vector;
use parry3d::query::RayCast;
use parry3d::shape::TriMesh;

/// A tracer under measurement: how many of the rays hit.
pub trait Rival {
    /// As tables print it.
    fn name(&self) -> &'static str;
    /// Traces to the closest hit.
    fn closest(&self, rays: &[Ray]) -> usize;
    /// Traces to any hit.
    fn occluded(&self, rays: &[Ray]) -> usize;
}

/// Our scalar tracer.
pub struct Scalar<'a>(pub Octree<&'a [u32]>);

impl Rival for Scalar<'_> {
    fn name(&self) -> &'static str {
        "leafwalk scalar"
    }
    fn closest(&self, rays: &[Ray]) -> usize {
        let mut hits = vec![leafwalk::Hit::MISS; rays.len()];
        leafwalk::Tracer::closest_hits(&self.0, rays, &mut hits).expect("equal lengths");
        hits.iter().filter(|hit| !hit.is_miss()).count()
    }
    fn occluded(&self, rays: &[Ray]) -> usize {
        let mut occluded = vec![false; rays.len()];
        leafwalk::Tracer::occlusions(&self.0, rays, &mut occluded).expect("equal lengths");
        occluded.into_iter().filter(|occluded| *occluded).count()
    }
}

fn obvhs_triangles(mesh: &Mesh) -> Vec<Triangle> {
    let corner = |p: [f32; 3]| glam::Vec3A::from_array(p);
    (0..mesh.triangles.len()).map(|i| mesh.corners(i).map(corner)).map(|[v0, v1, v2]| Triangle { v0, v1, v2 }).collect()
}

fn obvhs_ray(ray: &Ray) -> obvhs::ray::Ray {
    let (origin, direction) = (ray.origin.into(), ray.direction.into());
    obvhs::ray::Ray::new(origin, direction, ray.t_min, ray.t_max)
}

/// obvhs's eight-wide compressed BVH, triangles in traversal order.
pub struct Cwbvh {
    bvh: CwBvh,
    triangles: Vec<RtTriangle>,
}

impl Cwbvh {
    /// Builds it.
    pub fn new(mesh: &Mesh) -> Self {
        let triangles = obvhs_triangles(mesh);
        let bvh = build_cwbvh_from_tris(&triangles, BvhBuildParams::slow_build(), &mut Duration::default());
        let triangles = bvh.primitive_indices.iter().map(|i| (&triangles[*i as usize]).into()).collect();
        Self { bvh, triangles }
    }
}

impl Rival for Cwbvh {
    fn name(&self) -> &'static str {
        "obvhs cwbvh"
    }
    fn closest(&self, rays: &[Ray]) -> usize {
        let trace = |ray: &&Ray| {
            self.bvh.ray_traverse(obvhs_ray(ray), &mut RayHit::none(), |ray, id| self.triangles[id].intersect(ray))
        };
        rays.iter().filter(trace).count()
    }
    fn occluded(&self, rays: &[Ray]) -> usize {
        let trace =
            |ray: &&Ray| !self.bvh.ray_traverse_miss(obvhs_ray(ray), |ray, id| self.triangles[id].intersect(ray));
        rays.iter().filter(trace).count()
    }
}

/// obvhs's binary BVH.
pub struct Binary {
    bvh: Bvh2,
    triangles: Vec<RtTriangle>,
}

impl Binary {
    /// Builds it.
    pub fn new(mesh: &Mesh) -> Self {
        let triangles = obvhs_triangles(mesh);
        let bvh = build_bvh2_from_tris(&triangles, BvhBuildParams::slow_build(), &mut Duration::default());
        let triangles = bvh.primitive_indices.iter().map(|i| (&triangles[*i as usize]).into()).collect();
        Self { bvh, triangles }
    }
}

impl Rival for Binary {
    fn name(&self) -> &'static str {
        "obvhs bvh2"
    }
    fn closest(&self, rays: &[Ray]) -> usize {
        let trace = |ray: &&Ray| {
            self.bvh.ray_traverse(obvhs_ray(ray), &mut RayHit::none(), |ray, id| self.triangles[id].intersect(ray))
        };
        rays.iter().filter(trace).count()
    }
    fn occluded(&self, rays: &[Ray]) -> usize {
        let trace =
            |ray: &&Ray| !self.bvh.ray_traverse_miss(obvhs_ray(ray), |ray, id| self.triangles[id].intersect(ray));
        rays.iter().filter(trace).count()
    }
}

/// parry3d's BVH of a triangle mesh.
pub struct Parry(TriMesh);

impl Parry {
    /// Builds it.
    pub fn new(mesh: &Mesh) -> Self {
        let vertices = mesh.positions.iter().map(|p| Vector::from_array(*p)).collect();
        Self(TriMesh::new(vertices, mesh.triangles.clone()).expect("a mesh with triangles"))
    }
}

impl Rival for Parry {
    fn name(&self) -> &'static str {
        "parry3d"
    }
    fn closest(&self, rays: &[Ray]) -> usize {
        let trace = |ray: &&Ray| {
            let local = parry3d::query::Ray::new(ray.origin.into(), ray.direction.into());
            self.0.cast_local_ray(&local, ray.t_max.min(f32::MAX), false).is_some()
        };
        rays.iter().filter(trace).count()
    }
    fn occluded(&self, rays: &[Ray]) -> usize {
        self.closest(rays)
    }
}

/// Runs something and says how long it took.
pub fn timed<T>(run: impl FnOnce() -> T) -> (T, Duration) {
    let start = Instant::now();
    let result = run();
    (result, start.elapsed())
}
