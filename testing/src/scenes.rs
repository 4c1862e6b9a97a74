//! Real scenes, where LEAFWALK_SCENES names a folder of them.

use std::path::PathBuf;

/// The path of a real scene, or `None` with a line that says what is skipped.
pub fn real(name: &str, purpose: &str) -> Option<PathBuf> {
    let path = std::env::var_os("LEAFWALK_SCENES").map(|folder| PathBuf::from(folder).join(name));
    match path {
        Some(path) if path.exists() => Some(path),
        Some(path) => {
            println!("skipped: {purpose}: {} does not exist", path.display());
            None
        }
        None => {
            println!("skipped: {purpose}: LEAFWALK_SCENES is not set");
            None
        }
    }
}
