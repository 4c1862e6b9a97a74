//! P7: a ray that leaves a hit, by either side of its triangle, does not hit that triangle again.

use core::sync::atomic::{AtomicU64, Ordering::Relaxed};

use glam::{DVec3, Vec3};
use leafwalk::{CpuTracer, Frame, Hit, Mesh, Octree, Ray, Tracer};
use leafwalk_core::contract::ROUNDOFF;
use leafwalk_core::triangle::{Shear, intersect};
use leafwalk_testing::differences::hard;
use leafwalk_testing::random::Random;
use leafwalk_testing::tally::{Tally, scaled, tally};
use leafwalk_testing::{meshes, rays};

use crate::geometry::{corners, point};
use crate::scenes::{self, Scene};

/// How rays leave a hit: [`Hit::spawn`], or a mutant of it.
pub(crate) type Spawn = fn(&Hit, &Frame, &[[f32; 3]; 3], [f32; 3]) -> Ray;

/// Directions in which rays leave each hit; each is turned around as well.
const DIRECTIONS: usize = 4;
/// A neighbour counts as coplanar if no corner of it is further off the triangle's plane, in root edges.
const COPLANAR: f64 = 4.0 * ROUNDOFF as f64;

/// What is only counted.
#[derive(Default)]
pub(crate) struct Report {
    /// Rays that left a hit.
    spawned: AtomicU64,
    /// Those that hit a triangle in the plane that they left, or next to it.
    coplanar: AtomicU64,
    /// How far the origins are off their triangles, in hundredths of a roundoff of the root's edge, in all and at most.
    offsets: AtomicU64,
    largest: AtomicU64,
}

/// A direction in which rays leave a triangle: any, along it, at one of its corners from a point of it, and hardly off it.
fn direction(corners: &[DVec3; 3], from: DVec3, kind: usize, random: &mut Random) -> [f32; 3] {
    let [a, b, c] = *corners;
    let (x, y) = (f64::from(random.signed()), f64::from(random.signed()));
    let along = (b - a) * x + (c - a) * y;
    let exact = match kind {
        0 => return random.direction(),
        1 => along,
        2 => corners[random.below(3)] - from,
        _ => along + (b - a).cross(c - a).normalize_or_zero() * along.length() * 2f64.powf(-40.0 * x.abs()),
    };
    // Directions of any length count; those of the smallest scenes would not survive as f32.
    let exact = if exact == DVec3::ZERO { exact } else { exact / exact.abs().max_element() };
    exact.as_vec3().to_array().map(|c| if random.below(2) == 0 { random.nudge(c) } else { c })
}

/// Whether a ray hits a triangle, whatever else it hits before.
fn hits(frame: &Frame, corners: &[[f32; 3]; 3], ray: &Ray) -> bool {
    frame.canonical(ray).is_some_and(|ray| {
        let (shear, axes) = Shear::<f32>::new(&ray);
        let lattice = corners.map(|corner| frame.to_lattice(corner.map(f64::from)));
        let found = intersect(&shear, &lattice.map(|corner| axes.map(|axis| corner[axis])));
        found.is_some_and(|found| ray.t_min < found.t && found.t < ray.t_max)
    })
}

