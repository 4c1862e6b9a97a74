//! The counted walk: how many cells and blocks the primary rays of a picture visit on their way from leaf to leaf.
//!
//! Pictures are traced by a tracer that goes another way and is several times as fast, but does not count its work. The
//! cells and blocks of a report are therefore those of the walk, which takes the same rays, or a sample of them, apart
//! from the picture and its timing.

use leafwalk::{Hit, Octree, Ray, Walk, Work};
use rayon::prelude::*;

use super::primary::PrimaryRays;

/// How many rays a sample has. The number of cells that a ray visits has a standard deviation of about its mean, so the
/// mean over the sample has one of 1 / sqrt(4096) of it, 1.6 %.
pub(crate) const SAMPLE_RAYS: usize = 4096;

/// How many rays were walked, and the sum of their work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Walked {
    pub(crate) rays: u64,
    pub(crate) cells: u64,
    pub(crate) blocks: u64,
}

impl Walked {
    /// Walks a sample of [`SAMPLE_RAYS`] primary rays, or all where there are fewer.
    pub(crate) fn sample<W: AsRef<[u32]> + Sync>(octree: &Octree<W>, primary: &PrimaryRays<'_>) -> Self {
        let mut walked = Self::default();
        walked.add(&closest_hits_with_work(octree, &primary.sample(SAMPLE_RAYS)));
        walked
    }

    /// Adds the work of some rays.
    pub(crate) fn add(&mut self, answers: &[(Hit, Work)]) {
        for (_, work) in answers {
            self.rays += 1;
            self.cells += u64::from(work.cells);
            self.blocks += u64::from(work.blocks);
        }
    }
}

/// The closest hit of each ray and the work of the walk to it, on all threads.
pub(crate) fn closest_hits_with_work<W: AsRef<[u32]> + Sync>(octree: &Octree<W>, rays: &[Ray]) -> Vec<(Hit, Work)> {
    let parts = octree.parts();
    let walk = Walk::new(&parts);
    let answer = |ray: &Ray| {
        let (hit, work) = walk.closest_hit_with_work(ray);
        (Hit::from(hit), work)
    };
    rays.par_iter().map(answer).collect()
}

#[cfg(test)]
mod tests {
    use leafwalk::Builder;

    use super::*;
    use crate::camera::{Camera, Size};
    use crate::scene::{Detail, Scene};

    #[test]
    fn samples_are_walked_and_represent_all_primary_rays() {
        let scene = Scene::room(Detail { bumpy: 3, smooth: 2, knot: [60, 8] });
        let octree = Builder::new().build(&scene.mesh).expect("a finite mesh");
        let count = |rays: &[Ray]| {
            let mut walked = Walked::default();
            walked.add(&closest_hits_with_work(&octree, rays));
            walked
        };
        let camera = Camera::new(&scene.view, Size { width: 160, height: 120 }).expect("a camera");
        for primary in [PrimaryRays::through_middles(&camera), PrimaryRays::jittered(&camera)] {
            let sample = Walked::sample(&octree, &primary);
            assert_eq!(sample.rays, SAMPLE_RAYS as u64);
            assert_eq!(sample, count(&primary.sample(SAMPLE_RAYS)), "other rays were walked");
            let all = count(&primary.sample(usize::MAX));
            assert_eq!(all.rays, primary.count() as u64);
            let share = all.rays as f64 / sample.rays as f64;
            for (of_sample, of_all) in [(sample.cells, all.cells), (sample.blocks, all.blocks)] {
                let ratio = of_sample as f64 * share / of_all as f64;
                assert!((0.95..1.05).contains(&ratio), "{sample:?} stands for {all:?}");
            }
        }
    }

    #[test]
    fn small_pictures_are_walked_whole_by_the_walk_that_single_rays_take() {
        let scene = Scene::room(Detail { bumpy: 0, smooth: 0, knot: [12, 4] });
        let octree = Builder::new().build(&scene.mesh).expect("a finite mesh");
        let camera = Camera::new(&scene.view, Size { width: 61, height: 47 }).expect("a camera");
        let primary = PrimaryRays::through_middles(&camera);
        let mut expected = Walked::default();
        for number in 0..primary.count() {
            let (hit, work) = octree.closest_hit_with_work(&primary.ray(number));
            assert_eq!(hit, octree.closest_hit(&primary.ray(number)));
            expected.rays += 1;
            expected.cells += u64::from(work.cells);
            expected.blocks += u64::from(work.blocks);
        }
        assert!(expected.cells >= expected.rays && expected.blocks > 0, "a test of nothing: {expected:?}");
        assert_eq!(Walked::sample(&octree, &primary), expected);
    }
}
