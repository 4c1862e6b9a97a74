//! `leafwalk trace`: rays from a file, hits into another.

use core::time::Duration;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use leafwalk::{Hit, Ray, Tracer, hit_hash};

use super::backend::BackendArgs;
use super::context::Context;
use super::error::CommandError;
use super::report::Report;
use super::table_file::TableFile;
use super::{hits, input, rays};

/// Trace rays from a file and write the closest hit of each.
///
/// RAYS and HITS are .npy or .csv by their names. Rays are rows of ox oy oz dx dy dz [t_min [t_max]]: origin,
/// direction (of any length), and the distances, in multiples of it, between which hits count; 0 and inf where absent.
/// In npy they are f4 or f8 (rounded to f4), in C or Fortran order.
///
/// Hits are rows of t u v primitive: the distance, the barycentric weights of the triangle's second and third vertex,
/// and its index in the mesh; of a miss inf 0 0 4294967295. In npy they are a structured array with these fields.
/// Rays that hold NaN or an infinite coordinate, or have no direction, are invalid: they are counted, and miss.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct TraceArgs {
    /// The octree's file, or a mesh to build one from.
    #[arg(value_name = "FILE.lwk|MESH")]
    input: PathBuf,

    /// The rays.
    #[arg(value_parser = TableFile::parser())]
    rays: TableFile,

    /// The file to write.
    #[arg(long, short, value_name = "HITS", value_parser = TableFile::parser())]
    output: TableFile,

    #[command(flatten)]
    backend: BackendArgs,
}

const EXAMPLES: &str = "\
Examples:
  leafwalk trace bunny.lwk rays.npy -o hits.npy
  leafwalk trace bunny.ply rays.csv -o hits.csv --json";

/// How many rays are traced between two looks at the clock: several chunks of a GPU, so that its copies overlap.
const BATCH: usize = 1 << 22;

pub(crate) fn run(args: &TraceArgs, context: &Context) -> Result<(), CommandError> {
    let builder = args.backend.builder()?;
    context.check_output(&args.output.path, &[&args.input, &args.rays.path])?;
    let rays = rays::read(&args.rays)?;
    let octree = input::open(&args.input, &builder, context)?.octree;
    let backend = args.backend.open(octree)?;
    let (answers, time) = trace(&backend, &rays, context)?;
    hits::write(&args.output, &answers, context)?;

    let missed = answers.iter().filter(|hit| hit.is_miss()).count();
    let invalid = rays.iter().filter(|ray| !ray.is_valid()).count();
    let mut report = Report::new();
    report.add("rays", "rays", rays.len());
    report.add("hits", "hits", rays.len() - missed);
    report.add("misses", "misses", missed);
    report.add("invalid", "of which invalid", invalid);
    report.add_speed("speed", rays.len() as u64, time.as_secs_f64());
    backend.describe(&mut report);
    report.add("hit_hash", "hit hash", format!("{:016x}", hit_hash(&answers)));
    context.report(&report)
}

/// The closest hits, and the time that tracing alone took.
fn trace<T: Tracer>(tracer: &T, rays: &[Ray], context: &Context) -> Result<(Vec<Hit>, Duration), CommandError>
where
    CommandError: From<T::Error>,
{
    let bar = context.progress_bar("trace");
    bar.set_length(rays.len() as u64);
    let mut answers = vec![Hit::MISS; rays.len()];
    let mut time = Duration::ZERO;
    for (rays, answers) in rays.chunks(BATCH).zip(answers.chunks_mut(BATCH)) {
        if context.is_cancelled() {
            return Err(CommandError::Cancelled);
        }
        let start = Instant::now();
        tracer.closest_hits(rays, answers)?;
        time += start.elapsed();
        bar.inc(rays.len() as u64);
    }
    bar.finish_and_clear();
    Ok((answers, time))
}
