//! Watertight ray tracing against triangle meshes, with the same answer on every machine.
//!
//! A mesh is built, once, into an [`Octree`]: one run of 32-bit words that holds two structures over the same blocks of
//! triangles. An octree whose leaves know their face neighbours is walked from leaf to leaf by small machines and by
//! shaders; a bounding volume hierarchy of eight children a node is descended by CPUs with wide registers. No answer
//! depends on the way to it, so both give the same bits.
//!
//! ```
//! use leafwalk::{Builder, CpuTracer, Hit, Mesh, Ray, Tracer};
//!
//! let mesh = Mesh::new(
//!     vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
//!     vec![[0, 1, 2]],
//! );
//! let octree = Builder::new().build(&mesh)?;
//! let tracer = CpuTracer::new(octree.view());
//!
//! // Many rays at once, on every core.
//! let rays = [
//!     Ray::new([0.25, 0.5, 2.0], [0.0, 0.0, -1.0]),
//!     Ray::new([3.0, 3.0, 2.0], [0.0, 0.0, -1.0]),
//! ];
//! let mut hits = [Hit::MISS; 2];
//! tracer.closest_hits(&rays, &mut hits)?;
//! assert_eq!((hits[0].primitive, hits[0].t, hits[0].u, hits[0].v), (0, 2.0, 0.25, 0.5));
//! assert!(hits[1].is_miss());
//!
//! // One ray, descended by the same tracer or walked from leaf to leaf: the same bits.
//! assert_eq!(tracer.closest_hit(&rays[0]), Some(hits[0]));
//! assert_eq!(octree.closest_hit(&rays[0]), Some(hits[0]));
//!
//! // The words are the file: save them, map them, put them into flash, and trace them where they lie.
//! let bytes = bytemuck::cast_slice(octree.as_words());
//! let mapped = leafwalk::Octree::from_bytes(bytes)?;
//! assert!(mapped.occluded(&rays[0]));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Every backend is a [`Tracer`] of batches: [`CpuTracer`] and, with the feature `gpu`, `gpu::GpuTracer`. Octrees are
//! kept in files by [`save_octree`] and [`load_octree`]; with the feature `mesh-files`, `load_mesh` reads OBJ, PLY and
//! STL files. With the feature `serde`, [`Mesh`], [`Stats`], [`Aabb`], [`Hit`] and [`Ray`] are written and read by serde
//! without the loss of a bit. With the feature `structures` come the structures that leafwalk is compared with. The
//! feature `cli`, a default, is for the command `leafwalk` alone: a library that depends on this one leaves it out by
//! `default-features = false`.
#![cfg_attr(docsrs, feature(doc_cfg))]
#![forbid(unsafe_code)]

#[cfg(feature = "mesh-files")]
pub mod mesh_file;
mod octree_file;
// Not part of the interface: the command `leafwalk` writes its files by it, too.
#[doc(hidden)]
pub mod output_file;

#[cfg(feature = "serde")]
pub use leafwalk_core::numbers;
pub use leafwalk_core::{
    Aabb, AlignedBytes, Blocks, CanonicalRay, Clock, DecodeError, Frame, Hit, HitF64, Indexed, LEAF_SIZES, Leaf,
    LengthMismatch, Octree, Parts, Ray, RayF64, RecordFault, Stats, Tracer, Walk, Work, geometric_normal, hit_hash,
    layout, one_by_one, wire,
};
#[cfg(feature = "structures")]
pub use leafwalk_cpu::structures;
pub use leafwalk_cpu::{
    BruteForce, BuildError, Builder, CpuTracer, Mesh, MeshRef, Progress, Verified, VerifyError, Way, verify,
    verify_against,
};
#[cfg(feature = "gpu")]
pub use leafwalk_gpu as gpu;
#[cfg(feature = "mesh-files")]
pub use mesh_file::load::{load_mesh, load_mesh_with_limits};
pub use octree_file::{FileError, load_octree, save_octree, write_octree};

/// The README's example is a test too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
