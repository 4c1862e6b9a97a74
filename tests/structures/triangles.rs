//! Triangle tests: where they agree, and where rays pass between triangles.

use glam::{DVec3, Vec3};
use leafwalk::structures::triangles::{
    BaldwinWeber, Exact, InCallersUnits, MollerTrumbore, Plucker, Projected, TriangleTest, Watertight,
};
use leafwalk::structures::{Every, Traced};
use leafwalk_core::{CanonicalRay, Clock};
use leafwalk_testing::meshes;
use leafwalk_testing::random::Random;
use leafwalk_testing::rays::{Target, point_on, towards};
use leafwalk_testing::tally::scaled;

/// Unit roundoff of f32.
const ROUNDOFF: f64 = leafwalk_core::contract::ROUNDOFF as f64;
/// The lattice's edge.
const EDGE: f32 = leafwalk_core::layout::LATTICE as f32;
/// How far weights may be off: points of up to one edge are rounded some ten times, and a triangle's heights go down to a
/// fiftieth of an edge.
const WEIGHT_ERROR: f64 = 500.0 * ROUNDOFF;
/// The same where moments about 0 are added up, which are those of the triangle's edges times their distance from 0.
const MOMENTS_ERROR: f64 = 4.0 * WEIGHT_ERROR;
/// How far t may be off, in lattice steps: some ten roundoffs of an edge, on planes that are met at 17 degrees and more.
const T_ERROR: f64 = 32.0 * ROUNDOFF * EDGE as f64;

/// A line and a triangle.
struct Case {
    ray: CanonicalRay,
    corners: [[f32; 3]; 3],
}

fn ray(origin: Vec3, direction: Vec3) -> CanonicalRay {
    let (origin, direction) = (origin.to_array(), direction.to_array());
    let clock = Clock { entry: 0.0, unit: 1.0 };
    CanonicalRay { origin, within: origin, t_min: f32::NEG_INFINITY, direction, t_max: f32::INFINITY, clock }
}

impl Case {
    /// A triangle without small angles, and a ray that does not graze its plane, meeting it in or around the triangle.
    fn ordinary(random: &mut Random) -> Self {
        loop {
            let mut place = |reach: f32| Vec3::splat(0.5 * EDGE) + reach * Vec3::from(random.vector());
            let (centre, origin) = (place(0.3 * EDGE), place(0.5 * EDGE));
            let corners = [(); 3].map(|()| centre + 0.1 * EDGE * Vec3::from(random.vector()));
            let [a, b, c] = corners;
            let normal = (b - a).cross(c - a);
            let longest = (b - a).length().max((c - b).length()).max((a - c).length());
            let target = a + (2.0 * random.unit() - 0.5) * (b - a) + (2.0 * random.unit() - 0.5) * (c - a);
            let direction = (target - origin) / (target - origin).abs().max_element();
            let is_square_on = normal.dot(direction).abs() > 0.3 * normal.length() * direction.length();
            let is_well_shaped = longest > 0.05 * EDGE && normal.length() > 0.4 * longest * longest;
            if is_square_on && is_well_shaped {
                return Self { ray: ray(origin, direction), corners: corners.map(|corner| corner.to_array()) };
            }
        }
    }

    /// t, u and v of the plane, in f64.
    fn truth(&self) -> [f64; 3] {
        let [a, b, c] = self.corners.map(|corner| DVec3::from(corner.map(f64::from)));
        let [o, d] = [self.ray.origin, self.ray.direction].map(|v| DVec3::from(v.map(f64::from)));
        let (to_b, to_c, from_corner) = (b - a, c - a, o - a);
        let (p, q) = (d.cross(to_c), from_corner.cross(to_b));
        [to_c.dot(q), from_corner.dot(p), d.dot(q)].map(|x| x / to_b.dot(p))
    }

    fn meet<T: TriangleTest>(&self) -> Option<[f32; 3]> {
        T::meet(&T::ray(&self.ray), &T::triangle(&self.corners)).map(|met| [met.t, met.u, met.v])
    }
}

