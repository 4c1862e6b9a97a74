#![no_main]

use leafwalk_testing::properties::trace;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    trace::check(bytes);
});
