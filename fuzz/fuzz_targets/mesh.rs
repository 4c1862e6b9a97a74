#![no_main]

use leafwalk_testing::properties::mesh;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    mesh::check(bytes);
});