/// The rays that leave the hits of hard rays, and hit the triangle that they left.
pub(crate) fn faults(octree: &Octree<Vec<u32>>, mesh: &Mesh, spawn: Spawn, count: u64, seed: u64) -> (Tally, Report) {
    let (frame, tracer, source) = (octree.frame(), CpuTracer::new(octree.view()), hard(mesh));
    let report = Report::default();
    let unit = f64::from(ROUNDOFF) * frame.scale();
    let tally = tally(count, |indices, tally| {
        let mut randoms: Vec<Random> = indices.clone().map(|index| Random::new(seed, index)).collect();
        let rays: Vec<Ray> = randoms.iter_mut().map(&source).collect();
        let mut found = vec![Hit::MISS; rays.len()];
        tracer.closest_hits(&rays, &mut found).expect("equal lengths");
        let (mut spawned, mut left) = (Vec::new(), Vec::new());
        for ((index, hit), random) in indices.zip(&found).zip(&mut randoms) {
            tally.hit(!hit.is_miss());
            let Some(hit) = hit.ok() else { continue };
            let (triangle, exact) = (mesh.corners(hit.primitive as usize), corners(mesh, hit.primitive as usize));
            let from = DVec3::from(hit.position(&triangle));
            for kind in 0..DIRECTIONS {
                let direction = Vec3::from(direction(&exact, from, kind, random));
                for direction in [direction, -direction].map(|direction| direction.to_array()) {
                    let ray = spawn(&hit, &frame, &triangle, direction);
                    if ray.is_valid() {
                        let offset = (100.0 * point(ray.origin).distance(from) / unit) as u64;
                        report.offsets.fetch_add(offset, Relaxed);
                        report.largest.fetch_max(offset, Relaxed);
                        spawned.push(ray);
                        left.push((index, hit));
                    }
                }
            }
        }
        report.spawned.fetch_add(spawned.len() as u64, Relaxed);
        let mut next = vec![Hit::MISS; spawned.len()];
        tracer.closest_hits(&spawned, &mut next).expect("equal lengths");
        for ((ray, next), (index, hit)) in spawned.iter().zip(&next).zip(&left) {
            let triangle = mesh.corners(hit.primitive as usize);
            if next.primitive == hit.primitive || hits(&frame, &triangle, ray) {
                tally.fault(*index, || format!("seed {seed}, ray {index}: {hit:?} left by\n{}", rays::hex(ray)));
            } else if !next.is_miss() && is_coplanar(mesh, hit, next, COPLANAR * frame.scale()) {
                report.coplanar.fetch_add(1, Relaxed);
            }
        }
    });
    (tally, report)
}

/// Whether the triangle of one hit lies in the plane of another's, to a distance.
fn is_coplanar(mesh: &Mesh, hit: &Hit, other: &Hit, distance: f64) -> bool {
    let [a, b, c] = corners(mesh, hit.primitive as usize);
    let normal = (b - a).cross(c - a).normalize_or_zero();
    corners(mesh, other.primitive as usize).iter().all(|corner| normal.dot(corner - a).abs() <= distance)
}

fn check(name: &str, mesh: &Mesh, octree: &Octree<Vec<u32>>, count: u64, seed: u64) {
    let (tally, report) = faults(octree, mesh, Hit::spawn, scaled(count), seed);
    let (spawned, coplanar) = (report.spawned.into_inner(), report.coplanar.into_inner());
    let mean = report.offsets.into_inner() as f64 / (100 * spawned.max(1)) as f64;
    let largest = report.largest.into_inner() as f64 / 100.0;
    println!(
        "P7, {name}: {spawned} rays left a hit, {coplanar} hit a coplanar neighbour; offsets of {mean:.0} roundoffs of the \
         root's edge, at most {largest:.0}"
    );
    tally.passes(&format!("P7, {name}"), 0.05);
    assert!(spawned >= tally.hits * DIRECTIONS as u64, "{name}: only {spawned} rays left {} hits", tally.hits);
}

#[test]
fn rays_do_not_hit_the_triangle_that_they_leave() {
    let scenes = [
        ("icosphere", meshes::icosphere(3)),
        ("bumpy sphere", meshes::bumpy_sphere(3, 71)),
        ("needle box", meshes::needle_box(30)),
        ("turned needle box", meshes::turned(&meshes::needle_box(30))),
        ("walls", meshes::walls(40, 72)),
        ("soup", meshes::soup(1000, 73)),
        ("needles", meshes::shards(1000, 1e-3..4.0, 1e6, 74)),
        ("soup x 1000", meshes::placed(&meshes::soup(1000, 75), 1e3, 0.0)),
        ("soup + 10000", meshes::placed(&meshes::soup(1000, 76), 1.0, 1e4)),
        ("soup + 1e6", meshes::placed(&meshes::soup(1000, 77), 1.0, 1e6)),
        ("soup of subnormal numbers", meshes::placed(&meshes::soup(1000, 78), 1e-41, 0.0)),
    ];
    for (seed, (name, mesh)) in (70..).zip(&scenes) {
        check(name, mesh, &Scene::new(mesh).octree, 20_000, seed);
    }
}

