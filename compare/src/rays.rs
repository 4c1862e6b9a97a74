//! Rays: random ones, and those aimed where methods fail.

use glam::Vec3;
use leafwalk_core::{Aabb, Octree, Ray};
use leafwalk_cpu::Mesh;

use super::random::Random;

/// Centre and largest extent of a mesh.
pub fn extent(mesh: &Mesh) -> ([f32; 3], f32) {
    let used = mesh.triangles.iter().flatten().map(|i| mesh.positions[*i as usize]);
    let (lower, upper) = used.fold(([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]), |(a, b), p| {
        (core::array::from_fn(|k| a[k].min(p[k])), core::array::from_fn(|k| b[k].max(p[k])))
    });
    let centre = core::array::from_fn(|k| 0.5 * (lower[k] + upper[k]));
    (centre, (0..3).map(|k| upper[k] - lower[k]).fold(0.0, f32::max))
}

/// Where on a triangle a ray is aimed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// At one of its vertices.
    Vertex,
    /// At a point of one of its edges.
    Edge,
    /// At a point of its inside.
    Inside,
}

/// A point on a random triangle of a mesh.
pub fn point_on(mesh: &Mesh, target: Target, random: &mut Random) -> [f32; 3] {
    let [a, b, c] = mesh.corners(random.below(mesh.triangles.len()));
    let mix = |a: [f32; 3], b: [f32; 3], w: f32| core::array::from_fn(|k| a[k] + w * (b[k] - a[k]));
    match target {
        Target::Vertex => a,
        Target::Edge => mix(a, b, random.unit()),
        Target::Inside => mix(mix(a, b, random.unit()), c, random.unit()),
    }
}

/// A ray from `origin` through `point`.
pub fn towards(origin: [f32; 3], point: [f32; 3]) -> Ray {
    Ray::new(origin, Vec3::from(point) - Vec3::from(origin))
}

/// A hard ray of a mesh: every kind of origin, aim and limit that a method could fail at. Never of direction zero.
pub fn hard(mesh: &Mesh, centre: [f32; 3], size: f32, random: &mut Random) -> Ray {
    let place = |random: &mut Random, reach: f32| -> [f32; 3] {
        let v = random.vector();
        core::array::from_fn(|k| centre[k] + reach * size * v[k])
    };
    let mut origin = match random.below(8) {
        0 | 1 => place(random, 0.5),
        2 => place(random, 1.0),
        3 => place(random, 3.0),
        4 => place(random, 1000.0),
        5 => point_on(mesh, Target::Vertex, random),
        6 => point_on(mesh, Target::Inside, random),
        // On planes of the lattice, as far as the frame's own offset allows.
        _ => place(random, 0.5).map(|c| (c / size * 64.0).round() / 64.0 * size),
    };
    let target = [Target::Vertex, Target::Edge, Target::Inside][random.below(3)];
    let mut direction = match random.below(10) {
        0 => random.direction(),
        // Along an axis, or in an axis plane.
        1 => {
            let mut d = random.direction();
            d[random.below(3)] = if random.below(2) == 0 { 0.0 } else { -0.0 };
            d
        }
        2 => {
            let k = random.below(3);
            let sign = random.signed();
            core::array::from_fn(|i| if i == k { sign } else { 0.0 })
        }
        // A diagonal.
        3 => core::array::from_fn(|_| if random.below(2) == 0 { 1.0 } else { -1.0 }),
        // In the plane of a triangle.
        4 => {
            let [a, b, c] = mesh.corners(random.below(mesh.triangles.len()));
            origin = core::array::from_fn(|k| a[k] + 2.0 * (a[k] - c[k]));
            let w = random.unit();
            core::array::from_fn(|k| b[k] + w * (c[k] - b[k]) - origin[k])
        }
        _ => (Vec3::from(point_on(mesh, target, random)) - Vec3::from(origin)).to_array(),
    };
    if random.below(3) == 0 {
        direction = direction.map(|c| random.nudge(c));
    }
    if random.below(8) == 0 {
        direction[random.below(3)] *= 2f32.powi(-(random.below(67) as i32));
    }
    let scale = 2f32.powi(random.below(40) as i32 - 20);
    direction = direction.map(|c| c * scale);
    if direction == [0.0; 3] {
        direction = [scale, 0.0, 0.0];
    }
    let t_min = [0.0, 0.0, -1e3, 0.5][random.below(4)] / scale;
    let t_max = [f32::INFINITY, f32::INFINITY, 1.0, 1e3][random.below(4)] / scale;
    Ray::between(origin, direction, t_min, t_max)
}

/// Rays a run of [`coherent`] ones.
pub const RUN: u64 = 64;

/// What the rays of a run share beside their direction, which is about the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shared {
    /// Where they start, as the rays of a camera do.
    Origin,
    /// Where they end, as shadow rays do.
    End,
    /// Rays that share nothing else.
    Nothing,
    /// Where they go, for all rays, and where they start, for each eight in a row.
    Eights,
}

