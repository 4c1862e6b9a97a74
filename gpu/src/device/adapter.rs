//! `Adapter`: the GPUs of this machine, and the ones in software, as their drivers describe them.

use core::fmt;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

/// What an adapter is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum AdapterKind {
    /// A GPU with memory of its own.
    Discrete,
    /// A GPU that shares the CPU's memory.
    Integrated,
    /// A GPU lent by a hypervisor.
    Virtual,
    /// The CPU, which runs shaders in software.
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
    /// The graphics interface that reaches it: Vulkan, Gl, Metal or Dx12.
    pub backend: String,
    /// What it is made of.
    pub kind: AdapterKind,
    /// The driver and its version.
    pub driver: String,
    /// Largest binding that it allows, in bytes; [`crate::GpuTracer`] asks for WebGPU's 128 MiB.
    pub binding_bytes: u64,
    /// Largest buffer that it allows, in bytes.
    pub buffer_bytes: u64,
    /// Storage buffers that a shader may use; [`crate::GpuTracer`] needs up to 8.
    pub storage_buffers: u32,
    /// Whether the device can time what it runs.
    pub has_timestamps: bool,
}

impl Adapter {
    pub(super) fn describe(adapter: &wgpu::Adapter) -> Self {
        let (info, limits) = (adapter.get_info(), adapter.limits());
        Self {
            name: info.name,
            backend: format!("{:?}", info.backend),
            kind: match info.device_type {
                wgpu::DeviceType::DiscreteGpu => AdapterKind::Discrete,
                wgpu::DeviceType::IntegratedGpu => AdapterKind::Integrated,
                wgpu::DeviceType::VirtualGpu => AdapterKind::Virtual,
                wgpu::DeviceType::Cpu => AdapterKind::Software,
                wgpu::DeviceType::Other => AdapterKind::Other,
            },
            driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
            binding_bytes: limits.max_storage_buffer_binding_size,
            buffer_bytes: limits.max_buffer_size,
            storage_buffers: limits.max_storage_buffers_per_shader_stage,
            has_timestamps: adapter.features().contains(wgpu::Features::TIMESTAMP_QUERY),
        }
    }

    /// An adapter with a name and a kind, for tests of choices and errors.
    #[cfg(test)]
    pub(super) fn named(name: &str, kind: AdapterKind) -> Self {
        Self {
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
}

impl fmt::Display for Adapter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} by {}", self.name, self.backend)
    }
}

/// All adapters of this machine, in the order of the drivers.
pub fn adapters() -> Vec<Adapter> {
    let _lock = lock_adapters();
    enumerate().iter().map(Adapter::describe).collect()
}

/// Locks out other threads while adapters are looked for and opened: Mesa 22's are not safe to open from several at once.
pub(super) fn lock_adapters() -> MutexGuard<'static, ()> {
    static OPENING: Mutex<()> = Mutex::new(());
    OPENING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Asks the drivers for their adapters. The caller holds [`lock_adapters`].
pub(super) fn enumerate() -> Vec<wgpu::Adapter> {
    // The instance is never closed: EGL's displays belong to the whole process, and closing one breaks what other
    // instances have open there.
    static INSTANCE: OnceLock<wgpu::Instance> = OnceLock::new();
    let instance = INSTANCE.get_or_init(|| {
        wgpu::Instance::new(wgpu::InstanceDescriptor {
            // Validation layers would make it another driver than the one that users have.
            flags: wgpu::InstanceFlags::empty(),
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        })
    });
    pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()))
}
