//! `leafwalk build`: a mesh into an octree's file.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PathBufValueParser, TypedValueParser};
use leafwalk::Builder;

use super::context::Context;
use super::error::CommandError;
use super::input;
use super::report::Report;

/// Build the octree of a mesh and save it.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct BuildArgs {
    /// The mesh: .obj, .ply or .stl, each also with .gz.
    mesh: PathBuf,

    /// The file to write, FILE.lwk.
    #[arg(long, short, value_name = "FILE.lwk", value_parser = octree_path())]
    output: PathBuf,

    /// The deepest level of a leaf, 0 to 16.
    #[arg(long, value_name = "LEVEL", value_parser = clap::value_parser!(u32).range(0..=16))]
    max_level: Option<u32>,

    /// Make smaller leaves and a larger file, for GPUs and for walks on small machines.
    #[arg(long, conflicts_with = "step_cost")]
    for_walks: bool,

    /// Make an octree of a single leaf and the smallest file, for CPUs, which descend the BVH.
    #[arg(long, conflicts_with_all = ["for_walks", "step_cost", "max_level"])]
    for_descents: bool,

    /// Cost of a step over that of a triangle test, at least 0.5: lower makes smaller leaves, and a larger file. The
    /// default is 192.
    #[arg(long, value_name = "COST", value_parser = step_cost)]
    step_cost: Option<f32>,

    /// How many leaves may meet a triangle, on average, at least 1.
    #[arg(long, value_name = "REFERENCES", value_parser = budget)]
    budget: Option<f32>,

    /// Memory that the build may use, in bytes.
    #[arg(long, value_name = "BYTES")]
    memory_limit: Option<u64>,

    /// Make the file about half as large, and slower to trace; the answers are the same.
    #[arg(long)]
    compact: bool,

    /// Leave out triangles with NaN or infinite vertices instead of refusing the mesh.
    #[arg(long)]
    lenient: bool,
}

const EXAMPLES: &str = "\
Examples:
  leafwalk build bunny.ply -o bunny.lwk
  leafwalk build scan.obj.gz -o scan.lwk --lenient --max-level 12 --threads 4
  leafwalk build bunny.ply -o bunny.lwk --compact --json
  leafwalk build bunny.ply -o for-gpus.lwk --for-walks";

fn octree_path() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| match input::is_octree(&path) {
        true => Ok(path),
        // The extension is what tells octrees from meshes later.
        false => Err("the name must end in .lwk"),
    })
}

fn budget(argument: &str) -> Result<f32, String> {
    at_least(1.0, argument)
}

fn step_cost(argument: &str) -> Result<f32, String> {
    at_least(0.5, argument)
}

fn at_least(least: f32, argument: &str) -> Result<f32, String> {
    match argument.parse() {
        Ok(number) if (least..f32::INFINITY).contains(&number) => Ok(number),
        _ => Err(format!("a number from {least} on is needed")),
    }
}

impl BuildArgs {
    fn builder(&self) -> Builder {
        let mut builder = match (self.for_walks, self.for_descents) {
            (true, _) => Builder::for_walks(),
            (_, true) => Builder::for_descents(),
            _ => Builder::new(),
        };
        if let Some(level) = self.max_level {
            builder = builder.max_level(level);
        }
        if let Some(cost) = self.step_cost {
            builder = builder.step_cost(cost);
        }
        if let Some(references) = self.budget {
            builder = builder.reference_budget(references);
        }
        if let Some(bytes) = self.memory_limit {
            builder = builder.memory_limit(bytes);
        }
        if self.compact {
            builder = builder.compact();
        }
        if self.lenient { builder.lenient() } else { builder }
    }
}

pub(crate) fn run(args: &BuildArgs, context: &Context) -> Result<(), CommandError> {
    context.check_output(&args.output, &[&args.mesh])?;
    let mesh = input::load_mesh(&args.mesh, context)?;
    let (octree, time) = input::build(&args.builder(), &mesh, context)?;
    context.write(&args.output, |writer| leafwalk::write_octree(&octree, writer))?;

    let mut report = Report::new();
    report.add_octree(&octree);
    let seconds = time.as_secs_f64();
    report.add_as("build_seconds", "build time", seconds, format!("{seconds:.3} s"));
    context.report(&report)
}
