//! Ray tracing by walking: a mesh becomes a compact, serialized octree whose leaves know their face neighbours, and a
//! ray goes from leaf to leaf with one branchless step.
//!
//! Rays do not leak through edges or vertices, every backend gives the same bits, and the file is the structure.
//!
//! ```
//! use leafwalk::{Builder, Mesh, Ray};
//!
//! let mesh = Mesh::new(
//!     vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
//!     vec![[0, 1, 2]],
//! );
//! let octree = Builder::new().build(&mesh)?;
//! let hit = octree.closest_hit(&Ray::new([0.25, 0.5, 2.0], [0.0, 0.0, -1.0])).expect("a hit");
//! assert_eq!((hit.primitive, hit.t, hit.u, hit.v), (0, 2.0, 0.25, 0.5));
//!
//! // The words are the file: save them, map them, put them into flash, and trace.
//! let bytes = bytemuck::cast_slice(octree.as_words());
//! let mapped = leafwalk::Octree::from_bytes(bytes)?;
//! assert!(mapped.occluded(&Ray::new([0.25, 0.5, 2.0], [0.0, 0.0, -1.0])));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Batches go to a [`Tracer`]: [`CpuTracer`] answers them on every core and, with the feature `gpu`, `gpu::GpuTracer` on a
//! GPU. [`load`] and [`save`] read and write files.
#![cfg_attr(docsrs, feature(doc_cfg))]
#![forbid(unsafe_code)]

#[cfg(feature = "mesh-files")]
pub mod mesh_file;
mod octree_file;
#[doc(hidden)]
pub mod output_file;

pub use leafwalk_core::{
    Aabb, Blocks, CanonicalRay, Clock, DecodeError, Frame, Hit, Indexed, LEAF_SIZES, LengthMismatch, Octree, Parts,
    Ray, RecordFault, Stats, Tracer, Walk, Work, hit_hash, layout, one_by_one, wire,
};
pub use leafwalk_cpu::{
    BruteForce, BuildError, Builder, CpuTracer, Mesh, Progress, Verified, VerifyError, verify, verify_against,
};
#[cfg(feature = "gpu")]
pub use leafwalk_gpu as gpu;
#[doc(hidden)]
pub use octree_file::write_octree;
pub use octree_file::{FileError, load, save};

/// The README's example is a test too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
