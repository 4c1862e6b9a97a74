//! What holds for any bytes: functions that panic when it does not. Fuzz targets call them with the bytes they make up,
//! and tests/properties.rs with saved and seeded ones.

mod bytes;

pub mod build;
pub mod decode;
#[cfg(feature = "mesh-files")]
pub mod mesh_file;
pub mod trace;
