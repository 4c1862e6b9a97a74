//! What holds for any bytes: functions that panic when it does not. Fuzz targets call them with the bytes they make up,
//! and tests/properties.rs of the package `leafwalk` with saved and seeded ones.

mod bytes;

pub mod decode;
pub mod mesh;
pub mod mesh_file;
pub mod trace;
