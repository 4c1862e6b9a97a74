//! Hits against f64 on the caller's own mesh: what we report lies on the triangle that we name, and no hit that is
//! clear of every doubt is lost. Where the two disagree otherwise is counted.

use core::sync::atomic::{AtomicU64, Ordering::Relaxed};

use glam::DVec3;
use leafwalk::{Frame, Hit, Mesh, Ray};
use leafwalk_core::contract::ROUNDOFF;
use leafwalk_testing::differences::{Source, hard};
use leafwalk_testing::random::Random;
use leafwalk_testing::tally::{Tally, scaled, tally};
use leafwalk_testing::tracers::Any;
use leafwalk_testing::{meshes, rays};

use crate::geometry::{corners, point};
use crate::scenes::{self, Scene};

/// How far the point `origin + t * direction` and the barycentric point of a hit may lie from each other, in roundoffs
/// of the root's edge, on top of the rounding of the reported t.
///
/// Along an axis, for an origin up to one root edge away: 10 lateral (e2) and 19 in depth (ez) of the triangle test, 10
/// for the rounded weights across an edge of the triangle, 1.5 for the origin: vertices are exact.
/// Three axes at right angles make sqrt(3) times that.
pub(crate) const POINT_ERROR: f64 = 1.733 * 40.5;

/// What f64 says about a ray.
struct Truth {
    /// The closest triangle hit.
    closest: Option<(f64, u32)>,
    /// No closest hit lies beyond this: of the triangles that the ray passes through at more than the point error from
    /// their edges and from its limits, the nearest that one may be.
    clear: Option<f64>,
}

/// Tests every triangle; distances count from the ray's origin, in the caller's units of length.
fn truth(triangles: &[[DVec3; 3]], ray: &Ray, error: f64) -> Truth {
    let (origin, along) = (point(ray.origin), point(ray.direction));
    let (length, along) = (along.length(), along.normalize());
    let (from, to) = (f64::from(ray.t_min) * length, f64::from(ray.t_max) * length);
    // Limits are rounded to f32 once more in canonical units.
    let doubt = |limit: f64| if limit.is_finite() { f64::from(ROUNDOFF) * limit.abs() } else { 0.0 };
    let (clear_from, clear_to) = (from + doubt(from), to - doubt(to));
    let mut truth = Truth { closest: None, clear: None };
    for (primitive, triangle) in (0..).zip(triangles) {
        let [a, b, c] = triangle.map(|corner| corner - origin);
        // Edges as seen along the ray, which is at the left of all or at the right of all.
        let sides = [(b, c), (c, a), (a, b)].map(|(p, q)| along.dot(p.cross(q)));
        let total: f64 = sides.iter().sum();
        if total == 0.0 || sides.iter().any(|side| side * total < 0.0) {
            continue;
        }
        let distance = (sides[0] * a + sides[1] * b + sides[2] * c).dot(along) / total;
        let seen = |p: DVec3, q: DVec3| (q - p).reject_from_normalized(along).length();
        let is_clear =
            [seen(b, c), seen(c, a), seen(a, b)].iter().zip(sides).all(|(edge, side)| side.abs() > error * edge);
        if from < distance && distance < to && truth.closest.is_none_or(|(closest, _)| distance < closest) {
            truth.closest = Some((distance, primitive));
        }
        // A lateral error moves the hit along the ray by its cotangent with the triangle.
        let slack = error * (1.0 + 1.0 / (b - a).cross(c - a).normalize().dot(along).abs());
        if is_clear && clear_from < distance - slack && distance + slack < clear_to {
            truth.clear = Some(truth.clear.map_or(distance + slack, |clear| clear.min(distance + slack)));
        }
    }
    truth
}

/// What is only counted.
#[derive(Default)]
pub(crate) struct Report {
    /// One says hit, the other miss.
    hit_or_miss: AtomicU64,
    /// Another triangle.
    primitive: AtomicU64,
    /// The largest distance of the two reported points beyond the rounding of t, in hundredths of a roundoff of the
    /// root's edge.
    error: AtomicU64,
}

