//! The walk on a device: the octree's words in its buffers, rays and answers as the shader has them, and the kernels.

mod kernels;
mod octree;
mod ray;

pub(crate) use kernels::WalkKernels;
pub use octree::OctreeSetup;
pub use ray::{DeviceAnswer, DeviceHit, DeviceRay};
pub(crate) use ray::{NO_CLOCK, canonical};
