//! The adapters of this machine, and which one to take.

use core::convert::Infallible;
use core::fmt;
use core::str::FromStr;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use crate::error::GpuError;

/// Which adapter to trace on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Pick {
    /// The fastest kind of hardware there is; never a software adapter, which is slower than tracing on the CPU.
    #[default]
    Auto,
    /// A software adapter, for tests.
    Software,
    /// The first adapter whose text (its [`fmt::Display`]) contains this, whatever the case.
    Name(String),
}

impl Pick {
    /// The environment variable that [`Pick::from_environment`] reads.
    pub const VARIABLE: &str = "LEAFWALK_ADAPTER";

    /// What the variable `LEAFWALK_ADAPTER` says, in the words of the command line; `Auto` where it is unset.
    pub fn from_environment() -> Self {
        std::env::var(Self::VARIABLE).map_or(Self::Auto, |name| name.into())
    }

    /// How much an adapter is wanted; `None`: not at all.
    fn rank(&self, adapter: &Adapter) -> Option<u32> {
        let speed = match adapter.kind {
            Kind::Discrete => 3,
            Kind::Integrated => 2,
            Kind::Virtual => 1,
            Kind::Other | Kind::Software => 0,
        };
        match self {
            Self::Auto => (adapter.kind != Kind::Software).then_some(speed),
            Self::Software => (adapter.kind == Kind::Software).then_some(speed),
            Self::Name(name) => adapter.to_string().to_lowercase().contains(&name.to_lowercase()).then_some(0),
        }
    }
}

impl From<String> for Pick {
    fn from(name: String) -> Self {
        match name.as_str() {
            "auto" => Self::Auto,
            "software" => Self::Software,
            _ => Self::Name(name),
        }
    }
}

impl FromStr for Pick {
    type Err = Infallible;

    fn from_str(name: &str) -> Result<Self, Infallible> {
        Ok(name.to_owned().into())
    }
}

impl fmt::Display for Pick {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("hardware"),
            Self::Software => f.write_str("software"),
            Self::Name(name) => write!(f, "called '{name}'"),
        }
    }
}

/// What an adapter is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kind {
    /// A GPU with memory of its own.
    Discrete,
    /// A GPU that shares the CPU's memory.
    Integrated,
    /// A GPU lent by a hypervisor.
    Virtual,
    /// The CPU.
    Software,
    /// The driver does not say.
    Other,
}

/// An adapter, as its driver describes it.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Adapter {
    /// The driver's name for it.
    pub name: String,
    /// Vulkan, Gl, Metal or Dx12.
    pub backend: String,
    /// What it is.
    pub kind: Kind,
    /// The driver and its version.
    pub driver: String,
    /// Largest binding that it allows, in bytes; [`crate::GpuTracer`] asks for WebGPU's 128 MiB.
    pub binding_bytes: u64,
    /// Largest buffer that it allows, in bytes.
    pub buffer_bytes: u64,
    /// Storage buffers a shader may use; [`crate::GpuTracer`] needs up to 8.
    pub storage_buffers: u32,
    /// Whether it can time what it does.
    pub has_timestamps: bool,
}

impl Adapter {
    fn new(adapter: &wgpu::Adapter) -> Self {
        let (info, limits) = (adapter.get_info(), adapter.limits());
        Self {
            name: info.name,
            backend: format!("{:?}", info.backend),
            kind: match info.device_type {
                wgpu::DeviceType::DiscreteGpu => Kind::Discrete,
                wgpu::DeviceType::IntegratedGpu => Kind::Integrated,
                wgpu::DeviceType::VirtualGpu => Kind::Virtual,
                wgpu::DeviceType::Cpu => Kind::Software,
                wgpu::DeviceType::Other => Kind::Other,
            },
            driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
            binding_bytes: limits.max_storage_buffer_binding_size,
            buffer_bytes: limits.max_buffer_size,
            storage_buffers: limits.max_storage_buffers_per_shader_stage,
            has_timestamps: adapter.features().contains(wgpu::Features::TIMESTAMP_QUERY),
        }
    }
}

