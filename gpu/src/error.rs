//! `GpuError`: why a batch of rays got no answers from a GPU.

use core::fmt;

use leafwalk_core::LengthMismatch;

use crate::device::DeviceError;

/// What can go wrong between an octree with a batch of rays, and the answers.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum GpuError {
    /// There is no device, or it failed.
    Device(DeviceError),
    /// The octree does not fit into the storage buffers that a shader may have.
    OctreeTooLarge {
        /// The octree's size in bytes.
        bytes: u64,
        /// The largest size in bytes that fits.
        most: u64,
    },
    /// The octree is compact: its blocks name their vertices by number, which the shaders do not read.
    CompactOctree,
    /// The slices of rays and answers differ in length.
    Lengths(LengthMismatch),
    /// A ray generation shader was asked for more rays than 32 bits can number.
    TooManyRays {
        /// How many rays were asked for.
        rays: usize,
    },
    /// The text of a ray generation shader does not compile.
    RayShader {
        /// The compiler's message.
        reason: String,
    },
    /// The rays on the device were made for an octree in another frame, or for another device.
    ForeignRays,
}

impl fmt::Display for GpuError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Device(source) => source.fmt(f),
            Self::OctreeTooLarge { bytes, most } => {
                write!(f, "an octree of {bytes} bytes where the shaders reach {most}: trace it on the CPU")
            }
            Self::CompactOctree => {
                write!(f, "shaders read no compact octrees: build it without `compact`, or trace it on the CPU")
            }
            Self::Lengths(source) => source.fmt(f),
            Self::TooManyRays { rays } => {
                write!(f, "{rays} rays where a shader numbers at most 2^32 - 1: generate them in parts")
            }
            Self::RayShader { reason } => {
                write!(f, "the ray generation shader does not compile ({reason}): correct its text")
            }
            Self::ForeignRays => write!(
                f,
                "these rays were made for an octree in another frame or for another device: make them with the tracer \
                 that they are submitted to"
            ),
        }
    }
}

impl core::error::Error for GpuError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Device(source) => Some(source),
            Self::Lengths(source) => Some(source),
            _ => None,
        }
    }
}

impl From<DeviceError> for GpuError {
    fn from(source: DeviceError) -> Self {
        Self::Device(source)
    }
}

impl From<LengthMismatch> for GpuError {
    fn from(source: LengthMismatch) -> Self {
        Self::Lengths(source)
    }
}

#[cfg(test)]
mod tests {
    use core::error::Error;

    use super::*;

    #[test]
    fn wrapped_errors_are_sources() {
        let lengths = LengthMismatch { rays: 3, answers: 2 };
        let lost = DeviceError::Lost { reason: "unplugged".to_owned() };
        let text = |error: &GpuError| error.source().map(ToString::to_string);
        assert_eq!(text(&lengths.into()), Some(lengths.to_string()));
        assert_eq!(text(&lost.clone().into()), Some(lost.to_string()));
        assert_eq!(text(&GpuError::CompactOctree), None);
    }
}
