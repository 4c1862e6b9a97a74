//! What the tests, benches and fuzz targets of leafwalk share.
//!
//! | module | what it holds |
//! | --- | --- |
//! | [`meshes`] | meshes made in code, from a seed: the same on every machine |
//! | [`scenes`] | scenes made in code, and where the real ones are |
//! | [`edited`] | the words of an octree, to be spoiled section by section |
//! | [`tracers`] | tracers that differ from those that serve, and tracers with names |
//! | [`number`] | f32 with its arithmetic broken in one place |
//! | [`differences`] | where tracers differ from one that is right |
//! | [`tally`] | what a check of many rays found, and how many rays it takes |
//! | [`rays`], [`random`], [`truth`], [`workloads`] | as `leafwalk-compare` has them |
//! | [`wide`] | scenes whose extent is far larger than what is looked at |
//! | [`properties`] | what holds for any bytes, as fuzz targets and tests demand it |
//! | [`shell`] | the command, run in a folder of its own |
//!
//! The package is not published. It sees `leafwalk-core`, `leafwalk-cpu` and `leafwalk-compare` alone, so that the packages above them can
//! depend on it in their tests.

pub mod differences;
pub mod edited;
pub mod listing;
pub mod meshes;
pub mod number;
pub mod properties;
pub mod scenes;
pub mod shell;
pub mod tally;
pub mod tracers;
pub mod utm;
pub mod wide;

pub use leafwalk_compare::{random, rays, truth, workloads};
