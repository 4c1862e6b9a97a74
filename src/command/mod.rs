//! The command `leafwalk`: its arguments, and which subcommand does the work.

mod backend;
mod build;
mod context;
mod demo;
mod error;
mod gpu;
mod hits;
mod info;
mod input;
mod rays;
mod render;
mod report;
mod table_file;
mod trace;
mod verify;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use context::{Context, print_error};
use error::CommandError;

/// Octrees that rays walk: build one from a mesh, look into it, check it, trace rays through it, draw it.
///
/// Without a command it renders a picture of its own to `leafwalk.png`.
#[derive(Debug, Parser)]
#[command(name = "leafwalk", version, after_help = EXAMPLES)]
struct Cli {
    /// Show neither progress nor report; warnings and errors remain.
    #[arg(long, short, global = true)]
    quiet: bool,

    /// Print the report as one JSON object on stdout.
    #[arg(long, global = true)]
    json: bool,

    /// Threads to work with; by default one for each core.
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MOST_THREADS))]
    threads: Option<u16>,

    #[command(subcommand)]
    command: Option<Command>,
}

/// The most threads that can be asked for: more than machines have cores, while tens of thousands, started by mistake,
/// would do harm.
const MOST_THREADS: i64 = 4096;

const EXAMPLES: &str = "\
Examples:
  leafwalk                                 the picture leafwalk.png
  leafwalk build bunny.ply -o bunny.lwk    the octree of a mesh
  leafwalk render bunny.lwk -o bunny.png   a picture of it
  leafwalk trace bunny.lwk rays.npy -o hits.npy

Exit codes: 0 done, 1 failed, 2 wrong usage, 130 stopped by Ctrl-C.";

#[derive(Debug, Subcommand)]
enum Command {
    Render(render::RenderArgs),
    Build(build::BuildArgs),
    Info(info::InfoArgs),
    Verify(verify::VerifyArgs),
    Trace(trace::TraceArgs),
    Gpu(gpu::GpuArgs),
}

/// Runs the command that the arguments name.
pub(crate) fn main() -> ExitCode {
    match run(&Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        // The handler of Ctrl-C says so, once, and ends the process.
        Err(CommandError::Cancelled) => loop {
            std::thread::park();
        },
        Err(error) => {
            print_error(&error);
            error.exit_code()
        }
    }
}

fn run(cli: &Cli) -> Result<(), CommandError> {
    let context = Context::new(cli.quiet, cli.json);
    context.catch_interrupts()?;
    if let Some(threads) = cli.threads {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into());
        pool.build_global().map_err(CommandError::Threads)?;
    }
    match &cli.command {
        None => demo::run(&context),
        Some(Command::Render(args)) => render::run(args, &context),
        Some(Command::Build(args)) => build::run(args, &context),
        Some(Command::Info(args)) => info::run(args, &context),
        Some(Command::Verify(args)) => verify::run(args, &context),
        Some(Command::Trace(args)) => trace::run(args, &context),
        Some(Command::Gpu(args)) => gpu::run(args, &context),
    }
}
