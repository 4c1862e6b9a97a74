//! The CSV of an earlier run, such as that of another build.

use std::collections::HashMap;
use std::path::Path;
use std::{fs, io};

use crate::report::{COLUMNS, Row};

/// Medians by scene, measure and tracer.
pub(crate) struct Earlier(HashMap<[String; 3], f64>);

impl Earlier {
    /// Reads what [`crate::report::Report::write`] wrote.
    pub(crate) fn read(path: &Path) -> io::Result<Self> {
        let text = fs::read_to_string(path)?;
        let place = |column: &str| COLUMNS.iter().position(|name| *name == column);
        let key = ["scene", "measure", "tracer"].map(place);
        let row = |line: &str| {
            let fields: Vec<&str> = line.split(',').collect();
            let field = |place: Option<usize>| fields.get(place?).map(|field| (*field).to_string());
            let [scene, measure, tracer] = key.map(field);
            Some(([scene?, measure?, tracer?], field(place("median"))?.parse().ok()?))
        };
        Ok(Self(text.lines().skip(1).filter_map(row).collect()))
    }

    /// How many times as fast as then a row of rays is now.
    pub(crate) fn ratio(&self, row: &Row) -> Option<f64> {
        let then = self.0.get(&[row.scene.clone(), row.measure.name(), row.tracer.clone()])?;
        Some(row.median() / then)
    }
}
