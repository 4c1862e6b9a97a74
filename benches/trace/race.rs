//! Tracers on the same rays, in turns.

use leafwalk_rivals::{Answer, Prepared, Rival, timed};

use crate::truth::Truth;

/// What a tracer did with a workload.
pub(crate) struct Run {
    /// One time a round.
    pub(crate) seconds: Vec<f64>,
    pub(crate) hits: usize,
    pub(crate) wrong: usize,
}

/// Something that can be right or wrong.
pub(crate) trait Judged {
    fn is_hit(&self) -> bool;
    fn is_wrong(&self, truth: &mut Truth<'_>, ray: usize) -> bool;
}

impl Judged for Answer {
    fn is_hit(&self) -> bool {
        self.t != f32::INFINITY
    }
    fn is_wrong(&self, truth: &mut Truth<'_>, ray: usize) -> bool {
        truth.is_wrong_hit(ray, *self)
    }
}

impl Judged for bool {
    fn is_hit(&self) -> bool {
        *self
    }
    fn is_wrong(&self, truth: &mut Truth<'_>, ray: usize) -> bool {
        truth.is_wrong_occlusion(ray, *self)
    }
}

/// Judges each tracer's answers and times `rounds` rounds of all of them.
///
/// # Panics
/// When two tracers of ours differ in a bit.
pub(crate) fn run<'a, A: Judged>(
    rounds: u32,
    tracers: &'a [Box<dyn Rival + '_>],
    truth: &mut Truth<'_>,
    prepare: impl Fn(&'a dyn Rival) -> Box<dyn Prepared<A> + 'a>,
) -> Vec<Run> {
    let mut prepared: Vec<_> = tracers.iter().map(|rival| prepare(&**rival)).collect();
    let mut ours: Option<(&str, u64)> = None;
    let mut runs = Vec::new();
    for (rival, batch) in tracers.iter().zip(&mut prepared) {
        // The round that warms up.
        batch.trace();
        let answers = batch.answers();
        let hits = answers.iter().filter(|answer| answer.is_hit()).count();
        let wrong = (0..).zip(&answers).filter(|(ray, answer)| answer.is_wrong(truth, *ray)).count();
        runs.push(Run { seconds: Vec::new(), hits, wrong });
        if rival.is_ours() {
            let hash = batch.hash().expect("ours hash their answers");
            let (first, expected) = *ours.get_or_insert((rival.name(), hash));
            assert_eq!(hash, expected, "{} answers otherwise than {first}", rival.name());
        }
    }
    for _ in 0..rounds {
        for (batch, run) in prepared.iter_mut().zip(&mut runs) {
            batch.reset();
            run.seconds.push(timed(|| batch.trace()).1.as_secs_f64());
        }
    }
    runs
}
