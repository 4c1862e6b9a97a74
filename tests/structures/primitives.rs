//! Spheres and planes, against f64: where the formulas of textbooks fail, and those with less rounding do not.

use glam::{DVec3, Vec3};
use leafwalk::structures::primitives::{plane, sphere};
use leafwalk_testing::random::Random;
use leafwalk_testing::tally::scaled;

type Sphere = fn(Vec3, Vec3, Vec3, f32) -> Option<[f32; 2]>;

/// What a formula gets wrong, over all lines of a kind.
#[derive(Debug, Default)]
struct Faults {
    lines: u32,
    /// Hits that are missed, and misses that are hit.
    wrong: u32,
    /// How far the nearer end of the chord is off at most, in radii.
    off: f64,
}

/// The chord's ends, in f64: the smaller one from the product of the two, as a difference would cancel there as well.
fn truth(origin: Vec3, direction: Vec3, centre: Vec3, radius: f32) -> Option<[f64; 2]> {
    let [o, d, c] = [origin, direction, centre].map(|v| v.as_dvec3());
    let (from_centre, a, squared_radius) = (o - c, d.length_squared(), f64::from(radius).powi(2));
    let b = -from_centre.dot(d);
    let to_line: DVec3 = from_centre + (b / a) * d;
    let q = b + (a * (squared_radius - to_line.length_squared())).sqrt().copysign(b);
    let (first, second) = ((from_centre.length_squared() - squared_radius) / q, q / a);
    (!q.is_nan()).then_some([first.min(second), first.max(second)])
}

/// A unit vector.
fn unit(random: &mut Random) -> Vec3 {
    Vec3::from(random.direction()).normalize()
}

/// Lines that start at `distance` radii from the centre of a sphere and pass it at `passing` radii.
fn passing(formula: Sphere, distance: f32, passing: impl Fn(&mut Random) -> f32) -> Faults {
    let mut faults = Faults::default();
    for index in 0..scaled(20_000) {
        let mut random = Random::new(91, index);
        let radius = 0.5 + random.unit();
        let centre = Vec3::from(random.vector());
        let away = unit(&mut random);
        let aside = away.cross(unit(&mut random)).normalize();
        let origin = centre + distance * radius * away;
        let direction = centre + passing(&mut random) * radius * aside - origin;
        let expected = truth(origin, direction, centre, radius);
        let found = formula(origin, direction, centre, radius);
        faults.lines += 1;
        faults.wrong += u32::from(expected.is_some() != found.is_some());
        if let (Some([expected, _]), Some([found, _])) = (expected, found) {
            let off = (f64::from(found) - expected).abs() * f64::from(direction.length() / radius);
            faults.off = faults.off.max(off);
        }
    }
    println!("distance {distance:e}: {faults:?}");
    faults
}

#[test]
fn spheres_far_away() {
    // Straight on, so that rounding of the chord itself is small.
    let aimed = |random: &mut Random| 0.9 * random.unit();
    let far = passing(sphere::naive, 1e5, aimed);
    assert!(far.wrong > far.lines / 10 && far.off > 1.0);
    for distance in [10.0, 1e3, 1e5] {
        let found = passing(sphere::stable, distance, aimed);
        // A few roundoffs of the distance.
        assert!(found.wrong == 0 && found.off < 4.0 * f64::from(distance * f32::EPSILON), "{found:?}");
    }
}

#[test]
fn lines_that_graze() {
    // A thousandth of the radius inside, or outside.
    let grazing = |random: &mut Random| if random.below(2) == 0 { 0.999 } else { 1.001 };
    let naive = passing(sphere::naive, 1e3, grazing);
    assert!(naive.wrong > naive.lines / 20);
    assert_eq!(passing(sphere::stable, 1e3, grazing).wrong, 0);
}

/// Where lines come from on or just above the surface, the share by which the distance to it is off at most.
fn starting(formula: Sphere, height: f32) -> f64 {
    let mut off = 0f64;
    for index in 0..scaled(20_000) {
        let mut random = Random::new(92, index);
        let radius = 0.5 + random.unit();
        let centre = Vec3::from(random.vector());
        let up = unit(&mut random);
        // Steeply enough to hit.
        let direction = unit(&mut random) - 2.0 * up;
        let origin = centre + radius * (1.0 + height) * up;
        let expected = truth(origin, direction, centre, radius).expect("a line into the sphere");
        let found = formula(origin, direction, centre, radius).expect("a line into the sphere");
        // The end that is near the start, on whichever side of it.
        let nearer = usize::from(expected[0].abs() > expected[1].abs());
        off = off.max((f64::from(found[nearer]) / expected[nearer] - 1.0).abs());
    }
    println!("height {height:e}: off by {off:e} of the distance");
    off
}

#[test]
fn lines_that_start_on_a_sphere() {
    assert!(starting(sphere::naive, 0.0) > 1.0);
    assert!(starting(sphere::naive, 1e-5) > 1e-3);
    for height in [0.0, 1e-6, 1e-5, 1e-4] {
        assert!(starting(sphere::stable, height) < 8.0 * f64::from(f32::EPSILON));
    }
}

#[test]
fn lines_along_nothing() {
    for formula in [sphere::naive as Sphere, sphere::stable] {
        assert_eq!(formula(Vec3::NAN, Vec3::X, Vec3::ZERO, 2.0), None);
    }
    assert_eq!(sphere::stable(Vec3::X, Vec3::ZERO, Vec3::ZERO, 2.0), None);
    // It touches where it starts.
    assert_eq!(sphere::stable(Vec3::X, Vec3::Y, Vec3::ZERO, 1.0), Some([0.0; 2]));
}

#[test]
fn planes_far_from_0() {
    let mut off = [0f64; 2];
    for index in 0..scaled(20_000) {
        let mut random = Random::new(93, index);
        let normal = unit(&mut random);
        let point = 1e5 * Vec3::from(random.vector());
        let origin = point + Vec3::from(random.vector());
        let direction = unit(&mut random) + 2.0 * normal;
        let [o, d, n, a] = [origin, direction, normal, point].map(|v| v.as_dvec3());
        let expected = n.dot(a - o) / n.dot(d);
        let naive = plane::naive(origin, direction, normal, -normal.dot(point)).expect("not along the plane");
        let stable = plane::stable(origin, direction, normal, point).expect("not along the plane");
        for (off, found) in off.iter_mut().zip([naive, stable]) {
            *off = off.max((f64::from(found) - expected).abs());
        }
    }
    println!("off by {off:?}");
    // A roundoff of the distance from 0, and of the distance from the plane.
    assert!(off[0] > 1e-3 && off[1] < 2.0 * f64::from(f32::EPSILON));
}

#[test]
fn lines_along_planes() {
    assert_eq!(plane::naive(Vec3::Z, Vec3::X, Vec3::Z, 0.0), None);
    assert_eq!(plane::stable(Vec3::Z, Vec3::X, Vec3::Z, Vec3::ZERO), None);
    // In the plane: 0 / 0.
    assert_eq!(plane::naive(Vec3::X, Vec3::X, Vec3::Z, 0.0), None);
    assert_eq!(plane::stable(Vec3::X, Vec3::X, Vec3::Z, Vec3::ZERO), None);
}
