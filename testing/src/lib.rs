//! What tests and benches share: meshes, rays, real scenes.
#![allow(dead_code, unreachable_pub, missing_docs, reason = "each test and bench uses a part of it")]

pub mod edited;
pub mod meshes;
pub mod properties;
pub mod random;
pub mod rays;
pub mod scenes;
pub mod workloads;
