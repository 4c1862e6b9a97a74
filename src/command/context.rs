//! What every command needs: how to report, how to show progress, how to write, how to stop.

use core::ops::ControlFlow;
use core::sync::atomic::{AtomicBool, Ordering};
use core::time::Duration;
use std::fs;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use indicatif::{ProgressBar, ProgressStyle};
use leafwalk::output_file::OutputFile;
use leafwalk::{Builder, MeshRef, Octree};

use super::error::{CANCELLED, CommandError};
use super::report::Report;

/// How many steps the progress bar of a build has.
const BUILD_STEPS: f32 = 1000.0;
const TICK: Duration = Duration::from_millis(100);

/// The global options, and the state that Ctrl-C shares with the work.
#[derive(Debug)]
pub(crate) struct Context {
    quiet: bool,
    json: bool,
    /// Set by Ctrl-C.
    cancelled: Arc<AtomicBool>,
    /// The temporary file of the output being written, which Ctrl-C removes.
    unfinished: Arc<Mutex<Option<PathBuf>>>,
}

impl Context {
    pub(crate) fn new(quiet: bool, json: bool) -> Self {
        Self { quiet, json, cancelled: Arc::default(), unfinished: Arc::default() }
    }

    /// Ends the process on Ctrl-C, wherever the work stands, and leaves no unfinished file.
    pub(crate) fn catch_interrupts(&self) -> Result<(), CommandError> {
        let (cancelled, unfinished) = (self.cancelled.clone(), self.unfinished.clone());
        let handler = move || {
            cancelled.store(true, Ordering::Relaxed);
            // Held to the end: no other file is begun, and this one does not get its name any more.
            let mut unfinished = lock(&unfinished);
            if let Some(path) = unfinished.take() {
                // There is nobody left to tell.
                let _ = fs::remove_file(path);
            }
            if io::stderr().is_terminal() {
                // Below the bar, and the `^C` that the terminal shows.
                let _ = writeln!(io::stderr());
            }
            print_error(&CommandError::Cancelled);
            std::process::exit(CANCELLED.into());
        };
        ctrlc::set_handler(handler).map_err(CommandError::Signals)
    }

    /// Whether Ctrl-C was pressed.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// A bar on stderr whose length the work sets; hidden when quiet or stderr is no terminal, cleared when dropped.
    pub(crate) fn progress_bar(&self, what: &str) -> ProgressBar {
        if self.quiet || !io::stderr().is_terminal() {
            return ProgressBar::hidden();
        }
        let style = ProgressStyle::with_template("{msg:8} {wide_bar} {percent:>3} % {elapsed}");
        let bar = ProgressBar::new(0).with_message(what.to_owned());
        bar.enable_steady_tick(TICK);
        bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
    }

    /// Builds with a bar, until Ctrl-C.
    pub(crate) fn build(&self, builder: &Builder, mesh: MeshRef<'_>) -> Result<Octree<Vec<u32>>, CommandError> {
        let bar = self.progress_bar("build");
        bar.set_length(BUILD_STEPS as u64);
        let octree = builder.build_with_progress(mesh, |progress| {
            bar.set_position((progress.fraction * BUILD_STEPS) as u64);
            if self.is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        bar.finish_and_clear();
        let octree = octree?;
        let collapsed = octree.parts().header.collapsed;
        if collapsed > 0 {
            self.warn(&format!(
                "detail lost: {collapsed} triangles collapsed by rounding, too small for the extent of the mesh"
            ));
        }
        Ok(octree)
    }

    /// Checks, before any work, that `output` can be written and is none of the inputs.
    pub(crate) fn check_output(&self, output: &Path, inputs: &[&Path]) -> Result<(), CommandError> {
        let same = |input: &&Path| match (input.canonicalize(), output.canonicalize()) {
            (Ok(input), Ok(output)) => input == output,
            _ => false,
        };
        if inputs.iter().any(same) {
            return Err(CommandError::Overwrite { path: output.to_owned() });
        }
        self.output(output, |_| Ok(()), |_| Ok(()))
    }

    /// Writes a file that appears whole or, after a failure or Ctrl-C, not at all.
    pub(crate) fn write(
        &self,
        path: &Path,
        write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), CommandError> {
        self.output(path, |file| file.write(write), OutputFile::commit)
    }

    /// Begins, fills and ends an output, known to Ctrl-C as long as it has a temporary name.
    fn output(
        &self,
        path: &Path,
        fill: impl FnOnce(&mut OutputFile) -> io::Result<()>,
        end: impl FnOnce(OutputFile) -> io::Result<()>,
    ) -> Result<(), CommandError> {
        let begin = || {
            let mut unfinished = lock(&self.unfinished);
            let file = OutputFile::create(path)?;
            *unfinished = file.temporary_path().map(Path::to_owned);
            Ok(file)
        };
        let written = begin().and_then(|mut file| {
            let filled = fill(&mut file);
            let mut unfinished = lock(&self.unfinished);
            *unfinished = None;
            filled.and_then(|()| end(file))
        });
        written.map_err(|source| CommandError::Write { path: path.to_owned(), source })
    }

    /// Prints a report on stdout: as text unless quiet, or as one JSON object. That nobody reads it is no failure.
    pub(crate) fn report(&self, report: &Report) -> Result<(), CommandError> {
        let mut stdout = io::stdout().lock();
        let printed = match (self.json, self.quiet) {
            (true, _) => report.write_json(&mut stdout),
            (false, false) => report.write_text(&mut stdout),
            (false, true) => Ok(()),
        };
        match printed.and_then(|()| stdout.flush()) {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
            printed => printed.map_err(CommandError::Stdout),
        }
    }

    /// Prints a warning on stderr.
    pub(crate) fn warn(&self, what: &str) {
        // There is nowhere left to complain to when this fails.
        let _ = writeln!(io::stderr(), "warning: {what}");
    }
}

/// Prints why the command failed on stderr.
pub(crate) fn print_error(error: &CommandError) {
    let _ = writeln!(io::stderr(), "error: {error}");
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
