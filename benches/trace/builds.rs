//! Build times, and bytes a triangle.

use leafwalk::{Builder, Mesh};
use leafwalk_rivals::{Rival, ours, timed_by_wall};
use leafwalk_testing::truth::Counts;

use crate::report::{Measure, Row};

/// Builds the structure of each tracer `rounds` times, in turns, by CPU time; and ours on two threads, by the clock on
/// the wall.
pub(crate) fn run(rounds: u32, scene: &str, mesh: &Mesh, tracers: &[Box<dyn Rival + '_>]) -> Vec<Row> {
    let pair = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("two threads");
    let mut on_two = Vec::new();
    let mut times = vec![Vec::new(); tracers.len()];
    for _ in 0..rounds {
        for (rival, times) in tracers.iter().zip(&mut times) {
            times.extend(rival.rebuild(mesh).map(|time| time.as_secs_f64()));
        }
        let (_, time) = pair.install(|| timed_by_wall(|| Builder::new().build(mesh).is_ok()));
        on_two.push(time.as_secs_f64());
    }
    let row = |threads, tracer: &str, is_ours, seconds: Vec<f64>, bytes| Row {
        scene: scene.into(),
        triangles: mesh.triangles.len(),
        measure: Measure::Build { threads },
        tracer: tracer.into(),
        is_ours,
        seconds,
        hits: 0,
        counts: Counts::default(),
        bytes,
    };
    let one = tracers.iter().zip(times).filter(|(_, times)| !times.is_empty());
    let one = one.map(|(rival, times)| {
        // One way to call a tracer stands for all of them.
        let name = rival.name().trim_end_matches(" single");
        row(1, name, rival.is_ours(), times, rival.bytes())
    });
    one.chain([row(2, ours::DEFAULT, true, on_two, None)]).filter(|row| !row.seconds.is_empty()).collect()
}
