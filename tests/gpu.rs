//! The command on a GPU. Without a software adapter the tests are reported as ignored; with LEAFWALK_REQUIRE_GPU set, they
//! fail.

use std::process::ExitCode;

use leafwalk::gpu::{AdapterKind, adapters};
use leafwalk_testing::meshes::{bumpy_sphere, icosphere};
use leafwalk_testing::shell::{Outcome, Shell, obj};
use libtest_mimic::{Arguments, Failed, Trial};

/// What runs, by name.
const TESTS: [(&str, fn()); 7] = [
    ("a GPU traces and renders what the CPU does", same_answers),
    ("adapters are listed with what they promise", listing),
    ("an adapter that is not there is named with those that are", no_such_adapter),
    ("software adapters are taken on request only", software),
    ("the environment picks an adapter", environment),
    ("a compact octree is refused", compact),
    ("the CPU stands in where that is asked for", standing_in),
];

fn main() -> ExitCode {
    let has_adapter = adapters().iter().any(|adapter| adapter.kind == AdapterKind::Software);
    let is_required = std::env::var_os("LEAFWALK_REQUIRE_GPU").is_some();
    let trial = |(name, test): (&'static str, fn())| match (has_adapter, is_required) {
        (true, _) => Trial::test(name, move || {
            test();
            Ok(())
        }),
        (false, true) => Trial::test(name, || Err(Failed::from("there is no software adapter"))),
        (false, false) => Trial::test(format!("{name}: no software adapter"), || Ok(())).with_ignored_flag(true),
    };
    libtest_mimic::run(&Arguments::from_args(), TESTS.map(trial).into()).exit_code()
}

/// An empty folder for the command of this build.
fn shell() -> Shell {
    Shell::new(env!("CARGO_BIN_EXE_leafwalk"))
}

fn same_answers() {
    let shell = shell();
    shell.write("sphere.obj", obj(&bumpy_sphere(3, 1)));
    let rays = (0..2000).map(|i| {
        let angle = i as f32 * 0.37;
        // Numbers that f32 holds: a GPU rounds others, and the CPU does not.
        let [x, dx, dy] = [3.0 * angle.cos(), -angle.cos(), angle.sin() * 0.2].map(|c| (c * 1024.0).round() / 1024.0);
        format!("{x},0.125,0.25,{dx},{dy},0.125\n")
    });
    shell.write("rays.csv", rays.collect::<String>());
    shell.run("build sphere.obj -o sphere.lwk").assert_code(0);
    let cpu = shell.json("trace sphere.lwk rays.csv -o cpu.csv");
    let gpu = shell.json("trace sphere.lwk rays.csv -o gpu.csv --backend gpu --adapter software");
    assert_eq!(gpu["hit_hash"], cpu["hit_hash"]);
    assert!(gpu["hits"].as_u64().is_some_and(|hits| hits > 100), "{gpu}");
    assert_eq!([&gpu["backend"], &gpu["flavour"], &gpu["promise"]], ["gpu", "exact", "exact"]);
    // The octree was built for CPUs, and meshes are built for what traces them.
    assert!(gpu["octree_advice"].as_str().is_some_and(|advice| advice.contains("--for-walks")), "{gpu}");
    assert!(cpu.get("octree_advice").is_none(), "{cpu}");
    let built = shell.json("render sphere.obj -o built.png --size 64x48 --backend gpu --adapter software");
    assert!(built.get("octree_advice").is_none(), "{built}");
    assert!(gpu["adapter"].as_str().is_some_and(|name| name.contains(" by ")), "{gpu}");
    assert!(shell.read("cpu.csv") == shell.read("gpu.csv"), "the hits differ");

    for shade in ["lit", "normal", "depth", "primitive", "cells"] {
        let render = format!("render sphere.lwk --shade {shade} --size 64x48");
        shell.run(&format!("{render} -o cpu.png")).assert_code(0);
        let report = shell.json(&format!("{render} -o gpu.png --backend gpu --adapter software"));
        assert_eq!(report["backend"], "gpu");
        assert!(shell.read("cpu.png") == shell.read("gpu.png"), "{shade}: the pictures differ");
    }
    let fast = shell.json("trace sphere.lwk rays.csv -o gpu.csv --backend gpu --adapter software --flavour fast");
    assert_eq!([&fast["flavour"], &fast["hits"]], [&"fast".into(), &cpu["hits"]]);
}

