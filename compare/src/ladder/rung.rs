//! `Rung`: a scene and rays at one step of the ladder, and what they do to a method.

use leafwalk_core::{Hit, Ray};
use leafwalk_cpu::{BuildError, Mesh};

use super::axis::Axis;
use crate::measure::{Accuracy, Sample};
use crate::methods::Method;
use crate::random::Random;
use crate::truth::Oracle;

/// A step of an axis.
pub struct Rung {
    /// What is harder.
    pub axis: Axis,
    /// How much, in the axis's own measure.
    pub step: f64,
    mesh: Mesh,
    oracle: Oracle,
    rays: Vec<Ray>,
}

/// What a method makes of a rung.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// How right its answers are.
    pub accuracy: Accuracy,
    /// How many are farther from the truth than docs/contract.md lets rounding take them.
    pub beyond_bounds: u64,
}

impl Rung {
    /// All rungs of an axis, over a mesh, with so many rays each.
    pub fn all(axis: Axis, mesh: &Mesh, rays: u64) -> impl Iterator<Item = Self> {
        axis.steps().into_iter().map(move |step| Self::new(axis, step, mesh, rays))
    }

    /// One of them. Its rays depend on nothing but these arguments.
    pub fn new(axis: Axis, step: f64, mesh: &Mesh, rays: u64) -> Self {
        let scene = axis.scene(mesh, step);
        let ray = |index| axis.ray(&scene, mesh, step, &mut Random::new(401, index));
        Self { axis, step, oracle: Oracle::new(&scene), rays: (0..rays).map(ray).collect(), mesh: scene }
    }

    /// How a method does.
    ///
    /// # Errors
    /// When it can't be built over the scene.
    pub fn climb(&self, method: &Method) -> Result<Outcome, BuildError> {
        let built = method.build(&self.mesh)?;
        let mut hits = vec![Hit::MISS; self.rays.len()];
        built.tracer.closest_hits(&self.rays, &mut hits).expect("as many hits as rays");
        let slack = self.oracle.slack();
        let is_beyond = |(ray, hit): &(&Ray, &Hit)| {
            let answer = (!hit.is_miss()).then_some((hit.t, hit.primitive));
            self.oracle.excess(*ray, answer, &slack).is_fault()
        };
        let beyond_bounds = self.rays.iter().zip(&hits).filter(is_beyond).count() as u64;
        Ok(Outcome { accuracy: Sample::new(&self.oracle, self.rays.clone()).judge(&hits), beyond_bounds })
    }
}

#[cfg(test)]
mod tests {
    use leafwalk_testing::meshes;
    use leafwalk_testing::tally::scaled;

    use super::*;
    use crate::methods::{self, Handling};

    fn mesh() -> Mesh {
        meshes::bumpy_sphere(3, 402)
    }

    /// What must hold: no answer of ours is beyond the contract's bounds, whatever is made harder.
    #[test]
    fn ours_stays_within_its_bounds_on_every_rung() {
        let ours = methods::named("leafwalk")[0];
        assert_eq!(ours.handling, Handling::Ours);
        for axis in Axis::ALL {
            for rung in Rung::all(axis, &mesh(), scaled(2000)) {
                let outcome = rung.climb(&ours).expect("a mesh that builds");
                let counts = outcome.accuracy.counts;
                println!(
                    "{axis} {:e}: {} beyond bounds, {} faults of {}",
                    rung.step,
                    outcome.beyond_bounds,
                    counts.faults(),
                    counts.rays
                );
                assert_eq!(outcome.beyond_bounds, 0, "{axis}, {:e}: {counts:?}", rung.step);
            }
        }
    }

    /// The ladder tells methods apart: what is known to fail does.
    #[test]
    fn a_test_without_margins_leaves_its_bounds() {
        let method = methods::named("BVH, Möller-Trumbore")[0];
        let rung = Rung::new(Axis::Distance, 1e4, &mesh(), 2000);
        let outcome = rung.climb(&method).expect("a mesh that builds");
        assert!(outcome.beyond_bounds > 0 || outcome.accuracy.counts.faults() > 0, "{outcome:?}");
    }
}
