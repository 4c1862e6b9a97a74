//! The bars that issue 3 sets, and where we stand.

use crate::report::over;
use crate::table::{Line, Table};
use leafwalk_rivals::ours;

/// One comparison.
struct Bar<'a> {
    about: &'a str,
    against: &'a str,
    ratio: f64,
    bar: f64,
    aim: f64,
}

impl<'a> Bar<'a> {
    /// `None` where it was not measured beside the rival.
    fn new(about: &'a str, ours: &str, rival: Line<'a>, bar: f64, aim: f64) -> Option<Self> {
        Some(Self { about, against: rival.text("tracer"), ratio: rival.number(&over(ours))?, bar, aim })
    }
}

/// Prints, for each scene, how fast ours is beside the fastest way to call each rival, and beside a native build.
pub(crate) fn print(table: &Table, native: Option<&Table>) {
    println!("\n{:>14} {:>6} {:>26} {:>26} {:>7} {:>6} {:>5}", "bars", "rays", "", "against", "ours/it", "bar", "aim");
    for scene in table.scenes() {
        let measured = |measure: &str| -> Vec<Line<'_>> {
            table.lines().filter(|line| line.text("scene") == scene && line.text("measure") == measure).collect()
        };
        for letter in ["P", "S", "D", "R"] {
            let lines = measured(letter);
            let natively = lines.iter().filter_map(|line| beside_native(*line, native?));
            for bar in bars(scene, letter, &lines).into_iter().chain(natively) {
                line(scene, letter, &bar);
            }
        }
        let embree = fastest(&measured("build"), EMBREE);
        if let Some(bar) = embree.and_then(|embree| Bar::new("build", ours::DEFAULT, embree, 1.0, 2.0)) {
            line(scene, "", &bar);
        }
    }
}

fn line(scene: &str, letter: &str, bar: &Bar<'_>) {
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

fn bars<'a>(scene: &str, letter: &str, lines: &[Line<'a>]) -> Vec<Bar<'a>> {
    let (bar, aim) = match (letter, scene) {
        ("P", "conference") => (0.8, 1.15),
        ("P" | "R", _) => (1.15, 1.5),
        _ => (1.0, 1.3),
    };
    let rival = |about, name, bar, aim| Bar::new(about, ours::DEFAULT, fastest(lines, name)?, bar, aim);
    let single = lines.iter().find(|line| line.text("tracer") == EMBREE_SINGLE);
    let bars = [
        rival("Embree's best", EMBREE, bar, aim),
        single.and_then(|single| Bar::new("one ray a call", ours::SINGLE, *single, 0.7, 1.0)),
        rival("obvhs", "obvhs", 1.5, 2.0),
        rival("parry3d", "parry3d", 1.5, 2.0),
        rival("tinybvh", "tinybvh", 1.5, 2.0),
    ];
    bars.into_iter().flatten().collect()
}

const EMBREE: &str = "embree";
const EMBREE_SINGLE: &str = "embree single";

/// Of the ways to call a rival, or of its structures, the fastest; Embree's other settings are not among them.
fn fastest<'a>(lines: &[Line<'a>], rival: &str) -> Option<Line<'a>> {
    let ratio = |line: &Line<'_>| line.number(&over(ours::DEFAULT)).unwrap_or(f64::INFINITY);
    let is_other_setting = |tracer: &str| tracer.contains("ROBUST") || tracer.contains("COMPACT");
    let is_of = |line: &&Line<'_>| {
        let tracer = line.text("tracer");
        tracer.starts_with(rival) && !is_other_setting(tracer)
    };
    lines.iter().filter(is_of).copied().min_by(|a, b| ratio(a).total_cmp(&ratio(b)))
}

/// One of ours beside itself in another build.
fn beside_native<'a>(line: Line<'a>, native: &Table) -> Option<Bar<'a>> {
    let tracer = line.text("tracer");
    let then = native.lines().find(|then| then.key() == line.key() && ours::NAMES.contains(&tracer))?;
    let ratio = line.number("median")? / then.number("median")?;
    Some(Bar { about: "native build", against: tracer, ratio, bar: 0.9, aim: 1.0 })
}
