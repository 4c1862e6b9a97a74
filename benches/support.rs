//! What benches share with the tests.
#![allow(dead_code, unreachable_pub, missing_docs, reason = "each test and bench uses a part of it")]

#[path = "../tests/support/meshes.rs"]
pub mod meshes;
#[path = "../tests/support/random.rs"]
pub mod random;
#[path = "../tests/support/rays.rs"]
pub mod rays;
#[path = "../tests/support/scenes.rs"]
pub mod scenes;
#[path = "../tests/support/workloads.rs"]
pub mod workloads;
