//! `Sample`: rays whose closest hits are known exactly.

use leafwalk_core::{Hit, Ray};
use leafwalk_cpu::{BuildError, Builder, Mesh};

use super::quantile::quantile;
use crate::random::Random;
use crate::truth::{self, Counts, Oracle, Slack, Verdict};
use crate::{rays, workloads};

/// Rays, and the truth about them.
pub struct Sample<'a> {
    oracle: &'a Oracle,
    slack: Slack,
    rays: Vec<Ray>,
    truths: Vec<Option<truth::Hit>>,
}

/// How right the answers to a sample are.
#[derive(Clone, Copy, Debug)]
pub struct Accuracy {
    /// All answers by their verdicts. A t is off where it is so by more than docs/contract.md lets rounding take it, too: next to
    /// where a ray starts, no t of f32 is right to a share of itself.
    pub counts: Counts,
    /// How far t is off where the triangle is right: the median, 99.9 % and the worst, in distances from one f32 to the
    /// next at that t.
    pub t_error: [f64; 3],
}

impl<'a> Sample<'a> {
    /// Of any rays.
    pub fn new(oracle: &'a Oracle, rays: Vec<Ray>) -> Self {
        let truths = oracle.closest_hits(&rays);
        Self { oracle, slack: oracle.slack(), rays, truths }
    }

    /// Of what a renderer asks: primary rays, shadow rays, bounces and chords, about `side` squared each. `inside` says that
    /// the scene is seen from inside.
    ///
    /// # Errors
    /// When the mesh can't be built.
    pub fn typical(oracle: &'a Oracle, mesh: &Mesh, inside: bool, side: u32) -> Result<Self, BuildError> {
        let octree = Builder::new().build(mesh)?;
        let workloads = workloads::all(&octree, mesh, inside, side);
        Ok(Self::new(oracle, workloads.into_iter().flat_map(|workload| workload.rays).collect()))
    }

    /// Of rays aimed where methods fail, from where they start to infinity: not every tracer has limits.
    pub fn hard(oracle: &'a Oracle, mesh: &Mesh, count: u64, seed: u64) -> Self {
        let (centre, size) = rays::extent(mesh);
        let ray = |index| {
            let Ray { origin, direction, .. } = rays::hard(mesh, centre, size, &mut Random::new(seed, index));
            Ray::new(origin, direction)
        };
        Self::new(oracle, (0..count).map(ray).collect())
    }

    /// The rays.
    pub fn rays(&self) -> &[Ray] {
        &self.rays
    }

    fn is_off(&self, ray: &Ray, hit: &Hit) -> bool {
        self.oracle.excess(ray, Some((hit.t, hit.primitive)), &self.slack).depth > 1.0
    }

    /// Judges answers, one a ray, by t and primitive.
    ///
    /// # Panics
    /// When there are not as many answers as rays.
    pub fn judge(&self, hits: &[Hit]) -> Accuracy {
        assert_eq!(hits.len(), self.rays.len(), "one answer a ray");
        let mut counts = Counts::default();
        let mut errors = Vec::new();
        for ((ray, truth), hit) in self.rays.iter().zip(&self.truths).zip(hits) {
            let verdict = match self.oracle.judge(ray, truth.as_ref(), hit.t, hit.primitive) {
                Verdict::Off if !self.is_off(ray, hit) => Verdict::Right,
                verdict => verdict,
            };
            counts.add(verdict);
            if let (Verdict::Right, Some(truth)) = (verdict, truth) {
                let t = truth.t as f32;
                let ulp = f64::from(t.abs().next_up()) - f64::from(t.abs());
                errors.push((f64::from(hit.t) - truth.t).abs() / ulp);
            }
        }
        Accuracy { counts, t_error: [0.5, 0.999, 1.0].map(|share| quantile(&mut errors, share)) }
    }
}

#[cfg(test)]
mod tests {
    use leafwalk_testing::meshes;

    use super::*;
    use crate::methods;

    #[test]
    fn the_contract_s_answers_are_right_and_those_of_another_mesh_are_not() {
        let mesh = meshes::bumpy_sphere(3, 311);
        let oracle = Oracle::new(&mesh);
        let typical = Sample::typical(&oracle, &mesh, false, 64).expect("a mesh that builds");
        let hard = Sample::hard(&oracle, &mesh, 2000, 312);
        let answers = |mesh: &Mesh, sample: &Sample<'_>| {
            let built = methods::named("leafwalk")[0].build(mesh).expect("a mesh that builds");
            let mut hits = vec![Hit::MISS; sample.rays().len()];
            built.tracer.closest_hits(sample.rays(), &mut hits).expect("equal lengths");
            sample.judge(&hits)
        };
        let accuracy = answers(&mesh, &typical);
        assert_eq!((accuracy.counts.faults(), accuracy.counts.rays), (0, typical.rays().len() as u64));
        let [median, _, worst] = accuracy.t_error;
        assert!(0.0 < median && median <= worst, "{accuracy:?}");
        assert!(answers(&mesh, &hard).counts.faults() < 20, "{:?}", answers(&mesh, &hard));
        let moved = answers(&meshes::placed(&mesh, 1.01, 0.0), &typical);
        assert!(8 * moved.counts.faults() > accuracy.counts.rays, "{moved:?}");
    }
}