fn listing() {
    let listed = shell().json("gpu");
    let adapters = adapters();
    assert_eq!(listed["adapters"], adapters.len());
    for (printed, adapter) in listed["list"].as_array().expect("a list").iter().zip(adapters) {
        assert_eq!(printed["name"], adapter.to_string());
        assert_eq!(printed["binding_bytes"], adapter.binding_bytes);
        assert!(adapter.kind != AdapterKind::Software || printed["exact"] == "exact", "{printed}");
    }
}

fn no_such_adapter() {
    let shell = shell();
    shell.write("sphere.obj", obj(&icosphere(1)));
    let there = adapters().first().map(ToString::to_string).expect("an adapter");
    let outcome = shell.run("render sphere.obj -o a.png --backend gpu --adapter abacus");
    outcome.assert_code(1);
    // Drivers may have put lines of their own before it.
    let last = outcome.stderr.lines().last().unwrap_or_default();
    assert!(last.starts_with("error: ") && last.contains("'abacus'") && last.contains(&there), "{outcome:?}");
    assert_eq!(shell.names(), ["sphere.obj"]);
}

/// Renders on the adapter that the environment picks.
fn render_on(adapter: &str) -> Outcome {
    let shell = shell();
    shell.write("sphere.obj", obj(&icosphere(1)));
    let mut command = shell.command("render sphere.obj -o a.png --backend gpu");
    Outcome::of(command.env("LEAFWALK_ADAPTER", adapter).output().expect("the command starts"))
}

fn software() {
    if adapters().iter().any(|adapter| adapter.kind != AdapterKind::Software) {
        return println!("skipped: this machine has a GPU, which auto takes");
    }
    let outcome = render_on("auto");
    outcome.assert_code(1);
    let there = adapters().first().map(ToString::to_string).expect("an adapter");
    assert!(outcome.stderr.contains("no adapter is hardware") && outcome.stderr.contains(&there), "{outcome:?}");
}

fn environment() {
    let outcome = render_on("abacus");
    outcome.assert_code(1);
    assert!(outcome.stderr.contains("'abacus'"), "{outcome:?}");
    render_on("software").assert_code(0);
}

fn compact() {
    let shell = shell();
    shell.write("sphere.obj", obj(&icosphere(1)));
    shell.run("build sphere.obj -o small.lwk --compact").assert_code(0);
    let outcome = shell.run("render small.lwk -o a.png --backend gpu --adapter software");
    outcome.assert_code(1);
    let last = outcome.stderr.lines().last().unwrap_or_default();
    assert!(last.starts_with("error: ") && last.contains("without `compact`"), "{outcome:?}");
    assert_eq!(shell.names(), ["small.lwk", "sphere.obj"]);
}

fn standing_in() {
    let shell = shell();
    shell.write("sphere.obj", obj(&icosphere(2)));
    let cpu = shell.json("render sphere.obj -o cpu.png --size 64x48");
    assert!(cpu.get("instead_of_gpu").is_none(), "{cpu}");
    let stand_in = shell.json("render sphere.obj -o stand_in.png --size 64x48 --backend gpu --adapter abacus --or-cpu");
    assert_eq!(stand_in["backend"], "cpu");
    assert!(stand_in["instead_of_gpu"].as_str().is_some_and(|reason| reason.contains("'abacus'")), "{stand_in}");
    assert!(shell.read("cpu.png") == shell.read("stand_in.png"), "the pictures differ");
    let gpu = shell.json("render sphere.obj -o gpu.png --size 64x48 --backend gpu --adapter software --or-cpu");
    assert_eq!([&gpu["backend"], &gpu["instead_of_gpu"]], [&"gpu".into(), &serde_json::Value::Null]);
    assert!(shell.read("cpu.png") == shell.read("gpu.png"), "smaller leaves change the picture");
}
