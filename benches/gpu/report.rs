//! Rows, as a table to read and for CSV.

use core::time::Duration;
use std::path::Path;
use std::{fs, io};

use leafwalk_rivals::quantile;

/// Our flavours and the rival, as tables print them.
pub(crate) const EXACT: &str = "leafwalk exact";
pub(crate) const FAST: &str = "leafwalk fast";
pub(crate) const CWBVH: &str = "cwbvh";

const COLUMNS: [&str; 17] = [
    "adapter",
    "scene",
    "triangles",
    "rays_of",
    "tracer",
    "rounds",
    "unit",
    "median",
    "lower_quartile",
    "upper_quartile",
    "rays",
    "hits",
    "wrong",
    "differing_bits",
    "bytes_per_triangle",
    "leafwalk exact / it",
    "leafwalk fast / it",
];

/// One kernel on one batch.
pub(crate) struct Row {
    pub(crate) scene: String,
    pub(crate) triangles: usize,
    /// The kind of rays, and whether they are a frame or a batch.
    pub(crate) rays_of: String,
    pub(crate) tracer: &'static str,
    /// One a round; none where speed says nothing.
    pub(crate) times: Vec<Duration>,
    pub(crate) rays: usize,
    pub(crate) hits: usize,
    /// Answers that are wrong by the CPU's.
    pub(crate) wrong: usize,
    /// Our hits that differ from the CPU's in any bit.
    pub(crate) differing: Option<usize>,
    /// Bytes of the structure on the device.
    pub(crate) bytes: usize,
}

impl Row {
    /// A quantile of the speeds, in Mrays/s.
    fn speed(&self, at: f64) -> Option<f64> {
        let speeds: Vec<f64> = self.times.iter().map(|time| self.rays as f64 / time.as_secs_f64() / 1e6).collect();
        (!speeds.is_empty()).then(|| quantile(speeds, at))
    }

    fn bytes_per_triangle(&self) -> f64 {
        self.bytes as f64 / self.triangles as f64
    }

    /// How many times as fast as another row this one is: the median over rounds.
    fn speed_over(&self, other: &Self) -> Option<f64> {
        let ratios = self.times.iter().zip(&other.times).map(|(own, other)| other.as_secs_f64() / own.as_secs_f64());
        let ratios: Vec<f64> = ratios.collect();
        (!ratios.is_empty()).then(|| quantile(ratios, 0.5))
    }
}

/// All rows of a run on an adapter.
pub(crate) struct Report {
    adapter: String,
    rows: Vec<Row>,
}

impl Report {
    pub(crate) fn new(adapter: String) -> Self {
        Self { adapter, rows: Vec::new() }
    }

    pub(crate) fn add(&mut self, row: Row) {
        self.rows.push(row);
    }

    /// How many times as fast one of ours is as a row.
    fn over(&self, ours: &str, row: &Row) -> Option<f64> {
        let of_same = |own: &&Row| (&own.scene, &own.rays_of, own.tracer) == (&row.scene, &row.rays_of, ours);
        self.rows.iter().find(of_same)?.speed_over(row)
    }

    /// Prints the head of the tables.
    pub(crate) fn print_head() {
        println!(
            "{:>8} {:>15} {:>9} {:>17} {:>9} {:>9} {:>6} {:>9} {:>9} {:>9} {:>8}",
            "", "", "Mrays/s", "quartiles", "rays", "hits", "wrong", "bits", "bytes/tri", "exact/it", "fast/it"
        );
    }

    /// Prints the last `count` rows.
    pub(crate) fn print_last(&self, count: usize) {
        let number = |value: Option<f64>, digits: usize| value.map_or("-".into(), |value| format!("{value:.digits$}"));
        for row in &self.rows[self.rows.len().saturating_sub(count)..] {
            println!(
                "{:>8} {:>15} {:>9} {:>8} {:>8} {:>9} {:>9} {:>6} {:>9} {:>9.1} {:>9} {:>8}",
                row.rays_of,
                row.tracer,
                number(row.speed(0.5), 1),
                number(row.speed(0.25), 1),
                number(row.speed(0.75), 1),
                row.rays,
                row.hits,
                row.wrong,
                cell(row.differing),
                row.bytes_per_triangle(),
                number(self.over(EXACT, row), 2),
                number(self.over(FAST, row), 2),
            );
        }
    }

    /// Writes all rows. Cells that a row has nothing for stay empty.
    pub(crate) fn write(&self, path: &Path) -> io::Result<()> {
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        let lines = self.rows.iter().map(|row| self.cells(row).join(","));
        let lines = core::iter::once(COLUMNS.join(",")).chain(lines);
        fs::write(path, lines.map(|line| line + "\n").collect::<String>())
    }

    /// As [`COLUMNS`] says.
    fn cells(&self, row: &Row) -> [String; COLUMNS.len()] {
        [
            self.adapter.replace(',', ""),
            row.scene.clone(),
            row.triangles.to_string(),
            row.rays_of.clone(),
            row.tracer.into(),
            row.times.len().to_string(),
            "Mrays/s".into(),
            cell(row.speed(0.5)),
            cell(row.speed(0.25)),
            cell(row.speed(0.75)),
            row.rays.to_string(),
            row.hits.to_string(),
            row.wrong.to_string(),
            cell(row.differing),
            row.bytes_per_triangle().to_string(),
            cell(self.over(EXACT, row)),
            cell(self.over(FAST, row)),
        ]
    }
}

fn cell(value: Option<impl ToString>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}
