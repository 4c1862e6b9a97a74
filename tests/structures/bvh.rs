//! Bounding volume hierarchies, and how they follow vertices that move.

use leafwalk::structures::bvh::{Ball, KDop, OrientedBox, Settings, Splits};
use leafwalk::structures::{Bounds, Bvh, Exact, Refit, RefitError, Traced};
use leafwalk::{BruteForce, Mesh};
use leafwalk_testing::differences::{differences, hard};
use leafwalk_testing::meshes;
use leafwalk_testing::tally::scaled;

use crate::comparison::{compare, endures, needs_margin};

/// By median, in small leaves.
const HALVES: Settings = Settings { splits: Splits::Median, leaf: 2 };

#[test]
fn hierarchies_of_boxes() {
    compare::<Bvh<Bounds>>("boxes by surface area", &Settings::default());
    compare::<Bvh<Bounds>>("boxes by median", &HALVES);
    needs_margin::<Bvh<Bounds>>("boxes", &HALVES);
}

#[test]
fn hierarchies_of_balls() {
    compare::<Bvh<Ball>>("balls by surface area", &Settings::default());
    compare::<Bvh<Ball>>("balls by median", &HALVES);
    needs_margin::<Bvh<Ball>>("balls", &HALVES);
}

#[test]
fn hierarchies_of_oriented_boxes() {
    compare::<Bvh<OrientedBox>>("oriented boxes by surface area", &Settings::default());
    compare::<Bvh<OrientedBox>>("oriented boxes by median", &HALVES);
    needs_margin::<Bvh<OrientedBox>>("oriented boxes", &HALVES);
}

#[test]
fn no_number_leads_astray() {
    endures::<Bvh<Bounds>>(&HALVES);
    endures::<Bvh<Bounds>>(&Settings::default());
    endures::<Bvh<Ball>>(&HALVES);
    endures::<Bvh<OrientedBox>>(&HALVES);
    endures::<Bvh<KDop>>(&HALVES);
}

#[test]
fn hierarchies_of_polytopes() {
    compare::<Bvh<KDop>>("polytopes by surface area", &Settings::default());
    compare::<Bvh<KDop>>("polytopes by median", &HALVES);
    needs_margin::<Bvh<KDop>>("polytopes", &HALVES);
}

/// Rays over the mesh that moved.
const RAYS: u64 = 4000;

/// A mesh, and the same triangles twisted about an axis, farther the higher they are.
fn twisted() -> [Mesh; 2] {
    let before = meshes::bumpy_sphere(3, 91);
    let twist = |[x, y, z]: [f32; 3]| {
        let (sine, cosine) = (2.0 * z).sin_cos();
        [cosine * x - sine * y, sine * x + cosine * y, 3.0 * z + 1.0]
    };
    let after = Mesh { positions: before.positions.iter().copied().map(twist).collect(), ..before.clone() };
    [before, after]
}

fn follows<S: Refit<Settings = Settings>>(name: &str) {
    let [before, after] = twisted();
    let oracle = BruteForce::new(&after).expect("a mesh that builds");
    let mut traced = Traced::<S, Exact>::conservative(&before, &Settings::default()).expect("a mesh that builds");
    let source = hard(&after);
    let stale = differences(&[(name, &traced)], &oracle, &source, scaled(RAYS), 92);
    stale.catches(&format!("{name} that were not refit"));
    traced.refit(&after).expect("the same triangles");
    differences(&[(name, &traced)], &oracle, &source, scaled(RAYS), 92).passes(name, 0.05);
}

#[test]
fn hierarchies_follow_their_triangles() {
    follows::<Bvh<Bounds>>("boxes");
    follows::<Bvh<Ball>>("balls");
    follows::<Bvh<OrientedBox>>("oriented boxes");
    follows::<Bvh<KDop>>("polytopes");
}

#[test]
fn other_triangles_are_refused_and_nothing_is_changed() {
    let [mesh, _] = twisted();
    let other = meshes::icosphere(1);
    let mut traced =
        Traced::<Bvh<Bounds>, Exact>::conservative(&mesh, &Settings::default()).expect("a mesh that builds");
    let expected = RefitError::OtherTriangles { found: other.triangles.len(), expected: mesh.triangles.len() };
    assert_eq!(traced.refit(&other), Err(expected));
    let oracle = BruteForce::new(&mesh).expect("a mesh that builds");
    differences(&[("boxes", &traced)], &oracle, &hard(&mesh), 500, 93).passes("boxes", 0.05);
}
