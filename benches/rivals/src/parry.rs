//! The crate parry3d.

use core::time::Duration;

use leafwalk::{Mesh, Ray};
use parry3d::math::Vector;
use parry3d::shape::{CompositeShapeRef, TriMesh};

use super::{Answer, OneByOne, Prepared, Rival, timed};

/// The BVH of a triangle mesh.
pub struct Parry(TriMesh);

impl Parry {
    /// Builds it; with the time that took.
    pub fn new(mesh: &Mesh) -> (Self, Duration) {
        let vertices = mesh.positions.iter().map(|p| Vector::from_array(*p)).collect();
        let triangles = mesh.triangles.clone();
        timed(|| Self(TriMesh::new(vertices, triangles).expect("a mesh with triangles")))
    }

    /// It has no limit from below, and all rays here have 0.
    fn cast(&self, (ray, t_max): &(parry3d::query::Ray, f32)) -> Option<(u32, f32)> {
        CompositeShapeRef(&self.0).cast_local_ray(ray, *t_max, false)
    }
}

fn form(ray: &Ray) -> (parry3d::query::Ray, f32) {
    assert_eq!(ray.t_min, 0.0, "parry3d's rays start at 0");
    (parry3d::query::Ray::new(ray.origin.into(), ray.direction.into()), ray.t_max.min(f32::MAX))
}

impl Rival for Parry {
    fn name(&self) -> &str {
        "parry3d"
    }
    fn bytes(&self) -> Option<usize> {
        // It traces the mesh itself, which is its own.
        Some(self.0.heap_memory_size())
    }
    fn rebuild(&self, mesh: &Mesh) -> Option<Duration> {
        Some(Self::new(mesh).1)
    }
    fn closest<'a>(&'a self, rays: &'a [Ray]) -> Box<dyn Prepared<Answer> + 'a> {
        let convert = |_: &_, hit: &Option<(u32, f32)>| match *hit {
            Some((primitive, t)) => Answer { t, primitive },
            None => Answer::MISS,
        };
        Box::new(OneByOne::new(rays, form, None, |ray: &_| self.cast(ray), convert))
    }
    fn occluded<'a>(&'a self, rays: &'a [Ray]) -> Box<dyn Prepared<bool> + 'a> {
        // It offers no search that ends at any hit.
        let trace = |ray: &_| self.cast(ray).is_some();
        Box::new(OneByOne::new(rays, form, false, trace, |_: &_, occluded: &bool| *occluded))
    }
}
