//! `leafwalk info`: what an octree's file holds.

use std::path::PathBuf;

use clap::Args;
use leafwalk::Octree;
use leafwalk::layout::{LATTICE, Section};
use leafwalk::wire::stored_checksum;
use leafwalk_core::contract::SMALLEST;
use serde_json::json;

use super::context::Context;
use super::error::CommandError;
use super::report::Report;

/// Show what the file of an octree holds.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct InfoArgs {
    /// The octree's file.
    #[arg(value_name = "FILE.lwk")]
    octree: PathBuf,
}

const EXAMPLES: &str = "\
Examples:
  leafwalk info bunny.lwk
  leafwalk info bunny.lwk --json";

const VERSION_WORD: usize = 1;
const WORD_BYTES: u64 = 4;

pub(crate) fn run(args: &InfoArgs, context: &Context) -> Result<(), CommandError> {
    let octree = leafwalk::load_octree(&args.octree)?;
    let mut report = Report::new();
    report.add_octree(&octree);
    add_leaves(&mut report, &octree);
    add_frame(&mut report, &octree);
    let header = octree.parts().header;
    report.add("step_cost", "setting: step cost", header.step_cost);
    report.add("max_level", "setting: max level", header.max_level);
    report.add("compact", "setting: compact", octree.is_compact());
    report.add("version", "format version", octree.as_words().get(VERSION_WORD).copied());
    let checksum = stored_checksum(octree.as_words()).map(|crc| format!("{crc:08x}"));
    report.add("checksum", "checksum (CRC-32)", checksum);
    add_sections(&mut report, &octree);
    context.report(&report)
}

fn add_leaves(report: &mut Report, octree: &Octree<Vec<u32>>) {
    let stats = octree.stats();
    report.add("empty_leaves", "leaves, empty", stats.empty_leaves);
    report.add("inner_nodes", "inner nodes", stats.inner);
    let deepest = stats.leaves_at_level.iter().rposition(|leaves| *leaves > 0).unwrap_or(0);
    report.add("levels", "deepest level", deepest);
    let at_level = &stats.leaves_at_level[..=deepest];
    let lines = (0..).zip(at_level).filter(|(_, leaves)| **leaves > 0);
    let text = lines.map(|(level, leaves)| format!("level {level:>2}: {leaves}\n"));
    report.add_as("leaves_at_level", "leaves by level", json!(at_level), text.collect::<String>());
    let lines = (0..).zip(&stats.leaves_by_entries);
    let text = lines
        .map(|(entries, leaves)| format!("{entries} {}: {leaves}\n", if entries == 1 { "entry  " } else { "entries" }));
    report.add_as("leaves_by_entries", "leaves by size", json!(stats.leaves_by_entries), text.collect::<String>());
}

/// Lengths are given in the caller's units.
fn add_frame(report: &mut Report, octree: &Octree<Vec<u32>>) {
    let parts = octree.parts();
    let edge = parts.frame.scale();
    let bounds = octree.bounds();
    let point = |[x, y, z]: [f64; 3]| format!("({x}, {y}, {z})");
    let step = edge / f64::from(LATTICE);
    let origin = parts.frame.to_caller(parts.frame.corner);
    report.add_as("frame_anchor", "frame: anchor", json!(parts.frame.anchor), point(parts.frame.anchor));
    report.add_as("frame_origin", "frame: origin", json!(origin), point(origin));
    let text = format!("{edge} (2^{})", parts.frame.scale_exponent);
    report.add_as("frame_edge", "frame: edge", edge, text);
    let rounding = f64::from(parts.header.rounding) * step;
    let precision = if parts.header.rounding < SMALLEST { "f32" } else { "f64" };
    let text = match rounding {
        0.0 => format!("{precision}: no vertex moved"),
        _ => format!("{precision}: vertices moved by {rounding:e} at most"),
    };
    report.add_as("frame_rounding", "precision", rounding, text);
    let padding = f64::from(parts.header.padding) * step;
    report.add_as("padding", "padding", padding, format!("{padding:e}"));
    let is_empty = (0..3).any(|k| bounds.lower[k] > bounds.upper[k]);
    let (value, text) = match is_empty {
        true => (json!(null), "empty".to_owned()),
        false => (json!([bounds.lower, bounds.upper]), format!("{}\n{}", point(bounds.lower), point(bounds.upper))),
    };
    report.add_as("bounds", "bounds", value, text);
}

/// Offsets and sizes are given in bytes.
fn add_sections(report: &mut Report, octree: &Octree<Vec<u32>>) {
    let spans = Section::ALL.map(|section| {
        let (offset, words) = octree.span(section);
        (section.name(), u64::from(offset) * WORD_BYTES, u64::from(words) * WORD_BYTES)
    });
    let value = spans.map(|(name, offset, bytes)| json!({ "name": name, "offset": offset, "bytes": bytes }));
    let text = spans.map(|(name, offset, bytes)| format!("{name:<14} {bytes:>12} bytes at {offset}\n"));
    report.add_as("sections", "sections", value.to_vec(), text.concat());
}
