//! What holds for any bytes: functions that panic when it does not. Fuzz targets call them with the bytes they make up,
//! and tests/properties.rs with saved and seeded ones.
#![allow(dead_code, unreachable_pub, reason = "each fuzz target uses a part of it")]

mod bytes;

pub mod decode;
pub mod mesh;
#[cfg(feature = "mesh-files")]
pub mod mesh_file;
pub mod trace;
