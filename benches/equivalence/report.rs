//! Rows as a table to read, and what they come to for each backend.

use core::time::Duration;

use crate::backend::{Backend, Promise};
use crate::scene::Scene;

/// A backend's answers to rays of a kind, beside those that were expected.
pub(crate) struct Row {
    pub(crate) rays_of: &'static str,
    pub(crate) rays: usize,
    pub(crate) threads: usize,
    /// The hash of all bits of the closest hits.
    pub(crate) hash: u64,
    /// Closest hits that differ in any bit.
    pub(crate) differing: usize,
    pub(crate) wrong_occlusions: usize,
    /// Rays that visit more cells or fewer.
    pub(crate) other_cells: usize,
    /// Cells that all rays visit, where they are counted.
    pub(crate) cells: Option<u64>,
    /// For closest hits, or for occlusions where the kind of rays asks for these.
    pub(crate) time: Duration,
    /// Differences that the backend promises not to have.
    pub(crate) breaks: usize,
}

/// All rows so far, added up.
#[derive(Default)]
pub(crate) struct Report {
    totals: Vec<Total>,
}

struct Total {
    name: String,
    promise: Promise,
    rows: usize,
    rays: usize,
    differing: usize,
    breaks: usize,
}

impl Report {
    /// Prints the head of a scene's table.
    pub(crate) fn start(&mut self, scene: &Scene) {
        println!("\n{}: {} triangles", scene.name, scene.mesh.triangles.len());
        println!(
            "{:4} {:52} {:>7} {:>9} {:>16} {:>9} {:>9} {:>9} {:>8}",
            "rays", "backend", "threads", "number", "hash of hits", "differing", "occlusion", "cells/ray", "Mrays/s"
        );
    }

    /// Prints a row, and adds it up.
    pub(crate) fn add(&mut self, backend: &Backend<'_>, row: Row) {
        let cells = row.cells.map_or("-".into(), |cells| format!("{:.2}", cells as f64 / row.rays as f64));
        let speed = row.rays as f64 / row.time.as_secs_f64() / 1e6;
        let verdict = if row.breaks > 0 { format!(" BREAKS {}", row.breaks) } else { String::new() };
        println!(
            "{:4} {:52} {:>7} {:>9} {:016x} {:>9} {:>9} {cells:>9} {speed:>8.3}{verdict}",
            row.rays_of, backend.name, row.threads, row.rays, row.hash, row.differing, row.wrong_occlusions
        );
        let (name, promise) = (backend.name.clone(), backend.promise);
        let total = match self.totals.iter_mut().find(|total| (&total.name, total.promise) == (&name, promise)) {
            Some(total) => total,
            None => {
                self.totals.push(Total { name, promise, rows: 0, rays: 0, differing: 0, breaks: 0 });
                self.totals.last_mut().expect("the one just added")
            }
        };
        total.rows += 1;
        total.rays += row.rays;
        total.differing += row.differing;
        total.breaks += row.breaks;
    }

    /// Prints what each backend's rows come to.
    pub(crate) fn print_summary(&self) {
        println!();
        for Total { name, promise, rows, rays, differing, breaks } in &self.totals {
            let promise = match promise {
                Promise::Bits => "all bits",
                Promise::Triangles => "the triangle of most random rays",
                Promise::Nothing => "nothing",
            };
            println!("{name}: {rows} rows, {rays} rays, {differing} hits differ; promises {promise}: {breaks} breaks");
        }
        let sum = |of: fn(&Total) -> usize| self.totals.iter().map(of).sum::<usize>();
        println!("{} rows, {} breaks", sum(|total| total.rows), sum(|total| total.breaks));
    }

    pub(crate) fn has_breaks(&self) -> bool {
        self.totals.iter().any(|total| total.breaks > 0)
    }
}
