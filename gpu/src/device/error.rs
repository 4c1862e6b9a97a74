//! `DeviceError`: why there is no device, or what went wrong on it.

use core::fmt;

use super::adapter::Adapter;
use super::choice::AdapterChoice;

/// What can go wrong with a device, whatever runs on it.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum DeviceError {
    /// No adapter of this machine is what was asked for.
    NoAdapter {
        /// What was asked for.
        choice: AdapterChoice,
        /// The graphics interfaces that this build tries, such as `VULKAN`.
        tried: Vec<&'static str>,
        /// The adapters that there are.
        seen: Vec<Adapter>,
    },
    /// The adapter opens no device with the limits that WebGPU promises.
    NoDevice {
        /// The adapter that refuses.
        adapter: Box<Adapter>,
        /// The driver's reason.
        reason: String,
    },
    /// The device has no memory left.
    OutOfMemory {
        /// The driver's words.
        reason: String,
    },
    /// The device is gone: unplugged, reset by its driver, or stopped because it took too long.
    Lost {
        /// The driver's words.
        reason: String,
    },
    /// The driver refuses what it was given, or fails.
    Driver {
        /// The driver's words.
        reason: String,
    },
}

impl DeviceError {
    /// The error for what wgpu reports outside of a result.
    pub(super) fn of_wgpu(error: &wgpu::Error) -> Self {
        let reason = error.to_string();
        match error {
            wgpu::Error::OutOfMemory { .. } => Self::OutOfMemory { reason },
            wgpu::Error::Validation { .. } | wgpu::Error::Internal { .. } => Self::Driver { reason },
        }
    }

    /// The error for a call to the driver that fails with some error of its own.
    pub(super) fn driver(error: impl fmt::Display) -> Self {
        Self::Driver { reason: error.to_string() }
    }
}

impl fmt::Display for DeviceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoAdapter { choice, tried, seen } => {
                write!(f, "no adapter is {choice} (tried {}", tried.join(", "))?;
                for (i, adapter) in seen.iter().enumerate() {
                    write!(f, "{} {adapter}", if i == 0 { "; there is" } else { "," })?;
                }
                let advice = match (choice, seen.is_empty()) {
                    (AdapterChoice::Auto, false) => {
                        "install the driver of your GPU, or ask for the software adapter, which is slower than the CPU \
                         backend"
                    }
                    (AdapterChoice::Name(_), false) => "choose one of these",
                    _ => {
                        "install the driver of your GPU, or a software adapter (Debian: apt install mesa-vulkan-drivers)"
                    }
                };
                write!(f, "): {advice}")
            }
            Self::NoDevice { adapter, reason } => {
                write!(f, "{adapter} gives no device with WebGPU's default limits ({reason}): choose another adapter")
            }
            Self::OutOfMemory { reason } => {
                write!(f, "the device is out of memory ({reason}): trace on the CPU, or free device memory")
            }
            Self::Lost { reason } => write!(f, "the device was lost ({reason}): open it anew"),
            Self::Driver { reason } => write!(f, "the driver failed ({reason}): update it, or choose another adapter"),
        }
    }
}

impl core::error::Error for DeviceError {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::adapter::AdapterKind;

    #[test]
    fn the_error_says_what_there_is_and_what_to_do() {
        let error = |choice, seen| DeviceError::NoAdapter { choice, tried: vec!["VULKAN"], seen }.to_string();
        let text = error(AdapterChoice::Auto, vec![Adapter::named("llvmpipe", AdapterKind::Software)]);
        assert!(
            text.contains("tried VULKAN; there is llvmpipe by Vulkan") && text.contains("ask for the software adapter")
        );
        assert!(error(AdapterChoice::Software, vec![]).contains("apt install mesa-vulkan-drivers"));
        assert!(error(AdapterChoice::Name("x".to_owned()), vec![]).contains("no adapter is called 'x'"));
    }

    #[test]
    fn a_device_out_of_memory_is_told_from_one_that_fails() {
        let source = || Box::<dyn core::error::Error + Send + Sync>::from("words");
        let full = DeviceError::of_wgpu(&wgpu::Error::OutOfMemory { source: source() });
        assert!(matches!(full, DeviceError::OutOfMemory { .. }), "{full:?}");
        let failed = DeviceError::of_wgpu(&wgpu::Error::Internal { source: source(), description: "words".to_owned() });
        assert_eq!(failed, DeviceError::Driver { reason: "words".to_owned() });
    }
}
