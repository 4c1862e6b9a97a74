//! The crate obvhs, by its slow build.

use core::time::Duration;

use leafwalk::{Mesh, Ray};
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::RayHit;
use obvhs::rt_triangle::RtTriangle;

use super::{Answer, OneByOne, Prepared, Rival, timed, triangle};

fn form(ray: &Ray) -> obvhs::ray::Ray {
    obvhs::ray::Ray::new(ray.origin.into(), ray.direction.into(), ray.t_min, ray.t_max)
}

fn in_order(triangles: &[obvhs::triangle::Triangle], order: &[u32]) -> Vec<RtTriangle> {
    order.iter().map(|i| (&triangles[*i as usize]).into()).collect()
}

/// Declares a kind of BVH; they differ in type, not in what they offer.
macro_rules! rival {
    ($(#[$about:meta])* $rival:ident, $name:literal, $bvh:ty, $build:ident) => {
        $(#[$about])*
        pub struct $rival {
            bvh: $bvh,
            /// In traversal order.
            triangles: Vec<RtTriangle>,
        }

        impl $rival {
            /// Builds it; with the time that took.
            pub fn new(mesh: &Mesh) -> (Self, Duration) {
                let triangles = triangle::all(mesh);
                timed(|| {
                    let bvh = $build(&triangles, BvhBuildParams::slow_build(), &mut Duration::default());
                    let triangles = in_order(&triangles, &bvh.primitive_indices);
                    Self { bvh, triangles }
                })
            }
        }

        impl Rival for $rival {
            fn name(&self) -> &str {
                $name
            }
            fn bytes(&self) -> Option<usize> {
                let order = size_of_val(&self.bvh.primitive_indices[..]);
                Some(size_of_val(&self.bvh.nodes[..]) + order + size_of_val(&self.triangles[..]))
            }
            fn rebuild(&self, mesh: &Mesh) -> Option<Duration> {
                Some(Self::new(mesh).1)
            }
            fn closest<'a>(&'a self, rays: &'a [Ray]) -> Box<dyn Prepared<Answer> + 'a> {
                let trace = |ray: &obvhs::ray::Ray| {
                    let mut hit = RayHit::none();
                    self.bvh.ray_traverse(*ray, &mut hit, |ray, id| self.triangles[id].intersect(ray));
                    hit
                };
                let convert = |_: &_, hit: &RayHit| match self.bvh.primitive_indices.get(hit.primitive_id as usize) {
                    Some(primitive) => Answer { t: hit.t, primitive: *primitive },
                    None => Answer::MISS,
                };
                Box::new(OneByOne::new(rays, form, RayHit::none(), trace, convert))
            }
            fn occluded<'a>(&'a self, rays: &'a [Ray]) -> Box<dyn Prepared<bool> + 'a> {
                let trace = |ray: &obvhs::ray::Ray| {
                    !self.bvh.ray_traverse_miss(*ray, |ray, id| self.triangles[id].intersect(ray))
                };
                Box::new(OneByOne::new(rays, form, false, trace, |_: &_, occluded: &bool| *occluded))
            }
        }
    };
}

rival!(
    /// The eight-wide compressed BVH.
    Cwbvh,
    "obvhs cwbvh",
    CwBvh,
    build_cwbvh_from_tris
);
rival!(
    /// The binary BVH.
    Binary,
    "obvhs bvh2",
    Bvh2,
    build_bvh2_from_tris
);