impl Shared {
    /// All kinds of runs.
    pub const ALL: [Self; 4] = [Self::Origin, Self::End, Self::Nothing, Self::Eights];
}

/// A ray of a run of much the same direction, aimed where neighbouring triangles meet.
pub fn coherent(shares: Shared, mesh: &Mesh, centre: [f32; 3], size: f32, random: &mut Random) -> Ray {
    let mut run = random.of_run(RUN);
    let reach = [0.5, 0.5, 1.0, 1.4][run.below(4)] * size;
    let mut shared = Vec3::from(centre) + reach * Vec3::from(run.vector());
    let first = run.below(mesh.triangles.len());
    if run.below(8) == 0 {
        shared = mesh.corners(run.below(mesh.triangles.len()))[0].into();
    }
    let spread = 0.02 * size * run.unit();
    let corners = mesh.corners((first + random.below(6)) % mesh.triangles.len()).map(Vec3::from);
    let (from, to) = (corners[random.below(3)], corners[random.below(3)]);
    let w = if random.below(2) == 0 { 0.0 } else { random.unit() };
    let target = from + w * (to - from);
    let (origin, direction, t_max) = match shares {
        Shared::Origin => (shared, target - shared, f32::INFINITY),
        // Through the target, from close behind it.
        Shared::End => {
            let origin = target + 0.1 * (target - shared);
            (origin, shared - origin, 1.0)
        }
        Shared::Nothing => {
            let origin = shared + spread * Vec3::from(random.vector());
            (origin, target - origin, f32::INFINITY)
        }
        Shared::Eights => {
            let [apart, aim] = [random.of_run(8).vector(), mesh.corners(first)[run.below(3)]].map(Vec3::from);
            let origin = shared + 0.03 * size * apart;
            (origin, aim - if random.below(4) == 0 { shared } else { origin }, f32::INFINITY)
        }
    };
    let mut direction = direction.to_array();
    if random.below(2) == 0 {
        direction = direction.map(|c| random.nudge(c));
    }
    if direction == [0.0; 3] {
        direction = [size, 0.0, 0.0];
    }
    let scale = 2f32.powi(random.below(8) as i32 - 4);
    let t_min = [0.0, 0.0, -0.5][random.below(3)];
    Ray::between(origin, direction.map(|c| c * scale), t_min, t_max / scale)
}

/// The hard rays of a mesh under `seed`, one for each index below `count`; a third of those that hit are cut next to their
/// hit.
pub fn hard_and_cut<W: AsRef<[u32]>>(octree: &Octree<W>, mesh: &Mesh, count: u64, seed: u64) -> Vec<Ray> {
    let (centre, size) = extent(mesh);
    let ray = |index| {
        let mut random = Random::new(seed, index);
        let ray = hard(mesh, centre, size, &mut random);
        match octree.closest_hit(&ray) {
            Some(hit) if random.below(3) == 0 => cut(&ray, hit.t, &mut random),
            _ => ray,
        }
    };
    (0..count).map(ray).collect()
}

/// A ray cut just before or behind one of its own hits, to test the limits to the last bit.
pub fn cut(ray: &Ray, t: f32, random: &mut Random) -> Ray {
    let near = f32::from_bits(t.to_bits().wrapping_add(random.below(5) as u32).wrapping_sub(2));
    let at = if near.is_finite() { near } else { t };
    if random.below(2) == 0 { Ray { t_min: at, ..*ray } } else { Ray { t_max: at, ..*ray } }
}

/// Parallel rows of camera rays on a box, seen from outside.
pub fn primary(bounds: &Aabb, side: u32) -> Vec<Ray> {
    let centre: [f64; 3] = core::array::from_fn(|k| 0.5 * (bounds.lower[k] + bounds.upper[k]));
    let size = (0..3).map(|k| bounds.upper[k] - bounds.lower[k]).fold(0.0, f64::max);
    let eye = [centre[0] + 0.3 * size, centre[1] + 0.2 * size, centre[2] + 1.5 * size];
    let tiles = side / 8;
    (0..side * side)
        .map(|i| {
            // 8 x 8 tiles, as renderers trace them.
            let (tile, within) = (i / 64, i % 64);
            let (x, y) = (tile % tiles * 8 + within % 8, tile / tiles * 8 + within / 8);
            let at = |i: u32| (f64::from(i) + 0.5) / f64::from(side) - 0.5;
            let target = [centre[0] + size * at(x), centre[1] + size * at(y), centre[2]];
            let direction = core::array::from_fn(|k| (target[k] - eye[k]) as f32);
            Ray::new(eye.map(|c| c as f32), direction)
        })
        .collect()
}

/// Prints a ray so that it can be typed back in: hex bits and decimals.
pub fn hex(ray: &Ray) -> String {
    let words: Vec<String> =
        bytemuck::cast_slice::<Ray, u32>(&[*ray]).iter().map(|word| format!("{word:#010x}")).collect();
    format!("{ray:?} = [{}]", words.join(", "))
}
