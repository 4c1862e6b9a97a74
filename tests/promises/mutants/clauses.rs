//! Mutants of the walk's clauses that plain scenes show.

use leafwalk::{Builder, CpuTracer, Mesh, Octree, Ray};
use leafwalk_core::step::{Pluecker, Slab};
use leafwalk_core::testing::{Policy, Standard};
use leafwalk_cpu::testing::{self, Spoiled, spoil};
use leafwalk_testing::differences::{Source, differences, hard};
use leafwalk_testing::random::Random;
use leafwalk_testing::rays::{Shared, Target, extent, point_on};
use leafwalk_testing::tally::{Tally, scaled};
use leafwalk_testing::tracers::{Every, Named, OneByOne, Stepping, SteppingFrom};
use leafwalk_testing::{meshes, rays};

use crate::watertight::{Depth, aimed, inside, misses};

const RAYS: u64 = 20_000;

/// P2 under a policy, by both kinds of step.
pub(crate) fn under<P: Policy + Sync>(octree: &Octree<Vec<u32>>, source: Source<'_>, seed: u64) -> Tally {
    let parts = octree.parts();
    let slab = Stepping::<Slab, P>::new(&parts);
    let pluecker = Stepping::<Pluecker, P>::new(&parts);
    let tracers: [Named<'_>; 2] = [("slab steps", &slab), ("Plücker steps", &pluecker)];
    differences(&tracers, &Every::<f32>::of(octree), source, scaled(RAYS), seed)
}

/// P2 of the walk in eight lanes, which knows no policies: for octrees that were built wrong.
pub(crate) fn in_lanes(octree: &Octree<Vec<u32>>, source: Source<'_>, seed: u64) -> Tally {
    let tracers =
        [CpuTracer::new(octree.view()), testing::portable(CpuTracer::new(octree.view()))].map(testing::walked);
    let tracers: [Named<'_>; 2] = [("walks in lanes", &tracers[0]), ("portable walks in lanes", &tracers[1])];
    differences(&tracers, &Every::<f32>::of(octree), source, scaled(RAYS), seed)
}

#[derive(Clone, Copy)]
struct FirstHit;
impl Policy for FirstHit {
    const STOPS_AT_FIRST_HIT: bool = true;
}

#[test]
fn stop_at_the_first_hit() {
    let mesh = meshes::soup(1000, 61);
    let octree = Builder::new().build(&mesh).expect("a mesh that builds");
    under::<Standard>(&octree, &hard(&mesh), 61).passes("the walk on, P2", 0.05);
    under::<FirstHit>(&octree, &hard(&mesh), 61).catches("stop at the first hit");
}

#[derive(Clone, Copy)]
struct Trusting;
impl Policy for Trusting {
    const TRUSTS_LEAVES: bool = true;
}

#[test]
fn known_leaves_trusted() {
    fn check<P: Policy + Sync>(octree: &Octree<Vec<u32>>, source: Source<'_>) -> Tally {
        let parts = octree.parts();
        let slab = SteppingFrom::<Slab, P>::new(&parts);
        let pluecker = SteppingFrom::<Pluecker, P>::new(&parts);
        let tracers: [Named<'_>; 2] = [("slab steps", &slab), ("Plücker steps", &pluecker)];
        differences(&tracers, &Every::<f32>::of(octree), source, scaled(RAYS), 70)
    }
    let mesh = meshes::soup(1000, 70);
    let octree = Builder::new().build(&mesh).expect("a mesh that builds");
    check::<Standard>(&octree, &hard(&mesh)).passes("known leaves looked at, P2", 0.05);
    check::<Trusting>(&octree, &hard(&mesh)).catches("known leaves trusted");
}

/// From 1e5 to 1e7 sizes away.
fn far(mesh: &Mesh) -> impl Fn(&mut Random) -> Ray + Sync + use<'_> {
    let (centre, size) = extent(mesh);
    move |random: &mut Random| {
        let distance = size * 10f32.powf(5.0 + 2.0 * random.unit());
        let away = random.direction();
        let origin = core::array::from_fn(|k| centre[k] + distance * away[k]);
        rays::towards(origin, point_on(mesh, Target::Inside, random))
    }
}

#[derive(Clone, Copy)]
struct Reported;
impl Policy for Reported {
    const ORDERS_BY_REPORTED: bool = true;
}

#[test]
fn order_by_the_reported_t() {
    let mesh = meshes::soup(1000, 62);
    let octree = Builder::new().build(&mesh).expect("a mesh that builds");
    under::<Standard>(&octree, &far(&mesh), 62).passes("order by t', P2 from afar", 0.01);
    under::<Reported>(&octree, &far(&mesh), 62).catches("order by reported t");
}

#[test]
fn collinear_triangles_dropped() {
    let mesh = meshes::needle_box(30);
    let check = |spoiled| {
        let octree = spoil(Builder::new(), spoiled).build(&mesh).expect("a mesh that builds");
        let inside = inside(&mesh, Depth::Safe, 256, 63);
        let tracers: [Named<'_>; 2] = [("the octree", &octree), ("batches", &CpuTracer::new(octree.view()))];
        misses(aimed, &tracers, &mesh, &inside, Target::Edge, RAYS, 63)
    };
    check(Spoiled::Nothing).passes("collinear triangles kept, P1", 1.0);
    check(Spoiled::CollinearTriangles).catches("collinear triangles dropped");
}

/// A box whose faces lie in those of the root, cut into triangles at random places.
fn touching_box(seed: u64) -> Mesh {
    let mut random = Random::new(seed, 0);
    let mut positions = Vec::new();
    for face in 0..6 {
        for _ in 0..40 {
            // Corners, points of edges and points inside the face.
            let corner = |random: &mut Random| {
                let mut at = core::array::from_fn(|_| match random.below(3) {
                    0 => 0.0,
                    1 => 1.0,
                    _ => random.unit(),
                });
                at[face / 2] = (face % 2) as f32;
                at
            };
            positions.extend([corner(&mut random), corner(&mut random), corner(&mut random)]);
        }
    }
    // The whole faces' corners fix the frame to 0..1.
    positions.extend([[0.0; 3], [1.0; 3], [1.0, 0.0, 1.0]]);
    let triangles = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh::new(positions, triangles)
}

/// Rays from outside at edges and vertices, of which many lie in the root's faces, edges and corners.
fn from_outside(mesh: &Mesh) -> impl Fn(&mut Random) -> Ray + Sync + use<'_> {
    move |random: &mut Random| {
        let distance = 10f32.powf(3.0 * random.unit());
        let away = random.direction();
        let origin = core::array::from_fn(|k| 0.5 + (distance + 1.0) * away[k]);
        let target = [Target::Vertex, Target::Edge][random.below(2)];
        rays::towards(origin, point_on(mesh, target, random))
    }
}

#[derive(Clone, Copy)]
struct Undilated;
impl Policy for Undilated {
    const DILATES_ROOT: bool = false;
    const KEEPS_MESH_MARGIN: bool = false;
}

#[derive(Clone, Copy)]
struct Clamped;
impl Policy for Clamped {
    const CLAMPS_T_MIN: bool = true;
    const KEEPS_MESH_MARGIN: bool = false;
}

/// The margin between mesh and root hides these two: no hit is near enough to where a ray enters the root. So a mesh
/// without it is built.
#[test]
fn the_roots_test_undilated_and_t_min_clamped() {
    let mesh = touching_box(64);
    let octree = spoil(Builder::new(), Spoiled::MeshMargin).build(&mesh).expect("a mesh that builds");
    let frame = octree.parts().frame;
    assert_eq!((frame.to_caller(frame.corner), frame.scale()), ([0.0; 3], 1.0), "the mesh must touch the root's faces");
    under::<Standard>(&octree, &from_outside(&mesh), 64).passes("dilated, not clamped, P2", 0.5);
    under::<Undilated>(&octree, &from_outside(&mesh), 64).catches("undilated root test");
    under::<Clamped>(&octree, &from_outside(&mesh), 64).catches("t_min clamped after a move");
}

#[test]
fn boxes_too_small() {
    let mesh = meshes::soup(1000, 65);
    let check = |spoiled: Spoiled| {
        let octree = spoil(Builder::new(), spoiled).build(&mesh).expect("a mesh that builds");
        let batches = CpuTracer::new(octree.view());
        let singles = OneByOne(&batches);
        let every = Every::<f32>::of(&octree);
        let tracers: [Named<'_>; 2] = [("batches", &batches), ("single rays", &singles)];
        differences(&tracers, &every, &hard(&mesh), scaled(RAYS), 65)
    };
    check(Spoiled::Nothing).passes("whole boxes, P2", 0.05);
    check(Spoiled::Boxes).catches("boxes a lattice step too small");
    let build = |spoiled| spoil(Builder::new(), spoiled).build(&mesh).expect("a mesh that builds");
    in_lanes(&build(Spoiled::Nothing), &hard(&mesh), 65).passes("whole boxes, P2 of walks in lanes", 0.05);
    in_lanes(&build(Spoiled::Boxes), &hard(&mesh), 65).catches("boxes a lattice step too small, in lanes");
}

#[test]
fn boxes_a_step_of_their_lattice_too_small() {
    // Triangles of a few steps of the lattices of the deepest nodes.
    let detail = meshes::shards(3000, 1e-5..1e-3, 1.0, 68);
    let mesh = meshes::in_sky_box(&detail, 1e5, 0.1);
    let check = |spoiled: Spoiled| {
        let octree = spoil(Builder::new(), spoiled).build(&mesh).expect("a mesh that builds");
        assert!(!octree.lattices().is_empty());
        let batches = CpuTracer::new(octree.view());
        let (singles, streamed) = (OneByOne(&batches), testing::streamed(batches.clone()));
        let every = Every::<f32>::of(&octree);
        let tracers: [Named<'_>; 3] = [("batches", &batches), ("single rays", &singles), ("streams", &streamed)];
        let found = differences(&tracers, &every, &hard(&detail), scaled(RAYS), 68);
        (found, in_lanes(&octree, &hard(&detail), 68), under::<Standard>(&octree, &hard(&detail), 68))
    };
    let (descents, in_lanes, walks) = check(Spoiled::Nothing);
    descents.passes("lattices, P2", 0.05);
    in_lanes.passes("lattices, P2 of walks in lanes", 0.05);
    walks.passes("lattices, P2 of walks", 0.05);
    let (descents, in_lanes, walks) = check(Spoiled::Boxes);
    descents.catches("boxes a step of their lattice too small");
    in_lanes.catches("boxes a step of their lattice too small, in lanes");
    walks.catches("boxes a step of their lattice too small, on walks");
}

#[test]
fn beams_too_narrow() {
    // Triangles about as large as what a run aims at, so that some of them lie at the rim of their beams.
    let mesh = meshes::icosphere(3);
    let octree = Builder::new().build(&mesh).expect("a mesh that builds");
    let every = Every::<f32>::of(&octree);
    let (centre, size) = extent(&mesh);
    for (shares, seed) in Shared::ALL.into_iter().zip(66..) {
        // By how much beams are too narrow, in lattice steps: so much that hundreds of the rays, or dozens at least, are at
        // the rim that is cut off. Runs that share an end or eights have many there, the others few.
        let cut = match shares {
            Shared::End | Shared::Eights => 64.0,
            Shared::Origin | Shared::Nothing => 640.0,
        };
        let source = |random: &mut Random| rays::coherent(shares, &mesh, centre, size, random);
        let check =
            |tracer: &CpuTracer<&[u32]>| differences(&[("batches", tracer)], &every, &source, scaled(RAYS), seed);
        for tracer in [CpuTracer::new(octree.view()), testing::portable(CpuTracer::new(octree.view()))] {
            check(&tracer).passes(&format!("whole beams, runs that share {shares:?}"), 0.1);
            check(&testing::with_beam_margin(tracer, -cut))
                .catches(&format!("beams too narrow, runs that share {shares:?}"));
        }
    }
}

#[test]
fn beams_too_narrow_in_wide_octrees() {
    let detail = meshes::icosphere(3);
    let octree = Builder::new().build(&meshes::in_sky_box(&detail, 1e4, 0.1)).expect("a mesh that builds");
    assert!(!octree.lattices().is_empty());
    let every = Every::<f32>::of(&octree);
    let (centre, size) = extent(&detail);
    for (shares, seed) in Shared::ALL.into_iter().zip(76..) {
        // Here this counts in proportion to the margin: some two hundredths of the distance are cut off.
        let cut = 640.0;
        let source = |random: &mut Random| rays::coherent(shares, &detail, centre, size, random);
        let check =
            |tracer: &CpuTracer<&[u32]>| differences(&[("batches", tracer)], &every, &source, scaled(RAYS), seed);
        for tracer in [CpuTracer::new(octree.view()), testing::portable(CpuTracer::new(octree.view()))] {
            check(&tracer).passes(&format!("whole beams in a wide octree, runs that share {shares:?}"), 0.1);
            check(&testing::with_beam_margin(tracer, -cut))
                .catches(&format!("beams too narrow in a wide octree, runs that share {shares:?}"));
        }
    }
}
