//! What is asked of every structure: handled conservatively, and with the test of the numeric contract, it gives what testing
//! every triangle gives, all bits; and it stands whatever numbers it gets.

use core::ops::Range;

use glam::Vec3;
use leafwalk::structures::{Exact, Line, Scene, Search, Structure, Traced};
use leafwalk::{BruteForce, Mesh};
use leafwalk_testing::differences::{differences, hard};
use leafwalk_testing::meshes;
use leafwalk_testing::tally::{Tally, scaled};

/// Rays for each structure and mesh.
const RAYS: u64 = 4000;

/// Meshes in which methods fail, and a few plain ones.
fn meshes() -> Vec<(&'static str, Mesh)> {
    let one = Mesh::new(vec![[1.0, 2.0, 3.0], [1.5, 2.0, 3.0], [1.0, 2.25, 3.0]], vec![[0, 1, 2]]);
    let flat = Mesh {
        positions: meshes::soup(200, 81).positions.into_iter().map(|[x, y, _]| [x, y, 0.25]).collect(),
        ..meshes::soup(200, 81)
    };
    vec![
        ("one triangle", one),
        ("sphere", meshes::icosphere(3)),
        ("flat", flat),
        ("needles", meshes::needle_box(40)),
        ("walls", meshes::walls(60, 82)),
        ("soup", meshes::soup(1000, 83)),
        ("far from 0", meshes::placed(&meshes::bumpy_sphere(2, 84), 1.0, 1e4)),
        ("small in a sky box", meshes::in_sky_box(&meshes::icosphere(2), 1e4, 0.3)),
    ]
}

/// Compares a structure with brute force on all meshes.
pub(crate) fn compare<S: Structure>(name: &str, settings: &S::Settings) {
    for (seed, (mesh_name, mesh)) in (80..).zip(meshes()) {
        let oracle = BruteForce::new(&mesh).expect("a mesh that builds");
        let traced = Traced::<S, Exact>::conservative(&mesh, settings).expect("the same mesh");
        let found = differences(&[(name, &traced)], &oracle, &hard(&mesh), scaled(RAYS), seed);
        found.passes(&format!("{name}, {mesh_name}"), 0.05);
    }
}

/// A structure whose margin is left out.
struct WithoutMargin<S>(S);

impl<S: Structure> Structure for WithoutMargin<S> {
    type Settings = S::Settings;
    const COPIES: bool = S::COPIES;

    fn build(scene: &Scene, settings: &S::Settings) -> Self {
        Self(S::build(&Scene { margin: 0.0, ..scene.clone() }, settings))
    }
    fn listed(&self) -> &[u32] {
        self.0.listed()
    }
    fn visit(&self, line: &Line, search: &mut impl Search) {
        self.0.visit(line, search);
    }
    fn bytes(&self) -> usize {
        self.0.bytes()
    }
}

/// Checks that the comparison notices when the margin is left out.
pub(crate) fn needs_margin<S: Structure>(name: &str, settings: &S::Settings) {
    let mut all = Tally::default();
    for (seed, (_, mesh)) in (180..).zip(meshes()) {
        let oracle = BruteForce::new(&mesh).expect("a mesh that builds");
        let traced = Traced::<WithoutMargin<S>, Exact>::conservative(&mesh, settings).expect("the same mesh");
        let found = differences(&[(name, &traced)], &oracle, &hard(&mesh), scaled(RAYS), seed);
        all.rays += found.rays;
        all.faults += found.faults;
    }
    all.catches(&format!("{name} without a margin"));
}

/// Counts what a structure does, and hits nothing.
struct Count {
    listed: usize,
    steps: usize,
}

impl Search for Count {
    fn test(&mut self, listed: Range<usize>) {
        assert!(listed.end <= self.listed, "{listed:?} of {}", self.listed);
    }

    fn end(&self) -> f32 {
        f32::INFINITY
    }

    fn step(&mut self) {
        self.steps += 1;
    }
}

/// Leads lines of all kinds of numbers, such as are none, through scenes of all sizes: nothing may panic, or loop.
pub(crate) fn endures<S: Structure>(settings: &S::Settings) {
    let numbers = [0.0, -0.0, 1.0, -0.3, 1e-38, 1e-45, -1e30, f32::MAX, f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
    let mut lines = Vec::new();
    for (i, a) in numbers.into_iter().enumerate() {
        for (j, b) in numbers.into_iter().enumerate() {
            for (k, c) in numbers.into_iter().enumerate() {
                let (t_min, t_max) = (numbers[(i + j) % numbers.len()], numbers[(j + k) % numbers.len()]);
                lines.push(Line::new([a, b, c], [c, a, b], t_min, t_max));
                lines.push(Line::new([0.1, 0.2, 0.3], [a, b, c], 0.0, f32::INFINITY));
            }
        }
    }
    let soup = meshes::soup(60, 92);
    for scale in [1.0, 1e30, 2e38, 1e-30, 1e-38, 1e-44] {
        let corner = |vertex: u32| scale * Vec3::from(soup.positions[vertex as usize]);
        let corners: Vec<_> = soup.triangles.iter().map(|triangle| triangle.map(corner)).collect();
        for margin in [0.0, 0.1 * scale] {
            let structure = S::build(&Scene { corners: corners.clone(), margin }, settings);
            lines.iter().for_each(|line| leads(&structure, line));
        }
    }
    let empty = S::build(&Scene { corners: Vec::new(), margin: 0.0 }, settings);
    lines.iter().for_each(|line| leads(&empty, line));
}

/// Leads a line through a structure, to its end, past what is there.
pub(crate) fn leads<S: Structure>(structure: &S, line: &Line) {
    let mut count = Count { listed: structure.listed().len(), steps: 0 };
    structure.visit(line, &mut count);
    assert!(count.steps <= 4 * structure.bytes(), "{line:?}: {} steps", count.steps);
}
