//! The device floor: adapters, an open device, its kernels and a test of its arithmetic. Nothing here knows what an octree
//! or a ray is; it stands on the shaders' text alone.

mod adapter;
mod choice;
mod departure;
mod error;
mod faults;
mod gpu;
mod kernel;
mod map_kernel;
mod self_test;

pub use adapter::{Adapter, AdapterKind, adapters};
pub use choice::AdapterChoice;
pub use departure::Departure;
pub use error::DeviceError;
pub use gpu::Gpu;
pub(crate) use kernel::{Kernel, Module};
pub(crate) use map_kernel::MapKernel;
pub use map_kernel::MapSetup;
pub use self_test::{DepartureCount, Exactness, SelfTest};
