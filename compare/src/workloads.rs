//! The four kinds of rays that benches measure with: primary rays (P), shadow rays (S), diffuse bounces (D) and random
//! chords (R).

use glam::Vec3;
use leafwalk_core::{Aabb, Frame, Hit, Octree, Ray, Tracer};
use leafwalk_cpu::{CpuTracer, Mesh};

use super::random::Random;
use super::rays;

/// A batch of rays of one kind.
pub struct Workload {
    /// `P`, `S`, `D` or `R`.
    pub name: &'static str,
    /// The rays, in the order in which they are traced.
    pub rays: Vec<Ray>,
    /// Whether only the existence of a hit is asked for.
    pub is_occlusion: bool,
}

/// The rays of all four kinds for a scene: `side` squared primary rays, as many chords, and a shadow ray and a bounce for
/// each primary ray that hits. `inside` says that the scene is seen from inside, as a room is.
pub fn all<W: AsRef<[u32]>>(octree: &Octree<W>, mesh: &Mesh, inside: bool, side: u32) -> Vec<Workload> {
    let bounds = octree.bounds();
    let primary = if inside { panorama(&bounds, side) } else { rays::primary(&bounds, side) };
    let mut hits = vec![Hit::MISS; primary.len()];
    CpuTracer::new(octree.view()).closest_hits(&primary, &mut hits).expect("equal lengths");
    let frame = octree.frame();
    let surface = |i: usize| Some(lifted(mesh, &frame, &primary[i], &hits[i].ok()?));
    // Inside under the ceiling; outside above the scene and beside the camera, so that it lights what the camera sees.
    let light = point(&bounds, if inside { [0.5, 0.95, 0.5] } else { [1.5, 1.6, 0.8] });
    let towards_light = |(p, _): (Vec3, Vec3)| Ray::between(p, Vec3::from(light) - p, 0.0, 1.0);
    let shadow = (0..primary.len()).filter_map(surface).map(towards_light).collect();
    let bounce = (0..primary.len())
        .filter_map(|i| surface(i).map(|(p, n)| Ray::new(p, cosine(n, &mut Random::new(11, i as u64)))))
        .collect();
    let random = (0..primary.len()).map(|i| chord(&bounds, &mut Random::new(12, i as u64))).collect();
    vec![
        Workload { name: "P", rays: primary, is_occlusion: false },
        Workload { name: "S", rays: shadow, is_occlusion: true },
        Workload { name: "D", rays: bounce, is_occlusion: false },
        Workload { name: "R", rays: random, is_occlusion: false },
    ]
}

/// Reads the `side` of [`all`] from an argument.
///
/// # Errors
/// When it is no multiple of 8, or so large that nobody means it.
pub fn side(text: &str) -> Result<u32, String> {
    let is_right = |side: &u32| (8..=8192).contains(side) && side.is_multiple_of(8);
    text.parse().ok().filter(is_right).ok_or_else(|| "give a multiple of 8 from 8 to 8192".into())
}

fn point(bounds: &Aabb, at: [f64; 3]) -> [f32; 3] {
    core::array::from_fn(|k| (bounds.lower[k] + at[k] * (bounds.upper[k] - bounds.lower[k])) as f32)
}

/// Rays in all directions from a point inside, row by row in 8 x 8 tiles.
fn panorama(bounds: &Aabb, side: u32) -> Vec<Ray> {
    let eye = point(bounds, [0.45, 0.5, 0.55]);
    let tiles = side / 8;
    let at = |i: u32| {
        let (tile, within) = (i / 64, i % 64);
        let (x, y) = (tile % tiles * 8 + within % 8, tile / tiles * 8 + within / 8);
        let (x, y) = (x as f32 / side as f32 - 0.5, y as f32 / side as f32 - 0.5);
        Ray::new(eye, [x * 1.6, y * 1.2, -1.0])
    };
    (0..side * side).map(at).collect()
}

/// The hit point, lifted off the surface towards the ray's origin, and the normal on that side.
fn lifted(mesh: &Mesh, frame: &Frame, ray: &Ray, hit: &Hit) -> (Vec3, Vec3) {
    let normal = Vec3::from(mesh.normal(hit.primitive as usize));
    let normal = if mesh.front(hit, ray.direction) { normal } else { -normal };
    let back = ray.direction.map(|c| -c);
    let spawned = hit.spawn(frame, &mesh.corners(hit.primitive as usize), back);
    (spawned.origin.into(), normal)
}

fn cosine(n: Vec3, random: &mut Random) -> Vec3 {
    loop {
        let v = Vec3::from(random.vector());
        let squared = v.length_squared();
        if squared > 1e-4 && squared <= 1.0 {
            return n + 0.999 / squared.sqrt() * v;
        }
    }
}

/// A chord of the bounding sphere.
fn chord(bounds: &Aabb, random: &mut Random) -> Ray {
    let centre = point(bounds, [0.5; 3]);
    let radius = 0.5 * (0..3).map(|k| (bounds.upper[k] - bounds.lower[k]).powi(2)).sum::<f64>().sqrt() as f32;
    let mut on_sphere = || {
        let v = Vec3::from(random.direction());
        Vec3::from(centre) + radius / v.length() * v
    };
    let (a, b) = (on_sphere(), on_sphere());
    Ray::new(a, b - a)
}
