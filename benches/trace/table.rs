//! What was measured, as CSV: scenes of several runs, or the run of another build.

use std::io::{Error, ErrorKind};
use std::path::Path;
use std::{fs, io};

use crate::report::columns;

/// Rows of cells, under [`columns`].
#[derive(Default)]
pub(crate) struct Table(Vec<Vec<String>>);

impl Table {
    pub(crate) fn new(rows: Vec<Vec<String>>) -> Self {
        Self(rows)
    }

    /// Reads what [`Table::write`] wrote.
    pub(crate) fn read(path: &Path) -> io::Result<Self> {
        let text = fs::read_to_string(path)?;
        let mut rows = text.lines().map(|line| line.split(',').map(String::from).collect());
        let of_others = || Error::new(ErrorKind::InvalidData, "it has other columns than this version: move it away");
        if rows.next().is_none_or(|head: Vec<String>| head != columns()) {
            return Err(of_others());
        }
        let table = Self(rows.collect());
        let is_full = table.0.iter().all(|row| row.len() == columns().len());
        if is_full { Ok(table) } else { Err(of_others()) }
    }

    pub(crate) fn write(&self, path: &Path) -> io::Result<()> {
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        let lines = core::iter::once(columns().join(",")).chain(self.0.iter().map(|row| row.join(",")));
        fs::write(path, lines.map(|line| line + "\n").collect::<String>())
    }

    /// Takes all rows of a newer table, and drops its own of the same scenes.
    pub(crate) fn update(&mut self, newer: Self) {
        let scenes = newer.scenes();
        self.0.retain(|row| !scenes.contains(&Line(row).text("scene")));
        self.0.extend(newer.0);
    }

    pub(crate) fn lines(&self) -> impl Iterator<Item = Line<'_>> {
        self.0.iter().map(|row| Line(row))
    }

    /// Scenes in the order of their measurement.
    pub(crate) fn scenes(&self) -> Vec<&str> {
        let mut scenes: Vec<&str> = self.lines().map(|line| line.text("scene")).collect();
        scenes.dedup();
        scenes
    }
}

/// One row.
#[derive(Clone, Copy)]
pub(crate) struct Line<'a>(&'a [String]);

impl<'a> Line<'a> {
    /// # Panics
    /// When there is no such column.
    pub(crate) fn text(self, column: &str) -> &'a str {
        let place = columns().iter().position(|name| name == column);
        &self.0[place.expect("a column")]
    }

    /// `None` where the row has nothing for it.
    pub(crate) fn number(self, column: &str) -> Option<f64> {
        self.text(column).parse().ok()
    }

    /// What other lines are compared with.
    pub(crate) fn key(self) -> [&'a str; 3] {
        ["scene", "measure", "tracer"].map(|column| self.text(column))
    }
}
