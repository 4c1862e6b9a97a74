//! Builds leafwalk files ([`Builder`]), checks them ([`verify`]) and traces them on every core ([`CpuTracer`]).
//!
//! A file holds two structures over the same blocks of triangles: an octree whose leaves know their neighbours, which
//! [`leafwalk_core`] walks, and a bounding volume hierarchy of eight children a node, which [`CpuTracer`] descends with
//! eight lanes. No answer depends on the way to it, so both give the same bits.
//!
//! Give [`CpuTracer`] many rays at once where there are many: it traces rays that go the same way together. Its
//! [`closest_hit`](CpuTracer::closest_hit) is for rays that depend on the answer of the one before.
//!
//! ```
//! use leafwalk_core::{Hit, Ray, Tracer};
//! use leafwalk_cpu::{Builder, CpuTracer, Mesh};
//!
//! let mesh = Mesh::new(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]);
//! let tracer = CpuTracer::new(Builder::new().build(&mesh)?);
//! let rays = [Ray::new([0.25, 0.5, 2.0], [0.0, 0.0, -1.0])];
//! let mut hits = [Hit::MISS];
//! tracer.closest_hits(&rays, &mut hits)?;
//! assert_eq!(tracer.closest_hit(&rays[0]), Some(hits[0]));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! How a batch of rays is traced is told where `trace` begins; `lanes` are the registers that it runs on.
#![cfg_attr(docsrs, feature(doc_cfg))]
#![deny(unsafe_code)]

mod brute_force;
mod build;
mod lanes;
mod mesh;
#[cfg(feature = "structures")]
pub mod structures;
#[doc(hidden)]
pub mod testing;
mod trace;
mod tracer;
mod verify;

pub use brute_force::BruteForce;
pub use build::{BuildError, Builder, Progress};
pub use mesh::{Mesh, MeshRef};
pub use trace::Way;
pub use tracer::CpuTracer;
pub use verify::{Verified, VerifyError, verify, verify_against};

/// The examples of the README are tests too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
