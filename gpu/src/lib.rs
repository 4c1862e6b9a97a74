//! The octree that `leafwalk-core` walks, walked by a compute shader: the words are uploaded as they are, the shader's
//! numbers are printed from `core`, and its `exact` flavour gives the scalar tracer's bits.
//!
//! ```no_run
//! use leafwalk_core::{Hit, Octree, Ray, Tracer};
//! use leafwalk_gpu::{Flavour, GpuTracer, Pick};
//!
//! # fn trace(octree: &Octree<Vec<u32>>, rays: &[Ray]) -> Result<Vec<Hit>, leafwalk_gpu::GpuError> {
//! let tracer = GpuTracer::new(octree, Pick::Auto, Flavour::Exact)?;
//! println!("{}: {}", tracer.adapter(), tracer.promise());
//! let mut hits = vec![Hit::MISS; rays.len()];
//! tracer.closest_hits(rays, &mut hits)?;
//! # Ok(hits)
//! # }
//! ```
//!
//! No type of wgpu's is part of this interface.
#![forbid(unsafe_code)]

mod adapter;
mod batch;
#[doc(hidden)]
pub mod chunk;
mod device_rays;
mod error;
mod flavour;
mod gpu;
mod kernel;
#[doc(hidden)]
pub mod pinhole;
mod prelude;
#[doc(hidden)]
pub mod ray;
mod self_test;
#[doc(hidden)]
pub mod shader;
#[doc(hidden)]
pub mod structure;
mod submission;
mod tracer;

pub use adapter::{Adapter, Kind, Pick, adapters};
pub use device_rays::DeviceRays;
pub use error::GpuError;
pub use flavour::{Flavour, UnknownFlavour};
pub use gpu::Gpu;
pub use pinhole::Pinhole;
pub use self_test::{Finding, Matter, Promise, SelfTest};
pub use submission::{DeviceHits, DeviceOcclusions, Submission};
pub use tracer::GpuTracer;

/// The examples of the README are tests too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
