//! Mesh files written here or found in the folder LEAFWALK_SCENES, read back.
#![cfg(feature = "mesh-files")]

/// Whether a value matches a pattern; shows it if not.
macro_rules! assert_matches {
    ($value:expr, $pattern:pat $(if $guard:expr)?) => {{
        let value = $value;
        assert!(matches!(&value, $pattern $(if $guard)?), "{value:?}");
    }};
}

mod damaged;
mod exact;
mod files;
mod limits;
mod materials;
mod obj;
mod ply;
mod precision;
mod scenes;
mod sources;
mod stl;
