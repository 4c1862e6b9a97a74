//! The bars that issue 3 sets, and where we stand.

use crate::rivals::{Family, ours};

use crate::earlier::Earlier;
use crate::report::{Measure, Report, Row};

/// One comparison.
struct Bar {
    about: &'static str,
    ratio: f64,
    against: String,
    bar: f64,
    aim: f64,
}

impl Bar {
    fn new(about: &'static str, ours: &Row, rival: &Row, bar: f64, aim: f64) -> Self {
        Self { about, ratio: ours.speed_over(rival), against: rival.tracer.clone(), bar, aim }
    }
}

/// Prints, for each scene, how fast ours is beside the fastest way to call each rival, and beside a native build.
pub(crate) fn print(report: &Report, native: Option<&Earlier>) {
    println!("\n{:>14} {:>6} {:>26} {:>26} {:>7} {:>6} {:>5}", "bars", "rays", "", "against", "ours/it", "bar", "aim");
    for scene in report.scenes() {
        for letter in ["P", "S", "D", "R"] {
            let rows: Vec<&Row> = report.rows(scene, Measure::Rays(letter)).collect();
            for bar in bars(scene, letter, &rows) {
                line(scene, letter, &bar);
            }
            let ours = rows.iter().filter(|row| row.family == Family::Ours);
            for (row, ratio) in ours.filter_map(|row| Some((row, native?.ratio(row)?))) {
                let against = row.tracer.clone();
                line(scene, letter, &Bar { about: "native build", ratio, against, bar: 0.9, aim: 1.0 });
            }
        }
        let rows: Vec<&Row> = report.rows(scene, Measure::Build { threads: 1 }).collect();
        if let (Some(ours), Some(embree)) = (named(&rows, ours::DEFAULT), fastest(&rows, Family::Embree)) {
            line(scene, "", &Bar::new("build", ours, embree, 1.0, 2.0));
        }
    }
}

fn line(scene: &str, letter: &str, bar: &Bar) {
    let verdict = match bar.ratio {
        ratio if ratio >= bar.aim => "aim met",
        ratio if ratio >= bar.bar => "met",
        _ => "missed",
    };
    println!(
        "{scene:>14} {letter:>6} {:>26} {:>26} {:>7.2} {:>6.2} {:>5.2} {verdict}",
        bar.about, bar.against, bar.ratio, bar.bar, bar.aim
    );
}

fn bars(scene: &str, letter: &str, rows: &[&Row]) -> Vec<Bar> {
    let Some(ours) = named(rows, ours::DEFAULT) else { return Vec::new() };
    let (bar, aim) = match (letter, scene) {
        ("P", "conference") => (0.8, 1.15),
        ("P" | "R", _) => (1.15, 1.5),
        _ => (1.0, 1.3),
    };
    let embree = fastest(rows, Family::Embree);
    let mut bars: Vec<Bar> =
        embree.map(|embree| Bar::new("Embree's best", ours, embree, bar, aim)).into_iter().collect();
    #[cfg(feature = "embree")]
    if let (Some(single), Some(embree)) = (named(rows, ours::SINGLE), named(rows, crate::rivals::embree::SINGLE)) {
        bars.push(Bar::new("one ray a call", single, embree, 0.7, 1.0));
    }
    for (about, family) in [("obvhs", Family::Obvhs), ("parry3d", Family::Parry), ("tinybvh", Family::TinyBvh)] {
        bars.extend(fastest(rows, family).map(|rival| Bar::new(about, ours, rival, 1.5, 2.0)));
    }
    bars
}

fn named<'a>(rows: &[&'a Row], tracer: &str) -> Option<&'a Row> {
    rows.iter().copied().find(|row| row.tracer == tracer)
}

fn fastest<'a>(rows: &[&'a Row], family: Family) -> Option<&'a Row> {
    let seconds = |row: &Row| row.median_seconds();
    rows.iter().copied().filter(|row| row.family == family).min_by(|a, b| seconds(a).total_cmp(&seconds(b)))
}
