//! The backend that traces: this machine's cores, or a GPU.

use core::fmt;

use clap::{Args, ValueEnum};
use leafwalk::{Builder, CpuTracer, Hit, LengthMismatch, Octree, Ray, Tracer};

use super::error::CommandError;
use super::report::Report;

/// Where and how rays are traced.
#[derive(Args, Debug)]
#[command(next_help_heading = "Backend")]
pub(crate) struct BackendArgs {
    /// What traces; `gpu` takes a build with the feature of that name. For it, meshes are built with a step cost of 64.
    #[arg(long, value_name = "cpu|gpu", default_value = "cpu", value_parser = backend)]
    backend: Kind,

    /// The GPU: the fastest one (auto), a software adapter, or one whose name contains NAME (`leafwalk gpu` lists
    /// them). By default what the variable LEAFWALK_ADAPTER says, else auto.
    #[arg(long, value_name = "auto|software|NAME")]
    adapter: Option<String>,

    /// On a GPU: every bit as on the CPU (exact, unless told otherwise), or a few hits differing.
    #[arg(long, value_enum)]
    flavour: Option<Flavour>,

    /// Trace on the CPU where no GPU can be opened for the octree; the summary then says why.
    #[arg(long)]
    or_cpu: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Cpu,
    #[cfg(feature = "gpu")]
    Gpu,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Flavour {
    Exact,
    Fast,
}

/// How to get what this build lacks.
#[cfg(not(feature = "gpu"))]
pub(super) const WITHOUT_GPU: &str =
    "this build has no GPU backend: build it with `cargo build --release --features gpu`";

fn backend(argument: &str) -> Result<Kind, &'static str> {
    match argument {
        "cpu" => Ok(Kind::Cpu),
        #[cfg(feature = "gpu")]
        "gpu" => Ok(Kind::Gpu),
        #[cfg(not(feature = "gpu"))]
        "gpu" => Err(WITHOUT_GPU),
        _ => Err("choose cpu or gpu"),
    }
}

/// A tracer of either kind, and the octree that it traces.
pub(crate) enum Backend {
    /// The CPU, and why it stands in for a GPU, if it does.
    Cpu(CpuTracer<Vec<u32>>, Option<String>),
    /// A GPU. The octree stays with it for what is done on the CPU.
    #[cfg(feature = "gpu")]
    Gpu(Box<leafwalk::gpu::GpuTracer>, Octree<Vec<u32>>),
}

impl BackendArgs {
    /// The builder for meshes, which are built into what the backend traces best. It is asked for before any work,
    /// since it refuses arguments that do not go together.
    pub(crate) fn builder(&self) -> Result<Builder, CommandError> {
        match self.backend {
            Kind::Cpu if self.adapter.is_some() || self.flavour.is_some() || self.or_cpu => {
                Err(CommandError::Usage("--adapter, --flavour and --or-cpu are for GPUs: add --backend gpu"))
            }
            Kind::Cpu => Ok(Builder::new()),
            #[cfg(feature = "gpu")]
            Kind::Gpu => Ok(Builder::for_walks()),
        }
    }

    /// Whether they ask for a GPU.
    pub(crate) fn is_for_gpus(&self) -> bool {
        self.backend != Kind::Cpu
    }

    /// The backend that the arguments name, ready to trace an octree.
    pub(crate) fn open(&self, octree: Octree<Vec<u32>>) -> Result<Backend, CommandError> {
        match self.backend {
            Kind::Cpu => Ok(Backend::Cpu(CpuTracer::new(octree), None)),
            #[cfg(feature = "gpu")]
            Kind::Gpu => {
                let flavour = match self.flavour {
                    None | Some(Flavour::Exact) => leafwalk::gpu::Flavour::Exact,
                    Some(Flavour::Fast) => leafwalk::gpu::Flavour::Fast,
                };
                let choice =
                    self.adapter.clone().map_or_else(leafwalk::gpu::AdapterChoice::from_environment, Into::into);
                match leafwalk::gpu::GpuTracer::new(&octree, choice, flavour) {
                    Ok(tracer) => Ok(Backend::Gpu(Box::new(tracer), octree)),
                    Err(error) if self.or_cpu => Ok(Backend::Cpu(CpuTracer::new(octree), Some(error.to_string()))),
                    Err(error) => Err(BackendError::Gpu(error).into()),
                }
            }
        }
    }
}

impl Backend {
    pub(crate) fn octree(&self) -> &Octree<Vec<u32>> {
        match self {
            Self::Cpu(tracer, _) => tracer.octree(),
            #[cfg(feature = "gpu")]
            Self::Gpu(_, octree) => octree,
        }
    }

    /// The CPU's tracer, where that is the backend.
    pub(crate) fn cpu(&self) -> Option<&CpuTracer<Vec<u32>>> {
        match self {
            Self::Cpu(tracer, _) => Some(tracer),
            #[cfg(feature = "gpu")]
            Self::Gpu(..) => None,
        }
    }

    /// Reports which backend it is and, if it is a GPU, what it promises.
    pub(crate) fn describe(&self, report: &mut Report) {
        match self {
            Self::Cpu(_, reason) => {
                report.add("backend", "backend", "cpu");
                if let Some(reason) = reason {
                    report.add("instead_of_gpu", "instead of a GPU", reason.as_str());
                }
            }
            #[cfg(feature = "gpu")]
            Self::Gpu(tracer, octree) => {
                report.add("backend", "backend", "gpu");
                report.add("adapter", "adapter", tracer.adapter().to_string());
                report.add("flavour", "flavour", tracer.flavour().name());
                report.add("promise", "self-test", tracer.exactness().to_string());
                if !Builder::suits_walks(octree) {
                    let advice = "its leaves suit CPUs: built with --for-walks, it is traced faster";
                    report.add("octree_advice", "octree", advice);
                }
            }
        }
    }
}

/// Why a backend gave no answers.
#[derive(Debug)]
pub(crate) enum BackendError {
    Lengths(LengthMismatch),
    #[cfg(feature = "gpu")]
    Gpu(leafwalk::gpu::GpuError),
}

impl Tracer for Backend {
    type Error = BackendError;

    fn closest_hits(&self, rays: &[Ray], hits: &mut [Hit]) -> Result<(), BackendError> {
        match self {
            Self::Cpu(tracer, _) => tracer.closest_hits(rays, hits).map_err(BackendError::Lengths),
            #[cfg(feature = "gpu")]
            Self::Gpu(tracer, _) => tracer.closest_hits(rays, hits).map_err(BackendError::Gpu),
        }
    }

    fn occlusions(&self, rays: &[Ray], occluded: &mut [bool]) -> Result<(), BackendError> {
        match self {
            Self::Cpu(tracer, _) => tracer.occlusions(rays, occluded).map_err(BackendError::Lengths),
            #[cfg(feature = "gpu")]
            Self::Gpu(tracer, _) => tracer.occlusions(rays, occluded).map_err(BackendError::Gpu),
        }
    }
}

impl fmt::Display for BackendError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Lengths(source) => source.fmt(f),
            #[cfg(feature = "gpu")]
            Self::Gpu(source) => source.fmt(f),
        }
    }
}

impl core::error::Error for BackendError {
    /// The text of an error here is that of the one it holds, so what caused that one is next.
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Lengths(error) => error.source(),
            #[cfg(feature = "gpu")]
            Self::Gpu(error) => error.source(),
        }
    }
}
