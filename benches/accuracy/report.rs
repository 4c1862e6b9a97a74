//! Rows, as a table to read, for CSV and as a chart.

use core::error::Error;
use core::time::Duration;
use std::fs;
use std::path::Path;

use leafwalk_compare::charts::{Point, speed_and_faults};
use leafwalk_compare::measure::Accuracy;
use leafwalk_compare::truth::{Counts, per_million};

/// A method on a sample.
pub(crate) struct Row {
    pub(crate) scene: String,
    pub(crate) triangles: usize,
    pub(crate) method: String,
    pub(crate) family: &'static str,
    pub(crate) test: &'static str,
    pub(crate) handling: String,
    pub(crate) bytes: Option<usize>,
    pub(crate) build: Option<Duration>,
    /// Millions of typical rays a second.
    pub(crate) speed: f64,
    /// `typical` or `hard`.
    pub(crate) rays_of: &'static str,
    pub(crate) accuracy: Accuracy,
}

#[derive(Default)]
pub(crate) struct Report {
    rows: Vec<Row>,
}

const COLUMNS: &str = "scene,triangles,method,family,test,handling,bytes_per_triangle,build_seconds,mrays_per_second,\
                       rays_of,rays,neighbour,off,wrong,missed,false,faults_per_1e9,from_95,to_95,\
                       t_ulp_median,t_ulp_999,t_ulp_most";

impl Row {
    fn csv(&self) -> String {
        let Counts { rays, neighbours, off, wrong, missed, not_there } = self.accuracy.counts;
        let [share, from, to] = per_million(self.accuracy.counts.faults(), rays).map(|rate| 1e3 * rate);
        let [median, most_of, most] = self.accuracy.t_error;
        let bytes = self.bytes.map_or(String::new(), |bytes| format!("{:.1}", bytes as f64 / self.triangles as f64));
        let build = self.build.map_or(String::new(), |build| format!("{:.4}", build.as_secs_f64()));
        let Self { scene, triangles, method, family, test, handling, speed, rays_of, .. } = self;
        format!(
            "{scene},{triangles},\"{method}\",{family},{test},{handling},{bytes},{build},{speed:.3},{rays_of},{rays},\
             {neighbours},{off},{wrong},{missed},{not_there},{share:.1},{from:.1},{to:.1},{median:.2},{most_of:.2},\
             {most:.2}"
        )
    }
}

impl Report {
    pub(crate) fn add(&mut self, row: Row) {
        self.rows.push(row);
    }

    pub(crate) fn print(&self) {
        println!(
            "scene         rays     method                            Mrays/s  bytes  faults per 1e9   t error in ulp"
        );
        for row in &self.rows {
            let counts = &row.accuracy.counts;
            let [share, ..] = per_million(counts.faults(), counts.rays).map(|rate| 1e3 * rate);
            let bytes = row.bytes.map_or(f64::NAN, |bytes| bytes as f64 / row.triangles as f64);
            let [median, most_of, most] = row.accuracy.t_error;
            println!(
                "{:<13} {:<8} {:<32} {:>8.2} {bytes:>6.1} {share:>15.0}  {median:.2} {most_of:.2} {most:.1}",
                row.scene, row.rays_of, row.method, row.speed
            );
        }
    }

    /// Writes all rows, and the chart of the first scene's.
    pub(crate) fn write(&self, folder: &Path) -> Result<(), Box<dyn Error>> {
        // Cargo runs benches in the folder of their package.
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder);
        fs::create_dir_all(&folder)?;
        let rows: Vec<String> = self.rows.iter().map(Row::csv).collect();
        fs::write(folder.join("accuracy.csv"), format!("{COLUMNS}\n{}\n", rows.join("\n")))?;
        let Some(Row { scene, .. }) = self.rows.first() else { return Ok(()) };
        let points = |rays_of| {
            let rows = self.rows.iter().filter(|row| row.scene == *scene && row.rays_of == rays_of);
            let point = |row: &Row| Point {
                name: row.method.clone(),
                family: row.family.into(),
                speed: row.speed,
                counts: row.accuracy.counts,
            };
            best_of_embree(rows.map(point).collect())
        };
        let titles =
            ["the rays of a renderer", "rays aimed where methods fail"].map(|title| format!("{scene}: {title}"));
        let panels = [(titles[0].as_str(), points("typical")), (titles[1].as_str(), points("hard"))];
        fs::write(folder.join("accuracy.svg"), speed_and_faults(&panels)?)?;
        println!("written to accuracy.csv and accuracy.svg in {}", folder.display());
        Ok(())
    }
}

/// Of the ways to call Embree with the same settings, which answer alike, a chart shows the fastest.
fn best_of_embree(points: Vec<Point>) -> Vec<Point> {
    let setting = |point: &Point| match point.name.as_str() {
        name if name.contains("ROBUST") => "Embree, robust",
        name if name.contains("COMPACT") => "Embree, compact",
        _ => "Embree",
    };
    let (embree, mut others): (Vec<_>, Vec<_>) = points.into_iter().partition(|point| point.family == "Embree");
    for name in ["Embree", "Embree, robust", "Embree, compact"] {
        let calls = embree.iter().filter(|point| setting(point) == name);
        let fastest = calls.max_by(|a, b| a.speed.total_cmp(&b.speed));
        others.extend(fastest.map(|point| Point { name: name.into(), ..point.clone() }));
    }
    others
}
