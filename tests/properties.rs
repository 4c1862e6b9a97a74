//! The properties that fuzzing attacks, over its saved inputs and over seeded bytes.

use std::fs;
use std::path::Path;

use leafwalk_testing::properties::{decode, mesh, trace};
use leafwalk_testing::random::Random;
use rayon::prelude::*;

/// Seeded bytes; a quarter of them small numbers, which spell more valid things than others do.
fn seeded(seed: u64, index: u64, longest: usize) -> Vec<u8> {
    let mut random = Random::new(seed, index);
    let length = random.below(longest);
    let bits = if random.below(4) == 0 { 4 } else { 8 };
    (0..length).map(|_| (random.bits() >> (32 - bits)) as u8).collect()
}

/// The inputs saved for a fuzz target, those of old crashes among them.
fn saved(target: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds").join(target);
    let entries = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let saved: Vec<_> =
        entries.map(|entry| fs::read(entry.expect("an entry").path()).expect("a file that can be read")).collect();
    assert!(!saved.is_empty(), "{} holds no input", folder.display());
    saved
}

#[test]
fn any_words_decode_or_say_why_not() {
    let kept = saved("decode").iter().filter(|bytes| decode::check(bytes)).count();
    assert!(kept > 0, "no saved input decodes");
    let accepted: u64 = (0..40_000).into_par_iter().map(|i| u64::from(decode::check(&seeded(1, i, 400)))).sum();
    println!("decode: {accepted} of 40000 edits accepted and traced");
    assert!((2_000..38_000).contains(&accepted), "{accepted} accepted: the edits test too little");
}

#[test]
fn any_mesh_builds_or_says_why_not() {
    saved("mesh").iter().for_each(|bytes| mesh::check(bytes));
    (0..4_000).into_par_iter().for_each(|i| mesh::check(&seeded(2, i, 900)));
}

#[test]
fn any_ray_is_answered_as_by_brute_force() {
    saved("trace").iter().for_each(|bytes| trace::check(bytes));
    (0..1_500).into_par_iter().for_each(|i| trace::check(&seeded(3, i, 900)));
}

#[test]
#[cfg(feature = "mesh-files")]
fn any_file_reads_or_says_why_not() {
    use leafwalk::load_mesh_with_limits;
    use leafwalk::mesh_file::Limits;
    use leafwalk_testing::properties::mesh_file::{self, MAX_BYTES, MAX_LINE};

    let limits = Limits { max_bytes: MAX_BYTES, max_line: MAX_LINE };
    let load = |path: &Path| load_mesh_with_limits(path, &limits).map(|file| (file.mesh, file.materials.len()));
    for extension in ["obj", "ply", "stl"] {
        let saved = saved(extension);
        let read = saved.iter().filter(|bytes| mesh_file::check(extension, bytes, load)).count();
        assert!(read > 0, "no saved {extension} file can be read");
        // Edits of the saved files: bytes changed, and the file cut.
        let edits = (0..2_000u64).into_par_iter().map(|i| {
            let mut random = Random::new(4, i);
            let mut bytes = saved[random.below(saved.len())].clone();
            for _ in 0..1 + random.below(4) {
                let at = random.below(bytes.len().max(1));
                if let Some(byte) = bytes.get_mut(at) {
                    *byte = if random.below(2) == 0 { random.bits() as u8 } else { b"0 -/.\n9e"[random.below(8)] };
                }
            }
            if random.below(4) == 0 {
                bytes.truncate(random.below(bytes.len().max(1)));
            }
            u64::from(mesh_file::check(extension, &bytes, load))
        });
        let read: u64 = edits.sum();
        println!("{extension}: {read} of 2000 edits can be read");
        assert!((20..1_980).contains(&read), "{read} {extension} files read: the edits test too little");
    }
}
