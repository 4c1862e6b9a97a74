//! Why a GPU gave no answers.

use core::fmt;

use leafwalk_core::LengthMismatch;

use crate::adapter::{Adapter, Pick};

/// What can go wrong between a batch of rays and its answers.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum GpuError {
    /// No adapter is what was asked for.
    NoAdapter {
        /// What was asked for.
        pick: Pick,
        /// The backends that this build tries.
        tried: Vec<&'static str>,
        /// The adapters that they offer.
        seen: Vec<Adapter>,
    },
    /// The adapter gives no device with the limits that WebGPU promises.
    NoDevice {
        /// Which adapter.
        adapter: Adapter,
        /// The driver's reason.
        reason: String,
    },
    /// The structure does not fit into the bindings that shaders may have.
    StructureTooLarge {
        /// Its size.
        bytes: u64,
        /// What fits.
        most: u64,
    },
    /// The octree is compact: its blocks name their vertices by number, which the shaders do not read.
    CompactOctree,
    /// The device numbers rays in 32 bits.
    CameraTooLarge {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// The device has no memory left.
    OutOfMemory {
        /// The driver's words.
        reason: String,
    },
    /// The device is gone: unplugged, reset by its driver, or stopped because it took too long.
    DeviceLost {
        /// The driver's words.
        reason: String,
    },
    /// The driver refuses what it was given, or fails.
    Driver {
        /// The driver's words.
        reason: String,
    },
    /// As many answers as rays are needed.
    Lengths(LengthMismatch),
}

impl fmt::Display for GpuError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoAdapter { pick, tried, seen } => {
                write!(f, "no adapter is {pick} (tried {}", tried.join(", "))?;
                for (i, adapter) in seen.iter().enumerate() {
                    write!(f, "{} {adapter}", if i == 0 { "; there is" } else { "," })?;
                }
                write!(f, "): ")?;
                match (pick, seen.is_empty()) {
                    (Pick::Auto, false) => write!(
                        f,
                        "install the driver of your GPU, or ask for the software adapter, which is slower than the CPU backend"
                    ),
                    (Pick::Name(_), false) => write!(f, "choose one of these"),
                    _ => write!(
                        f,
                        "install the driver of your GPU, or a software adapter (Debian: apt install mesa-vulkan-drivers)"
                    ),
                }
            }
            Self::NoDevice { adapter, reason } => {
                write!(f, "{adapter} gives no device with WebGPU's default limits ({reason}): choose another adapter")
            }
            Self::StructureTooLarge { bytes, most } => {
                write!(f, "an octree of {bytes} bytes where the shaders reach {most}: trace it on the CPU")
            }
            Self::CompactOctree => {
                write!(f, "shaders read no compact octrees: build it without `compact`, or trace it on the CPU")
            }
            Self::CameraTooLarge { width, height } => {
                write!(f, "a camera of {width} x {height} pixels has 2^32 rays or more: trace it in parts")
            }
            Self::OutOfMemory { reason } => {
                write!(f, "the device is out of memory ({reason}): trace on the CPU, or free device memory")
            }
            Self::DeviceLost { reason } => write!(f, "the device was lost ({reason}): open it anew"),
            Self::Driver { reason } => write!(f, "the driver failed ({reason}): update it, or choose another adapter"),
            Self::Lengths(source) => source.fmt(f),
        }
    }
}

impl core::error::Error for GpuError {}

impl From<LengthMismatch> for GpuError {
    fn from(source: LengthMismatch) -> Self {
        Self::Lengths(source)
    }
}
