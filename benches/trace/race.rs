//! Tracers on the same rays, in turns.

use leafwalk::Ray;
use leafwalk_rivals::{Answer, Prepared, Rival, timed};
use leafwalk_testing::truth::{Counts, Hit, Oracle, Verdict};

/// What a tracer did with a workload.
pub(crate) struct Run {
    /// One time a round.
    pub(crate) seconds: Vec<f64>,
    pub(crate) hits: usize,
    pub(crate) counts: Counts,
}

/// Knows the truth about a workload.
pub(crate) struct Judge<'a> {
    pub(crate) oracle: &'a Oracle,
    pub(crate) rays: &'a [Ray],
    pub(crate) truths: Vec<Option<Hit>>,
}

/// Something that can be right or wrong.
pub(crate) trait Judged {
    fn is_hit(&self) -> bool;
    fn verdict(&self, judge: &Judge<'_>, ray: usize) -> Verdict;
}

impl Judged for Answer {
    fn is_hit(&self) -> bool {
        self.t != f32::INFINITY
    }
    fn verdict(&self, judge: &Judge<'_>, ray: usize) -> Verdict {
        judge.oracle.judge(&judge.rays[ray], judge.truths[ray].as_ref(), self.t, self.primitive)
    }
}

impl Judged for bool {
    fn is_hit(&self) -> bool {
        *self
    }
    fn verdict(&self, judge: &Judge<'_>, ray: usize) -> Verdict {
        Verdict::on_occlusion(judge.truths[ray].as_ref(), *self)
    }
}

/// Judges each tracer's answers and times `rounds` rounds of all of them.
///
/// # Panics
/// When two tracers of ours differ in a bit.
pub(crate) fn run<'a, A: Judged>(
    rounds: u32,
    tracers: &'a [Box<dyn Rival + '_>],
    judge: &Judge<'_>,
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
        let counts = Counts::of((0..).zip(&answers).map(|(ray, answer)| answer.verdict(judge, ray)));
        runs.push(Run { seconds: Vec::new(), hits, counts });
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