/// A small triangle in a large scene, and a large one far from where coordinates are 0.
#[test]
fn rays_leave_triangles_of_any_size_anywhere() {
    for (seed, (size, coordinates, root_edge)) in (90..).zip([
        (1.0, 0.0, 1.0),
        (1.0, 0.0, 1e3),
        (1e-3, 0.0, 1e3),
        (1e3, 1e3, 1e3),
        (1e-2, 1e3, 1.0),
        (1.0, 1e5, 10.0),
        (1e3, 1e5, 1e5),
        (1e3, 1e6, 1.0),
    ]) {
        let mut random = Random::new(seed, 0);
        let mut mesh = Mesh::default();
        for primitive in 0..300 {
            let centre = [(); 3].map(|()| coordinates + root_edge * random.signed());
            mesh.positions.extend([(); 3].map(|()| centre.map(|c| c + size * random.signed())));
            mesh.triangles.push([0, 1, 2].map(|corner| 3 * primitive + corner));
        }
        let octree = Scene::new(&mesh).octree;
        check(&format!("triangles of {size} at {coordinates} in {root_edge}"), &mesh, &octree, 10_000, seed);
    }
}

#[test]
fn rays_leave_real_scenes() {
    if let Some((mesh, scene)) = scenes::dragon("P7 on the dragon") {
        check("dragon", mesh, &scene.octree, 5_000, 80);
    }
    if let Some((mesh, scene)) = scenes::conference("P7 in the conference room") {
        check("conference", mesh, &scene.octree, 5_000, 81);
    }
}

/// The faces of a cube around 0, two triangles each.
fn cube(half: f32) -> Mesh {
    let corner = |i: usize| [0, 1, 2].map(|k: usize| if i >> k & 1 == 1 { half } else { -half });
    let positions = (0..8).map(corner).collect();
    let face = |[a, b, c, d]: [u32; 4]| [[a, b, d], [a, d, c]];
    let faces = [[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 4, 5], [2, 3, 6, 7], [0, 2, 4, 6], [1, 3, 5, 7]];
    Mesh::new(positions, faces.into_iter().flat_map(face).collect())
}

/// The offset depends on the triangle alone, not on the scene around it.
#[test]
fn rays_leave_a_small_cube_in_a_sky_box_of_any_size() {
    let small = cube(0.5);
    for (seed, size) in (100..).zip([1e2, 1e4, 1e6, 1e9]) {
        let mut mesh = small.clone();
        let sky = cube(size);
        mesh.triangles.extend(sky.triangles.iter().map(|triangle| triangle.map(|i| i + small.positions.len() as u32)));
        mesh.positions.extend(sky.positions);
        let octree = Scene::new(&mesh).octree;
        let frame = octree.frame();
        let mut count = 0;
        for index in 0..2000 {
            let mut random = Random::new(seed, index);
            let ray = rays::towards(random.vector().map(|c| 5.0 * c), random.vector().map(|c| 0.5 * c));
            let Some(hit) = octree.closest_hit(&ray).filter(|hit| (hit.primitive as usize) < small.triangles.len())
            else {
                continue;
            };
            count += 1;
            let triangle = mesh.corners(hit.primitive as usize);
            let next = hit.spawn(&frame, &triangle, random.direction());
            let offset = point(next.origin).distance(DVec3::from(hit.position(&triangle)));
            assert!(offset < 1e-5, "{offset} in a sky box of {size}: {hit:?}");
            let again = octree.closest_hit(&next).is_some_and(|next| next.primitive == hit.primitive);
            assert!(!again && !hits(&frame, &triangle, &next), "in a sky box of {size}: {next:?}");
        }
        assert!(count > 500, "{count} hits");
    }
}
