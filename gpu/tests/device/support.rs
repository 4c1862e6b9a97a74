//! Meshes, rays and random numbers, as the other packages' tests have them.
#![allow(dead_code, unreachable_pub, missing_docs, reason = "these tests use a part of it")]

#[path = "../../../tests/support/meshes.rs"]
pub mod meshes;
#[path = "../../../tests/support/random.rs"]
pub mod random;
#[path = "../../../tests/support/rays.rs"]
pub mod rays;
#[path = "../../../tests/support/scenes.rs"]
pub mod scenes;
