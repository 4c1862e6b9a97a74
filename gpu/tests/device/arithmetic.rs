//! The tables and the arithmetic, as the device has them.

use leafwalk_core::tables::{EXIT_FACE, SUB_FACE};
use leafwalk_gpu::shader;
use leafwalk_gpu::{Flavour, Gpu, Matter, Promise};

use crate::Test;

pub(crate) const TESTS: &[Test] = &[
    ("tables are read back entry by entry", tables),
    ("guarded arithmetic rounds once, to nearest", exact),
    ("quotients that are off are brought to the nearest number", divides),
    ("the self-test tells flavours apart", distinguishes),
];

fn tables(gpu: &Gpu) {
    let expected = EXIT_FACE.as_flattened().iter().chain(SUB_FACE.as_flattened());
    let entries = gpu.table_entries().expect("a working device");
    assert_eq!(entries, expected.map(|entry| u32::from(*entry)).collect::<Vec<_>>());
}

fn exact(gpu: &Gpu) {
    let report = gpu.self_test(Flavour::Exact).expect("a working device");
    println!("{}: {report}", gpu.adapter());
    assert_eq!(report.promise(), Promise::Exact, "{report}");
}

fn divides(gpu: &Gpu) {
    const QUOTIENT: &str = "return guard(a / b);";
    let text = shader::checks(Flavour::Exact);
    assert!(text.contains(QUOTIENT));
    // WebGPU allows 2.5 units in the last place.
    for off in -3i32..=3 {
        let spoiled = format!("return guard(select(bitcast<f32>(bitcast<i32>(a / b) + {off}), 0.0, a == 0.0));");
        let report = gpu.self_test_of(&text.replace(QUOTIENT, &spoiled)).expect("a working device");
        assert_eq!(report.promise(), Promise::Exact, "{off} units off: {report}");
    }
}

fn distinguishes(gpu: &Gpu) {
    let [exact, unguarded] =
        [Flavour::Exact, Flavour::Unguarded].map(|flavour| gpu.self_test(flavour).expect("a working device"));
    for (exact, unguarded) in exact.findings.iter().zip(&unguarded.findings) {
        // Left alone, a driver does to the text without guards what it does to a plain expression.
        if matches!(exact.matter, Matter::Contraction | Matter::Reassociation) {
            assert_eq!((exact.plain, exact.flavoured), (unguarded.flavoured, 0), "{:?}", exact.matter);
        }
    }
}