/// Compares a test with f64 where the point is farther from the triangle's border, in weights, than they may be off.
fn agrees<T: TriangleTest>(name: &str, weight_error: f64) {
    let (mut hits, mut worst) = (0, [0f64; 3]);
    for index in 0..scaled(50_000) {
        let case = Case::ordinary(&mut Random::new(85, index));
        let truth @ [_, u, v] = case.truth();
        let within = u.min(v).min(1.0 - u - v);
        if within.abs() < weight_error {
            continue;
        }
        let met = case.meet::<T>();
        assert_eq!(met.is_some(), within > 0.0, "{name}, case {index}: {met:?} where {truth:?}");
        if let Some(met) = met {
            hits += 1;
            for k in 0..3 {
                worst[k] = worst[k].max((f64::from(met[k]) - truth[k]).abs());
            }
        }
    }
    let [t, u, v] = worst;
    println!("{name}: {hits} hits, t off by {t:e}, u by {u:e}, v by {v:e}");
    assert!(hits > 5000 && t < T_ERROR && u.max(v) < weight_error, "{name}: {hits} hits, off by {worst:?}");
}

#[test]
fn all_agree_on_ordinary_triangles() {
    agrees::<Exact>("exact", WEIGHT_ERROR);
    agrees::<Projected>("projected", WEIGHT_ERROR);
    agrees::<MollerTrumbore<false>>("Möller-Trumbore", WEIGHT_ERROR);
    agrees::<MollerTrumbore<true>>("Möller-Trumbore with tolerance", WEIGHT_ERROR);
    agrees::<BaldwinWeber>("Baldwin-Weber", WEIGHT_ERROR);
    agrees::<Plucker>("Plücker", MOMENTS_ERROR);
    agrees::<Watertight>("watertight", WEIGHT_ERROR);
}

/// What a hit is made of is a number each, or no hit will be made of it.
fn survives<T: InCallersUnits>() {
    let numbers = [0.0, -0.0, 1.0, -3.0, 1e-38, 1e-45, 1e30, f32::MAX, f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
    for index in 0..scaled(50_000) {
        let mut random = Random::new(86, index);
        // With few numbers to choose from, many corners coincide or lie on a line.
        let choices = [3, 4, numbers.len()][random.below(3)];
        let mut point = || [(); 3].map(|()| numbers[random.below(choices)]);
        let case = Case { corners: [point(), point(), point()], ray: ray(point().into(), point().into()) };
        if let Some([t, u, v]) = case.meet::<T>() {
            assert!(!t.is_finite() || !(u.is_nan() || v.is_nan()), "{:?}, {:?}", case.ray, case.corners);
        }
    }
}

#[test]
fn bad_numbers_hit_nothing_that_counts() {
    survives::<Projected>();
    survives::<MollerTrumbore<false>>();
    survives::<MollerTrumbore<true>>();
    survives::<BaldwinWeber>();
    survives::<Plucker>();
    survives::<Watertight>();
}

/// Rays from inside a closed mesh that leave it unnoticed, of those at its edges and of those at its corners.
fn leaks<T: InCallersUnits>(name: &str) -> [u64; 2] {
    let mesh = meshes::bumpy_sphere(2, 87);
    let every = Traced::<Every, T>::as_published(&mesh, &()).expect("a mesh that builds");
    let leaks = [Target::Edge, Target::Vertex].map(|target| {
        let is_lost = |index: &u64| {
            let mut random = Random::new(88, *index);
            let origin = random.vector().map(|c| 0.2 * c);
            every.closest_hit(&towards(origin, point_on(&mesh, target, &mut random))).is_none()
        };
        (0..scaled(10_000)).filter(is_lost).count() as u64
    });
    println!("{name}: {} rays at edges and {} at corners leak", leaks[0], leaks[1]);
    leaks
}

#[test]
fn which_tests_leak() {
    assert_eq!(leaks::<Watertight>("watertight"), [0, 0]);
    let [edges, corners] = leaks::<Plucker>("Plücker");
    assert!(edges == 0 && corners > 0);
    let [edges, corners] = leaks::<MollerTrumbore<false>>("Möller-Trumbore");
    assert!(edges > 100 && corners > 100);
    let [tolerant_edges, tolerant_corners] = leaks::<MollerTrumbore<true>>("Möller-Trumbore with tolerance");
    assert!(10 * tolerant_edges < edges && 10 * tolerant_corners < corners);
    for [edges, corners] in [leaks::<BaldwinWeber>("Baldwin-Weber"), leaks::<Projected>("projected")] {
        assert!(edges > 100 && corners > 100);
    }
}