/// Rays whose hit lies off its triangle, or that lose a clear hit.
pub(crate) fn faults(
    tracer: Any<'_>,
    frame: &Frame,
    mesh: &Mesh,
    source: Source<'_>,
    count: u64,
    seed: u64,
) -> (Tally, Report) {
    let triangles: Vec<_> = (0..mesh.triangles.len()).map(|i| corners(mesh, i)).collect();
    let report = Report::default();
    let roundoff = f64::from(ROUNDOFF);
    let error = POINT_ERROR * roundoff * frame.scale();
    let tally = tally(count, |indices, tally| {
        let rays: Vec<Ray> = indices.clone().map(|index| source(&mut Random::new(seed, index))).collect();
        let mut hits = vec![Hit::MISS; rays.len()];
        tracer.closest_hits(&rays, &mut hits).expect("equal lengths");
        for ((index, ray), hit) in indices.zip(&rays).zip(&hits) {
            tally.hit(!hit.is_miss());
            let truth = truth(&triangles, ray, error);
            let travelled = f64::from(hit.t) * point(ray.direction);
            let distance = f64::from(hit.t) * point(ray.direction).length();
            let mut fault = |what: &str| {
                let ray = rays::hex(ray);
                tally.fault(index, || {
                    format!("seed {seed}, ray {index}: {what}: {hit:?}, clear {:?}\n{ray}", truth.clear)
                });
            };
            if truth.clear.is_some_and(|clear| hit.is_miss() || distance > clear + roundoff * distance.abs()) {
                fault("a clear hit is lost");
            }
            if hit.is_miss() != truth.closest.is_none() {
                report.hit_or_miss.fetch_add(1, Relaxed);
            } else if truth.closest.is_some_and(|(_, primitive)| primitive != hit.primitive) {
                report.primitive.fetch_add(1, Relaxed);
            }
            if hit.is_miss() {
                continue;
            }
            let [a, b, c] = triangles[hit.primitive as usize];
            let (u, v) = (f64::from(hit.u), f64::from(hit.v));
            if u < 0.0 || v < 0.0 || u + v > 1.0 {
                fault("weights of a point outside");
            }
            // A t beyond all f32 names no point.
            if hit.t.abs() == f32::MAX {
                continue;
            }
            let apart = (point(ray.origin) + travelled).distance(a + u * (b - a) + v * (c - a));
            let beyond = (apart - roundoff * distance.abs()) / (roundoff * frame.scale());
            report.error.fetch_max((100.0 * beyond) as u64, Relaxed);
            if beyond > POINT_ERROR {
                fault(&format!(
                    "the hit lies {beyond} roundoffs of the root off its triangle, beside the rounding of t"
                ));
            }
        }
    });
    (tally, report)
}

fn check(name: &str, mesh: &Mesh, scene: &Scene, count: u64, seed: u64) {
    let frame = scene.octree.parts().frame;
    let (centre, size) = rays::extent(mesh);
    let report = |kind: &str, source: Source<'_>, least_hits: f64| {
        let (tally, report) = faults(&scene.octree, &frame, mesh, source, scaled(count), seed);
        let (hit_or_miss, primitive) = (report.hit_or_miss.load(Relaxed), report.primitive.load(Relaxed));
        let error = report.error.load(Relaxed) as f64 / 100.0;
        let name = format!("f64, {name}, {kind} rays");
        println!(
            "{name}: wrong hits: {hit_or_miss} hit in one only, {primitive} another triangle; points at most {error} \
             roundoffs of the root apart, {POINT_ERROR:.1} allowed"
        );
        tally.passes(&name, least_hits);
    };
    report("hard", &hard(mesh), 0.05);
    let across = |random: &mut Random| {
        let [from, to] = [0, 1].map(|_| random.vector().map(|c| size * c));
        rays::towards(core::array::from_fn(|k| centre[k] + from[k]), core::array::from_fn(|k| centre[k] + to[k]))
    };
    report("ordinary", &across, 0.01);
}

#[test]
fn hits_lie_on_their_triangles_and_clear_hits_are_found() {
    let scenes = [
        ("icosphere", meshes::icosphere(3)),
        ("bumpy sphere", meshes::bumpy_sphere(3, 41)),
        ("needle box", meshes::needle_box(30)),
        ("soup", meshes::soup(1000, 42)),
        ("needles", meshes::shards(1000, 1e-3..4.0, 1e6, 43)),
        ("soup x 1000", meshes::placed(&meshes::soup(1000, 44), 1e3, 0.0)),
        ("soup + 10000", meshes::placed(&meshes::soup(1000, 45), 1.0, 1e4)),
    ];
    for (seed, (name, mesh)) in (40..).zip(&scenes) {
        check(name, mesh, &Scene::new(mesh), 10_000, seed);
    }
}

#[test]
fn hits_lie_on_the_dragon() {
    if let Some((mesh, scene)) = scenes::dragon("f64 on the dragon") {
        check("dragon", mesh, scene, 100, 49);
    }
}

/// A wall seen from ever further away, in numbers that need no rounding.
#[test]
fn moving_an_origin_to_the_root_loses_nothing() {
    let wall = |x: f32| [[x, 0.0, 0.0], [x, 1.0, 0.0], [x, 0.0, 1.0]];
    // A frame of 0..4 on every axis.
    let positions = [wall(0.5), wall(3.5)].concat();
    let mesh = Mesh::new(positions, vec![[0, 1, 2], [3, 4, 5]]);
    let scene = Scene::new(&mesh);
    for exponent in -3..=12 {
        let distance = 2f32.powi(exponent);
        let ray = Ray::new([0.5 - distance, 0.25, 0.25], [1.0, 0.0, 0.0]);
        let hit = scene.octree.closest_hit(&ray).expect("a hit");
        assert_eq!(hit, Hit { t: distance, u: 0.25, v: 0.25, primitive: 0 }, "from {distance} away");
    }
}
