//! `leafwalk trace`: rays from a file, hits into another.

use core::time::Duration;
use std::path::PathBuf;
use std::time::Instant;

use clap::{Args, ValueEnum};
use leafwalk::{Hit, HitF64, Ray, RayF64, Tracer, hit_hash};

use super::backend::{Backend, BackendArgs};
use super::context::Context;
use super::error::CommandError;
use super::hits::{self, Hits};
use super::input;
use super::rays::{self, Rays};
use super::report::Report;
use super::table_file::TableFile;

/// Trace rays from a file and write the closest hit of each.
///
/// RAYS and HITS are .npy or .csv by their names. Rays are rows of ox oy oz dx dy dz [t_min [t_max]]: origin,
/// direction (of any length), and the distances, in multiples of it, between which hits count; 0 and inf where absent.
/// In npy they are f4 or f8, in C or Fortran order. Those of f8 and of CSV are traced in f64, for scenes far from 0; a GPU
/// rounds them to f4. Those of f4 are the fastest.
///
/// Hits are rows of t u v primitive: the distance, the barycentric weights of the triangle's second and third vertex,
/// and its index in the mesh; of a miss inf 0 0 4294967295. In npy they are a structured array with these fields, t of
/// the type that --t names.
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

    /// The precision of the distances t.
    #[arg(long, value_enum, default_value_t = Precision::F32)]
    t: Precision,

    #[command(flatten)]
    backend: BackendArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Precision {
    F32,
    F64,
}

const EXAMPLES: &str = "\
Examples:
  leafwalk trace bunny.lwk rays.npy -o hits.npy
  leafwalk trace bunny.ply rays.csv -o hits.csv --json
  leafwalk trace utm.lwk rays.csv -o hits.csv --t f64";

/// How many rays are traced between two looks at the clock: several chunks of a GPU, so that its copies overlap.
const BATCH: usize = 1 << 22;

pub(crate) fn run(args: &TraceArgs, context: &Context) -> Result<(), CommandError> {
    let builder = args.backend.builder()?;
    if args.t == Precision::F64 && args.backend.is_for_gpus() {
        return Err(CommandError::Usage("a GPU has t in f32 only: leave --t f64 or --backend gpu out"));
    }
    context.check_output(&args.output.path, &[&args.input, &args.rays.path])?;
    let rays = rays::read(&args.rays)?;
    let octree = input::open(&args.input, &builder, context)?.octree;
    let backend = args.backend.open(octree)?;
    let (count, invalid) = (rays.len(), rays.invalid());
    let (answers, time) = trace(&backend, rays, args.t, context)?;
    hits::write(&args.output, &answers, context)?;

    let answers = answers.rounded();
    let missed = answers.iter().filter(|hit| hit.is_miss()).count();
    let mut report = Report::new();
    report.add("rays", "rays", count);
    report.add("hits", "hits", count - missed);
    report.add("misses", "misses", missed);
    report.add("invalid", "of which invalid", invalid);
    report.add_speed("speed", count as u64, time.as_secs_f64());
    backend.describe(&mut report);
    report.add("hit_hash", "hit hash", format!("{:016x}", hit_hash(&answers)));
    context.report(&report)
}

/// The closest hits, and the time that tracing alone took.
fn trace(backend: &Backend, rays: Rays, t: Precision, context: &Context) -> Result<(Hits, Duration), CommandError> {
    let rays = match (rays, t, backend.cpu()) {
        (Rays::F32(rays), Precision::F32, _) => rays,
        (rays, _, Some(tracer)) => {
            let rays = rays.into_f64();
            let answer = |rays: &[RayF64], hits: &mut [HitF64]| Ok(tracer.closest_hits_f64(rays, hits)?);
            let (hits, time) = answer_all(&rays, HitF64::MISS, answer, context)?;
            let hits = Hits::F64(hits);
            return Ok((if t == Precision::F64 { hits } else { Hits::F32(hits.rounded()) }, time));
        }
        (rays, ..) => {
            context.warn("the rays are rounded to f32, as a GPU takes them");
            rays.into_f32()
        }
    };
    let answer = |rays: &[Ray], hits: &mut [Hit]| Ok(backend.closest_hits(rays, hits)?);
    let (hits, time) = answer_all(&rays, Hit::MISS, answer, context)?;
    Ok((Hits::F32(hits), time))
}

/// Answers batch by batch, until Ctrl-C.
fn answer_all<R, A: Copy>(
    rays: &[R],
    miss: A,
    answer: impl Fn(&[R], &mut [A]) -> Result<(), CommandError>,
    context: &Context,
) -> Result<(Vec<A>, Duration), CommandError> {
    let bar = context.progress_bar("trace");
    bar.set_length(rays.len() as u64);
    let mut answers = vec![miss; rays.len()];
    let mut time = Duration::ZERO;
    for (rays, answers) in rays.chunks(BATCH).zip(answers.chunks_mut(BATCH)) {
        if context.is_cancelled() {
            return Err(CommandError::Cancelled);
        }
        let start = Instant::now();
        answer(rays, answers)?;
        time += start.elapsed();
        bar.inc(rays.len() as u64);
    }
    bar.finish_and_clear();
    Ok((answers, time))
}
