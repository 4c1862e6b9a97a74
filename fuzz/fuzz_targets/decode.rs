#![no_main]

use leafwalk_testing::properties::decode;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    decode::check(bytes);
});
