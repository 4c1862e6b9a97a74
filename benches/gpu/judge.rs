//! Answers beside the CPU's.

use leafwalk::{CpuTracer, Hit, Octree, Ray, Tracer};
use leafwalk_testing::tally::differing;
use leafwalk_testing::workloads::Workload;

use crate::contender::OCCLUDED;

/// How far, in sizes of the scene, a hit may lie from the CPU's: three orders of magnitude above what f32 rounds hits by,
/// and one or more below the thickness of things.
const DISTANCE: f64 = 1e-4;

/// The CPU's answers to a workload.
pub(crate) struct Judge<'a> {
    rays: &'a [Ray],
    expected: Vec<Hit>,
    /// The scene's extent.
    size: f64,
}

impl<'a> Judge<'a> {
    pub(crate) fn new(octree: &Octree<Vec<u32>>, workload: &'a Workload) -> Self {
        let bounds = octree.bounds();
        let size = (0..3).map(|k| bounds.upper[k] - bounds.lower[k]).fold(0.0, f64::max);
        let (tracer, rays) = (CpuTracer::new(octree.view()), &workload.rays[..]);
        let mut expected = vec![Hit::MISS; rays.len()];
        if workload.is_occlusion {
            let mut occluded = vec![false; rays.len()];
            tracer.occlusions(rays, &mut occluded).expect("equal lengths");
            expected = occluded.into_iter().map(|occluded| if occluded { OCCLUDED } else { Hit::MISS }).collect();
        } else {
            tracer.closest_hits(rays, &mut expected).expect("equal lengths");
        }
        Self { rays, expected, size }
    }

    /// How many answers miss where the CPU hits, hit where it misses, or lie elsewhere.
    pub(crate) fn wrong(&self, found: &[Hit]) -> usize {
        let is_wrong = |ray: &Ray, found: &Hit, expected: &Hit| {
            let length = ray.direction.iter().map(|c| f64::from(*c).powi(2)).sum::<f64>().sqrt();
            let is_off = (f64::from(found.t) - f64::from(expected.t)).abs() * length > DISTANCE * self.size;
            found.is_miss() != expected.is_miss() || (!found.is_miss() && is_off)
        };
        let answers = self.rays.iter().zip(found.iter().zip(&self.expected));
        answers.filter(|(ray, (found, expected))| is_wrong(ray, found, expected)).count()
    }

    /// How many answers differ in any bit.
    pub(crate) fn differing(&self, found: &[Hit]) -> usize {
        differing(found, &self.expected)
    }
}
