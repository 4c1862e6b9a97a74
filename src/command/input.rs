//! The octree that a command works on: from a file, or built from a mesh.

use core::time::Duration;
use std::path::Path;
use std::time::Instant;

use leafwalk::mesh_file::MeshFile;
use leafwalk::{Builder, Octree};

use super::context::Context;
use super::error::CommandError;

/// The extension of an octree's file.
pub(crate) const EXTENSION: &str = "lwk";

/// An octree, and where it came from.
#[derive(Debug)]
pub(crate) struct Input {
    pub(crate) octree: Octree<Vec<u32>>,
    /// What it was built from, unless it came from a file.
    pub(crate) built: Option<Built>,
}

/// What an octree was built from.
#[derive(Debug)]
pub(crate) struct Built {
    pub(crate) mesh: MeshFile,
    /// The time that the build alone took, without reading the mesh.
    pub(crate) time: Duration,
}

/// Whether a path names an octree's file.
pub(crate) fn is_octree(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(EXTENSION))
}

/// Loads `FILE.lwk`, or builds an octree of any other file with the builder's settings.
pub(crate) fn open(path: &Path, builder: &Builder, context: &Context) -> Result<Input, CommandError> {
    if is_octree(path) {
        Ok(Input { octree: leafwalk::load_octree(path)?, built: None })
    } else {
        let mesh = load_mesh(path, context)?;
        let (octree, time) = build(builder, &mesh, context)?;
        Ok(Input { octree, built: Some(Built { mesh, time }) })
    }
}

/// Reads a mesh and warns of what was left out.
pub(crate) fn load_mesh(path: &Path, context: &Context) -> Result<MeshFile, CommandError> {
    let file = leafwalk::load_mesh(path)?;
    for library in &file.missing_libraries {
        context.warn(&format!("{}: {} is missing; its materials are grey", path.display(), library.display()));
    }
    if file.skipped_faces > 0 {
        context.warn(&format!("{}: {} faces with under three corners skipped", path.display(), file.skipped_faces));
    }
    Ok(file)
}

/// Builds, and tells how long it took.
pub(crate) fn build(
    builder: &Builder,
    file: &MeshFile,
    context: &Context,
) -> Result<(Octree<Vec<u32>>, Duration), CommandError> {
    let start = Instant::now();
    let octree = context.build(builder, (&file.mesh).into())?;
    Ok((octree, start.elapsed()))
}
