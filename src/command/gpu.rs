//! `leafwalk gpu`: the adapters of this machine, and what each can be relied on for.

use clap::Args;

use super::context::Context;
use super::error::CommandError;

/// List the GPUs that rays can be traced on.
///
/// For each adapter: its driver and limits, and what a self-test of its arithmetic says of the flavours. `exact` means
/// that hits have the bits of the CPU's. It takes a build with the feature `gpu`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct GpuArgs {}

const EXAMPLES: &str = "\
Examples:
  leafwalk gpu
  leafwalk render bunny.lwk -o bunny.png --backend gpu
  leafwalk trace bunny.lwk rays.npy -o hits.npy --backend gpu --adapter software";

#[cfg(not(feature = "gpu"))]
pub(crate) fn run(_: &GpuArgs, _: &Context) -> Result<(), CommandError> {
    Err(CommandError::Usage(super::backend::WITHOUT_GPU))
}

#[cfg(feature = "gpu")]
pub(crate) fn run(_: &GpuArgs, context: &Context) -> Result<(), CommandError> {
    let adapters = leafwalk::gpu::adapters();
    let mut report = super::report::Report::new();
    report.add("adapters", "adapters", adapters.len());
    let described: Vec<_> = adapters.iter().map(listing::describe).collect();
    let text = described.iter().map(|(_, text)| text.as_str()).collect::<Vec<_>>().join("\n");
    let json: Vec<_> = described.into_iter().map(|(json, _)| json).collect();
    report.add_as("list", "", json, text);
    context.report(&report)
}

#[cfg(feature = "gpu")]
mod listing {
    use leafwalk::gpu::{Adapter, AdapterChoice, Flavour, Gpu, SelfTest};
    use serde_json::{Value, json};

    /// An adapter for machines and for people.
    pub(super) fn describe(adapter: &Adapter) -> (Value, String) {
        let promises = Gpu::open(&AdapterChoice::Name(adapter.to_string())).and_then(|gpu| {
            let tests = [SelfTest::of(&gpu, Flavour::Exact)?, SelfTest::of(&gpu, Flavour::Fast)?];
            Ok(tests.map(|test| test.exactness().to_string()))
        });
        let Adapter { kind, driver, binding_bytes, buffer_bytes, storage_buffers, has_timestamps, .. } = adapter;
        let kind = format!("{kind:?}").to_lowercase();
        let json = json!({
            "name": adapter.to_string(),
            "kind": kind,
            "driver": driver,
            "binding_bytes": binding_bytes,
            "buffer_bytes": buffer_bytes,
            "storage_buffers": storage_buffers,
            "has_timestamps": has_timestamps,
            "exact": promises.as_ref().map(|[exact, _]| exact).ok(),
            "fast": promises.as_ref().map(|[_, fast]| fast).ok(),
            "error": promises.as_ref().err().map(ToString::to_string),
        });
        let timestamps = if *has_timestamps { "with timestamps" } else { "without timestamps" };
        let self_test = match &promises {
            Ok([exact, fast]) => format!("self-test: exact flavour {exact}, fast flavour {fast}"),
            Err(error) => format!("unusable: {error}"),
        };
        let text = format!(
            "{adapter} ({kind}, {driver})\n  {storage_buffers} storage buffers of up to {binding_bytes} bytes, \
             {timestamps}\n  {self_test}"
        );
        (json, text)
    }
}
