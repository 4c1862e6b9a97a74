//! `leafwalk verify`: whether an octree's file is what it should be.

use std::path::PathBuf;

use clap::Args;

use super::context::Context;
use super::error::CommandError;
use super::input;
use super::report::Report;

/// Bin every triangle of an octree again; with a mesh, also check that the octree was built from it.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct VerifyArgs {
    /// The octree's file.
    #[arg(value_name = "FILE.lwk")]
    octree: PathBuf,

    /// The mesh that it should have been built from.
    mesh: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  leafwalk verify bunny.lwk
  leafwalk verify bunny.lwk bunny.ply && echo as built";

pub(crate) fn run(args: &VerifyArgs, context: &Context) -> Result<(), CommandError> {
    let octree = leafwalk::load_octree(&args.octree)?;
    let verified = match &args.mesh {
        None => leafwalk::verify(&octree),
        Some(path) => leafwalk::verify_against(&octree, &input::load_mesh(path, context)?.mesh),
    };
    let verified = verified.map_err(|source| CommandError::Verify { path: args.octree.clone(), source })?;

    let mut report = Report::new();
    report.add("triangles", "triangles binned", verified.triangles);
    report.add("references", "references needed", verified.references);
    if let Some(mesh) = &args.mesh {
        report.add("mesh", "built from", mesh.display().to_string());
    }
    context.report(&report)
}
