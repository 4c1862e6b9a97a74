#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    leafwalk_fuzz::check_mesh_file("ply", bytes);
});
