//! The tables and the arithmetic, as the device has them.

use leafwalk_core::tables::{EXIT_FACE, SUB_FACE};
use leafwalk_gpu::testing::{Arithmetic, checks, self_test_of, table_entries};
use leafwalk_gpu::{Departure, Exactness, Flavour, Gpu, SelfTest};

use crate::Test;

pub(crate) const TESTS: &[Test] = &[
    ("tables are read back entry by entry", tables),
    ("guarded arithmetic rounds once, to nearest", exact),
    ("quotients that are off are brought to the nearest number", divides),
    ("the self-test tells flavours apart", distinguishes),
];

fn tables(gpu: &Gpu) {
    let expected = EXIT_FACE.as_flattened().iter().chain(SUB_FACE.as_flattened());
    let entries = table_entries(gpu).expect("a working device");
    assert_eq!(entries, expected.map(|entry| u32::from(*entry)).collect::<Vec<_>>());
}

fn exact(gpu: &Gpu) {
    let report = SelfTest::of(gpu, Flavour::Exact).expect("a working device");
    println!("{}: {report}", gpu.adapter());
    assert_eq!(report.exactness(), Exactness::Exact, "{report}");
}

fn divides(gpu: &Gpu) {
    const QUOTIENT: &str = "return guard(a / b);";
    let text = checks(Arithmetic::Exact);
    assert!(text.contains(QUOTIENT));
    // WebGPU allows 2.5 units in the last place.
    for off in -3i32..=3 {
        let spoiled = format!("return guard(select(bitcast<f32>(bitcast<i32>(a / b) + {off}), 0.0, a == 0.0));");
        let report = self_test_of(gpu, &text.replace(QUOTIENT, &spoiled)).expect("a working device");
        assert_eq!(report.exactness(), Exactness::Exact, "{off} units off: {report}");
    }
}

fn distinguishes(gpu: &Gpu) {
    let [exact, unguarded] = [Arithmetic::Exact, Arithmetic::Unguarded]
        .map(|arithmetic| self_test_of(gpu, &checks(arithmetic)).expect("a working device"));
    for (exact, unguarded) in exact.counts.iter().zip(&unguarded.counts) {
        // Left alone, a driver does to the text without guards what it does to a plain expression.
        if matches!(exact.departure, Departure::Contraction | Departure::Reassociation) {
            assert_eq!((exact.plain, exact.flavoured), (unguarded.flavoured, 0), "{:?}", exact.departure);
        }
    }
}
