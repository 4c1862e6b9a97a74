//! Traces rays against leafwalk's octrees on a GPU, with the bits of the CPU's hits, on any adapter that wgpu reaches.
//!
//! An octree of `leafwalk-core` holds two structures over the same blocks of triangles: an octree whose leaves know their
//! face neighbours, and a bounding volume hierarchy of eight children a node. Wide CPUs descend the hierarchy. A shader
//! walks the octree, as small machines do: from the leaf that a ray starts in to the neighbour behind the face that it
//! leaves by, with few registers, and a stack in full leaves alone. No answer depends on which of the two is used.
//!
//! The words of the octree are uploaded as they are in the file; the shader's constants are printed from `leafwalk-core`,
//! and each of its functions follows a function there. In the flavour [`Flavour::Exact`] the driver cannot fuse, regroup
//! or approximate what a hit depends on; a [`SelfTest`] of the device, made with every tracer, says whether that holds.
//!
//! ```no_run
//! use leafwalk_core::{Hit, Octree, Ray, Tracer};
//! use leafwalk_gpu::{AdapterChoice, Flavour, GpuTracer};
//!
//! # fn trace(octree: &Octree<Vec<u32>>, rays: &[Ray]) -> Result<Vec<Hit>, leafwalk_gpu::GpuError> {
//! let tracer = GpuTracer::new(octree, AdapterChoice::Auto, Flavour::Exact)?;
//! println!("{}: {}", tracer.adapter(), tracer.exactness());
//! let mut hits = vec![Hit::MISS; rays.len()];
//! tracer.closest_hits(rays, &mut hits)?;
//! # Ok(hits)
//! # }
//! ```
//!
//! A device wants smaller leaves than a CPU: build its octrees by `Builder::for_walks` of `leafwalk-cpu`.
//! [`GpuTracer::upload`] and [`GpuTracer::ray_generator`] keep rays on the
//! device. No type of wgpu's is part of this interface.
//!
//! The crate has floors, each of which knows only those before it: `shader`, the text; `device`, which knows no octree;
//! `walk`, the octree and its kernels on a device; `batch` and `resident`, the rays that come with each call and those that
//! stay; and [`GpuTracer`].
#![forbid(unsafe_code)]

mod batch;
mod device;
mod error;
mod flavour;
mod resident;
mod shader;
#[doc(hidden)]
pub mod testing;
mod tracer;
mod walk;

pub use device::{
    Adapter, AdapterChoice, AdapterKind, Departure, DepartureCount, DeviceError, Exactness, Gpu, SelfTest, adapters,
};
pub use error::GpuError;
pub use flavour::{Flavour, UnknownFlavour};
pub use resident::{DeviceHits, DeviceOcclusions, DeviceRays, RayGenerator, Submission};
pub use tracer::GpuTracer;
pub use walk::DeviceRay;

/// The examples of the README are tests too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