impl fmt::Display for Adapter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} by {}", self.name, self.backend)
    }
}

/// Held while adapters are looked for and opened: Mesa 22's are not safe to open from several threads at once.
pub(crate) fn opening() -> MutexGuard<'static, ()> {
    static OPENING: Mutex<()> = Mutex::new(());
    OPENING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// All adapters of this machine, in the drivers' order.
pub fn adapters() -> Vec<Adapter> {
    let _opening = opening();
    enumerate().iter().map(Adapter::new).collect()
}

/// The adapter that is wanted most, the first of equals.
pub(crate) fn pick(pick: &Pick) -> Result<(wgpu::Adapter, Adapter), GpuError> {
    let mut all: Vec<_> = enumerate().into_iter().map(|adapter| (Adapter::new(&adapter), adapter)).collect();
    let ranked = all.iter().enumerate().filter_map(|(i, (adapter, _))| Some((pick.rank(adapter)?, i)));
    let Some((_, at)) = ranked.max_by_key(|(rank, i)| (*rank, core::cmp::Reverse(*i))) else {
        let tried = wgpu::Instance::enabled_backend_features().iter_names().map(|(name, _)| name).collect();
        let seen = all.into_iter().map(|(adapter, _)| adapter).collect();
        return Err(GpuError::NoAdapter { pick: pick.clone(), tried, seen });
    };
    let (described, adapter) = all.swap_remove(at);
    Ok((adapter, described))
}

fn enumerate() -> Vec<wgpu::Adapter> {
    // Never closed: EGL's displays belong to the whole process, and closing one breaks what others have open there.
    static INSTANCE: OnceLock<wgpu::Instance> = OnceLock::new();
    let instance = INSTANCE.get_or_init(|| {
        wgpu::Instance::new(wgpu::InstanceDescriptor {
            // Validation layers would be another driver than users have.
            flags: wgpu::InstanceFlags::empty(),
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        })
    });
    pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn adapter(name: &str, kind: Kind) -> Adapter {
        Adapter {
            name: name.to_owned(),
            backend: "Vulkan".to_owned(),
            kind,
            driver: String::new(),
            binding_bytes: 0,
            buffer_bytes: 0,
            storage_buffers: 0,
            has_timestamps: false,
        }
    }

    #[test]
    fn auto_takes_the_best_hardware_and_no_software() {
        let rank = |kind| Pick::Auto.rank(&adapter("x", kind));
        assert!(rank(Kind::Discrete) > rank(Kind::Integrated));
        assert!(rank(Kind::Integrated) > rank(Kind::Virtual));
        assert!(rank(Kind::Virtual) > rank(Kind::Other) && rank(Kind::Other).is_some());
        assert_eq!(rank(Kind::Software), None);
    }

    #[test]
    fn software_and_names_take_what_they_say() {
        let (hard, soft) = (adapter("NVIDIA H200", Kind::Discrete), adapter("llvmpipe", Kind::Software));
        assert!(Pick::Software.rank(&soft).is_some() && Pick::Software.rank(&hard).is_none());
        for (name, hits_hard) in [("h200", true), ("LLVM", false), ("llvmpipe by vulkan", false)] {
            let pick = Pick::from(name.to_owned());
            assert_eq!((pick.rank(&hard).is_some(), pick.rank(&soft).is_some()), (hits_hard, !hits_hard), "{name}");
        }
    }

    #[test]
    fn the_error_says_what_there_is_and_what_to_do() {
        let error = |pick, seen| GpuError::NoAdapter { pick, tried: vec!["VULKAN"], seen }.to_string();
        let text = error(Pick::Auto, vec![adapter("llvmpipe", Kind::Software)]);
        assert!(
            text.contains("tried VULKAN; there is llvmpipe by Vulkan") && text.contains("ask for the software adapter")
        );
        assert!(error(Pick::Software, vec![]).contains("apt install mesa-vulkan-drivers"));
        assert!(error(Pick::Name("x".to_owned()), vec![]).contains("no adapter is called 'x'"));
    }
}
