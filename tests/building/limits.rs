//! Budget, depth, memory, progress, cancellation.

use core::ops::ControlFlow;
use core::sync::atomic::{AtomicU32, Ordering};
use std::sync::Mutex;

use leafwalk::{BuildError, Builder, Mesh, verify};
use leafwalk_testing::meshes;

/// References that even a small mesh may make (the builder's documented floor).
const LEAST_BUDGET: usize = 4096;

fn scenes() -> [(&'static str, Mesh); 4] {
    [
        ("soup", meshes::soup(3000, 51)),
        ("walls", meshes::walls(1500, 52)),
        ("needle box", meshes::needle_box(60)),
        ("sphere", meshes::icosphere(4)),
    ]
}

#[test]
fn references_stay_within_the_budget() {
    for (name, mesh) in scenes() {
        let mut most = Vec::new();
        for budget in [1.0, 1.5, 2.0, 4.0, 8.0] {
            let octree =
                Builder::new().step_cost(0.5).reference_budget(budget).build(&mesh).expect("a mesh that builds");
            let references = verify(&octree).expect("an octree that verifies").references as usize;
            let limit = ((f64::from(budget) * mesh.triangles.len() as f64) as usize).max(LEAST_BUDGET);
            assert!(references <= limit, "{name}, budget {budget}: {references} references, limit {limit}");
            most.push(references);
        }
        assert!(most.is_sorted(), "{name}: a larger budget is to give no fewer references: {most:?}");
    }
}

#[test]
fn no_leaf_is_deeper_than_allowed() {
    let mesh = meshes::soup(2000, 53);
    let mut deepest = Vec::new();
    for level in 0..=16 {
        let octree = Builder::new()
            .step_cost(0.5)
            .reference_budget(64.0)
            .max_level(level)
            .build(&mesh)
            .expect("a mesh that builds");
        let stats = octree.stats();
        let found = stats.leaves_at_level.iter().rposition(|leaves| *leaves > 0).expect("a leaf") as u32;
        assert!(found <= level, "level {found}, at most {level}");
        assert_eq!(octree.parts().header.max_level, level);
        verify(&octree).expect("an octree that verifies");
        deepest.push(found);
    }
    assert_eq!(deepest[..6], [0, 1, 2, 3, 4, 5]);
}

#[test]
fn memory_is_refused_before_it_is_taken() {
    for (name, mesh) in scenes() {
        for step_cost in [0.5, 48.0] {
            let builder = Builder::new().step_cost(step_cost);
            let expected = builder.build(&mesh).expect("a mesh that builds").into_words();
            let mut built = false;
            for limit in (10..28).map(|bits| 1u64 << bits) {
                match builder.clone().memory_limit(limit).build(&mesh) {
                    Ok(octree) => {
                        built = true;
                        assert!(octree.as_words() == expected, "{name}: a limit that suffices changes nothing");
                        let bytes = 4 * expected.len() as u64;
                        assert!(bytes <= limit, "{name}: {bytes} bytes within {limit}");
                    }
                    Err(BuildError::OutOfMemory { needed, limit: reported }) => {
                        assert!(!built, "{name}: {limit} fails where less sufficed");
                        assert!(reported == limit && needed > limit, "{name}: needs {needed}, limit {limit}");
                    }
                    Err(error) => panic!("{name}: {error}"),
                }
            }
            assert!(built, "{name}: 128 MiB must do");
        }
    }
}

#[test]
fn progress_never_decreases_and_reaches_the_end() {
    for (name, mesh) in scenes() {
        for builder in [Builder::new(), Builder::new().step_cost(0.5)] {
            let heard = Mutex::new(Vec::new());
            let listen = |progress: leafwalk::Progress| {
                heard.lock().expect("no panic in a listener").push(progress.fraction);
                ControlFlow::Continue(())
            };
            builder.build_with_progress(&mesh, listen).expect("a mesh that builds");
            let heard = heard.into_inner().expect("no panic in a listener");
            assert!(heard.len() > 3, "{name}: {heard:?}");
            assert!(heard.is_sorted() && heard[0] >= 0.0 && heard.last() == Some(&1.0), "{name}: {heard:?}");
        }
    }
}

#[test]
fn a_build_stops_when_it_is_told_to() {
    let mesh = meshes::soup(3000, 54);
    let reports = AtomicU32::new(0);
    let count = |_| {
        reports.fetch_add(1, Ordering::Relaxed);
        ControlFlow::Continue(())
    };
    Builder::new().build_with_progress(&mesh, count).expect("a mesh that builds");
    for stop_at in 0..reports.into_inner() {
        let heard = AtomicU32::new(0);
        let stop = |_| match heard.fetch_add(1, Ordering::Relaxed) {
            report if report == stop_at => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        };
        assert_eq!(
            Builder::new().build_with_progress(&mesh, stop).expect_err("a build that stops"),
            BuildError::Cancelled
        );
        assert_eq!(heard.into_inner(), stop_at + 1, "nothing is done after the stop");
    }
}

#[test]
fn settings_out_of_range_are_errors() {
    let mesh = meshes::soup(200, 55);
    let fault = |builder: Builder| match builder.build(&mesh).expect_err("a setting out of its range") {
        BuildError::Setting { setting, least, most, .. } => (setting, least, most),
        other => panic!("{other:?}"),
    };
    for cost in [f32::NAN, f32::INFINITY, -1.0, 0.5f32.next_down()] {
        assert_eq!(fault(Builder::new().step_cost(cost)), ("step cost", 0.5, f64::from(f32::MAX)));
    }
    for budget in [f32::NAN, f32::INFINITY, 0.0, 1f32.next_down()] {
        assert_eq!(fault(Builder::new().reference_budget(budget)), ("reference budget", 1.0, f64::from(f32::MAX)));
    }
    for level in [17, u32::MAX] {
        assert_eq!(fault(Builder::new().max_level(level)), ("maximum level", 0.0, 16.0));
    }
    let text = |builder: Builder| builder.build(&mesh).expect_err("a setting out of its range").to_string();
    assert_eq!(text(Builder::new().max_level(17)), "the maximum level is 17: set it to a number from 0 to 16");
    assert_eq!(text(Builder::new().step_cost(f32::NAN)), "the step cost is NaN: set it to a finite number from 0.5 on");
    let ends = [Builder::new().step_cost(0.5).reference_budget(1.0), Builder::new().step_cost(f32::MAX).max_level(0)];
    for builder in ends {
        verify(&builder.build(&mesh).expect("settings at the ends of their ranges")).expect("an octree that verifies");
    }
}

#[test]
fn octrees_know_whether_they_suit_walks() {
    let mesh = meshes::soup(200, 56);
    for (builder, suits) in [
        (Builder::new(), false),
        (Builder::for_walks(), true),
        (Builder::for_descents(), false),
        (Builder::for_walks().step_cost(8.0), true),
    ] {
        assert_eq!(Builder::suits_walks(&builder.build(&mesh).expect("a mesh that builds")), suits);
    }
}
