//! The crate bvh.
//!
//! It offers shapes in order of distance, strictly (with a heap) or roughly (with a stack); closest hits go faster by
//! the first on large meshes, occlusion by the second. It leaves triangles to its user: they are tested as obvhs tests
//! them, since the crate's own test sees one side only and takes determinants under 1.2e-7, which are all of those of a
//! fine mesh, for 0.

use core::time::Duration;

use bvh::aabb::{Aabb, Bounded};
use bvh::bounding_hierarchy::BHShape;
use bvh::bvh::Bvh;
use leafwalk::{Mesh, Ray};
use nalgebra::{Point3, Vector3};
use obvhs::rt_triangle::RtTriangle;

use super::{Answer, OneByOne, Prepared, Rival, timed, triangle};

struct Shape {
    bounds: Aabb<f32, 3>,
    triangle: RtTriangle,
    primitive: u32,
    node: usize,
}

impl Bounded<f32, 3> for Shape {
    fn aabb(&self) -> Aabb<f32, 3> {
        self.bounds
    }
}

impl BHShape<f32, 3> for Shape {
    fn set_bh_node_index(&mut self, node: usize) {
        self.node = node;
    }
    fn bh_node_index(&self) -> usize {
        self.node
    }
}

/// A ray in both of its forms, and its length of direction.
struct Form {
    boxes: bvh::ray::Ray<f32, 3>,
    triangles: obvhs::ray::Ray,
    length: f32,
}

fn form(ray: &Ray) -> Form {
    let direction = Vector3::from(ray.direction);
    let boxes = bvh::ray::Ray::new(Point3::from(ray.origin), direction);
    let length = direction.norm();
    let (t_min, t_max) = (ray.t_min * length, ray.t_max * length);
    let unit: [f32; 3] = boxes.direction.into();
    let triangles = obvhs::ray::Ray::new(ray.origin.into(), unit.into(), t_min, t_max);
    Form { boxes, triangles, length }
}

/// The crate's only structure.
pub struct Plain {
    bvh: Bvh<f32, 3>,
    shapes: Vec<Shape>,
}

impl Plain {
    /// Builds it; with the time that took.
    pub fn new(mesh: &Mesh) -> (Self, Duration) {
        let shape = |(primitive, triangle): (u32, &obvhs::triangle::Triangle)| {
            let corners = [triangle.v0, triangle.v1, triangle.v2].map(|corner| Point3::from(corner.to_array()));
            let bounds = corners.iter().fold(Aabb::empty(), |bounds, corner| bounds.grow(corner));
            Shape { bounds, triangle: triangle.into(), primitive, node: 0 }
        };
        let mut shapes: Vec<Shape> = (0..).zip(&triangle::all(mesh)).map(shape).collect();
        let (bvh, time) = timed(|| Bvh::build(&mut shapes));
        (Self { bvh, shapes }, time)
    }

    fn trace(&self, ray: &Form) -> Answer {
        let mut limited = ray.triangles;
        let mut best = Answer::MISS;
        for shape in self.bvh.nearest_traverse_iterator(&ray.boxes, &self.shapes) {
            // Boxes come nearest first.
            let entry = ray.boxes.intersection_slice_for_aabb(&shape.bounds);
            if entry.is_some_and(|(entry, _)| entry > limited.tmax) {
                break;
            }
            let t = shape.triangle.intersect(&limited);
            if t < limited.tmax {
                limited.tmax = t;
                best = Answer { t, primitive: shape.primitive };
            }
        }
        best
    }

    fn is_occluded(&self, ray: &Form) -> bool {
        let mut shapes = self.bvh.nearest_child_traverse_iterator(&ray.boxes, &self.shapes);
        shapes.any(|shape| shape.triangle.intersect(&ray.triangles) < ray.triangles.tmax)
    }
}

impl Rival for Plain {
    fn name(&self) -> &str {
        "bvh"
    }
    fn bytes(&self) -> Option<usize> {
        Some(size_of_val(&self.bvh.nodes[..]) + size_of_val(&self.shapes[..]))
    }
    fn rebuild(&self, mesh: &Mesh) -> Option<Duration> {
        Some(Self::new(mesh).1)
    }
    fn closest<'a>(&'a self, rays: &'a [Ray]) -> Box<dyn Prepared<Answer> + 'a> {
        let convert = |ray: &Form, hit: &Answer| Answer { t: hit.t / ray.length, ..*hit };
        Box::new(OneByOne::new(rays, form, Answer::MISS, |ray: &_| self.trace(ray), convert))
    }
    fn occluded<'a>(&'a self, rays: &'a [Ray]) -> Box<dyn Prepared<bool> + 'a> {
        let trace = |ray: &_| self.is_occluded(ray);
        Box::new(OneByOne::new(rays, form, false, trace, |_: &_, occluded: &bool| *occluded))
    }
}
