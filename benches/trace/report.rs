//! What is measured: rows, as a table to read and for CSV.

use crate::table::Table;
use leafwalk_rivals::ours;
use leafwalk_rivals::quantile;
use leafwalk_testing::truth::{Counts, per_million};

/// The columns of the CSV, before those for the ratios of ours to the row's tracer.
const COLUMNS: [&str; 20] = [
    "scene",
    "triangles",
    "measure",
    "tracer",
    "rounds",
    "unit",
    "median",
    "lower_quartile",
    "upper_quartile",
    "rays",
    "hits",
    "wrong",
    "missed",
    "false",
    "neighbours",
    "off",
    "faults_per_million",
    "faults_at_least",
    "faults_at_most",
    "bytes_per_triangle",
];

/// Counts of answers; then those at fault of a million, and between which two that is with 95 % confidence.
const HEAD: &str = "     hits  wrong missed  false   faults, per million      ";

/// All columns of the CSV.
pub(crate) fn columns() -> Vec<String> {
    COLUMNS.map(String::from).into_iter().chain(ours::NAMES.map(over)).collect()
}

/// The column for how many times as fast one of ours is as the row's tracer.
pub(crate) fn over(ours: &str) -> String {
    format!("{ours} / it")
}

/// What a row is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Measure {
    /// Building the structure.
    Build { threads: u32 },
    /// Tracing a workload, by its letter.
    Rays(&'static str),
}

impl Measure {
    pub(crate) fn is_build(self) -> bool {
        matches!(self, Self::Build { .. })
    }
    pub(crate) fn name(self) -> String {
        match self {
            Self::Build { threads: 1 } => "build".into(),
            Self::Build { threads } => format!("build on {threads} threads"),
            Self::Rays(letter) => letter.into(),
        }
    }
}

/// One tracer in one measurement.
pub(crate) struct Row {
    pub(crate) scene: String,
    pub(crate) triangles: usize,
    pub(crate) measure: Measure,
    pub(crate) tracer: String,
    pub(crate) is_ours: bool,
    /// One time a round; rounds of the rows of one measurement belong together.
    pub(crate) seconds: Vec<f64>,
    /// 0 for a build, as all counts.
    pub(crate) hits: usize,
    pub(crate) counts: Counts,
    /// Bytes of the structure.
    pub(crate) bytes: Option<usize>,
}

impl Row {
    /// A quantile of the times, in seconds for a build, else of the speeds, in Mrays/s.
    fn quantile(&self, at: f64) -> f64 {
        let rate =
            |seconds: &f64| if self.measure.is_build() { *seconds } else { self.counts.rays as f64 / seconds / 1e6 };
        quantile(self.seconds.iter().map(rate).collect(), at)
    }

    /// The median of the times, in seconds for a build, else of the speeds, in Mrays/s.
    fn median(&self) -> f64 {
        self.quantile(0.5)
    }

    fn unit(&self) -> &'static str {
        if self.measure.is_build() { "s" } else { "Mrays/s" }
    }

    fn bytes_per_triangle(&self) -> Option<f64> {
        self.bytes.map(|bytes| bytes as f64 / self.triangles as f64)
    }

    /// How many times as fast as another row this one is: the median over rounds.
    fn speed_over(&self, other: &Row) -> f64 {
        quantile(self.seconds.iter().zip(&other.seconds).map(|(own, other)| other / own).collect(), 0.5)
    }

    /// Under [`HEAD`].
    fn judged(&self) -> String {
        let Counts { rays, wrong, missed, not_there, .. } = self.counts;
        let [share, low, high] = per_million(self.counts.faults(), rays);
        format!("{:>9} {wrong:>6} {missed:>6} {not_there:>6} {share:>9.2} {low:>7.2} {high:>9.2}", self.hits)
    }

    /// As [`COLUMNS`] says.
    fn cells(&self) -> [String; COLUMNS.len()] {
        let of_rays = |count: u64| cell((!self.measure.is_build()).then_some(count));
        let Counts { rays, neighbours, off, wrong, missed, not_there } = self.counts;
        let faults = per_million(self.counts.faults(), rays).map(|x| cell((!self.measure.is_build()).then_some(x)));
        let [per_million, at_least, at_most] = faults;
        [
            self.scene.clone(),
            self.triangles.to_string(),
            self.measure.name(),
            self.tracer.clone(),
            self.seconds.len().to_string(),
            self.unit().into(),
            self.median().to_string(),
            self.quantile(0.25).to_string(),
            self.quantile(0.75).to_string(),
            of_rays(rays),
            of_rays(self.hits as u64),
            of_rays(wrong),
            of_rays(missed),
            of_rays(not_there),
            of_rays(neighbours),
            of_rays(off),
            per_million,
            at_least,
            at_most,
            cell(self.bytes_per_triangle()),
        ]
    }
}

/// All rows of a scene.
#[derive(Default)]
pub(crate) struct Report {
    rows: Vec<Row>,
}

impl Report {
    pub(crate) fn add(&mut self, row: Row) {
        self.rows.push(row);
    }

    fn ours(&self, of: &Row) -> Vec<&Row> {
        self.rows.iter().filter(|row| row.is_ours && row.measure == of.measure).collect()
    }

    /// Prints the table of some measures.
    pub(crate) fn print(&self, wanted: impl Fn(Measure) -> bool) {
        let rows: Vec<&Row> = self.rows.iter().filter(|row| wanted(row.measure)).collect();
        let Some(first) = rows.first() else { return };
        let is_build = first.measure.is_build();
        let ours: Vec<&str> = self.ours(first).iter().map(|row| row.tracer.as_str()).collect();
        let ratios: String = ours.iter().map(|name| format!(" {:>18}", over(name))).collect();
        let counts = if is_build { "   bytes/triangle" } else { HEAD };
        println!("\n{:>18} {:>26} {:>9} {:>17} {counts}{ratios}", first.scene, "", first.unit(), "quartiles");
        for row in rows {
            let counts = match (is_build, row.bytes_per_triangle()) {
                (false, _) => row.judged(),
                (true, Some(bytes)) => format!("{bytes:>17.1}"),
                (true, None) => format!("{:>17}", ""),
            };
            let ratios: String = self.ours(row).iter().map(|ours| format!(" {:>18.2}", ours.speed_over(row))).collect();
            println!(
                "{:>18} {:>26} {:>9.3} {:>8.3} {:>8.3} {counts}{ratios}",
                row.measure.name(),
                row.tracer,
                row.median(),
                row.quantile(0.25),
                row.quantile(0.75),
            );
        }
    }

    /// Everything for CSV. Cells that a row has nothing for stay empty.
    pub(crate) fn table(&self) -> Table {
        let cells = |row: &Row| {
            let beside = self.ours(row);
            let ratio = |name| beside.iter().find(|row| row.tracer == name).map(|ours| ours.speed_over(row));
            row.cells().into_iter().chain(ours::NAMES.map(|name| cell(ratio(name)))).collect()
        };
        Table::new(self.rows.iter().map(cells).collect())
    }
}

fn cell(value: Option<impl ToString>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}
