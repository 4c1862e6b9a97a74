//! Scenes whose extent is far larger than what is looked at, or far from 0, or of very large or small numbers: where
//! numbers that count from the scene's corner have no digits left.

use glam::Vec3;
use leafwalk_core::Ray;
use leafwalk_cpu::Mesh;

use super::{meshes, rays};
use crate::random::Random;

/// A mesh, and rays at what is looked at.
pub struct Wide {
    /// As tables print it.
    pub name: String,
    /// All of it.
    pub mesh: Mesh,
    aim: Box<dyn Fn(&mut Random) -> Ray + Sync>,
}

impl Wide {
    fn new(name: String, mesh: Mesh, aim: impl Fn(&mut Random) -> Ray + Sync + 'static) -> Self {
        Self { name, mesh, aim: Box::new(aim) }
    }

    /// A ray of numbers that depend on nothing but the seed and the index.
    pub fn ray(&self, random: &mut Random) -> Ray {
        (self.aim)(random)
    }
}

/// All wide scenes.
pub fn all() -> Vec<Wide> {
    let mut scenes = Vec::new();
    for slope in [[0.0, 0.0], [0.31, 0.17]] {
        for size in [2e3, 2e5] {
            scenes.extend([10.0, 1.0, 0.2].map(|degrees| scanned_ground(size, slope, degrees)));
        }
    }
    scenes.extend([[100.0, 101.0], [0.001, 0.0011]].map(low_terrain));
    for size in [1e4, 1e6, 1e7, 1e9] {
        scenes.extend([false, true].map(|is_central| sky_box(size, is_central)));
    }
    scenes.extend([1e-3, 1e-5, 1e-6, 5e-8, 1e-17].map(start_above_square));
    scenes.extend([100.0, 1e4, 1e6].map(stadium));
    let placed = [(1.0, 1e6), (1.0, 1.5), (1.4e38, 0.0), (1e37, 2e38), (1e-38, 0.0), (1e-42, 0.0), (1e-42, 1e-38)];
    scenes.push(beside_a_binade());
    scenes.extend(placed.map(|(size, offset)| placed_sphere(size, offset)));
    scenes
}

/// A unit vector to any side, level.
fn level(random: &mut Random) -> Vec3 {
    let (sin, cos) = (random.signed() * core::f32::consts::PI).sin_cos();
    Vec3::new(cos, sin, 0.0)
}

/// Two triangles of ground; a scanner 1.8 above it, near the middle, looks down by some angle.
fn scanned_ground(size: f32, [x, y]: [f32; 2], degrees: f32) -> Wide {
    let slope = Vec3::new(x, y, 0.0);
    let at = move |p: Vec3| p + Vec3::Z * slope.dot(p);
    let corner = |x: f32, y: f32| at(0.5 * size * Vec3::new(x, y, 0.0)).to_array();
    let positions = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    let kind = if x == 0.0 { "flat" } else { "tilted" };
    let name = format!("{kind} ground {} km, {degrees} degrees down", size / 1e3);
    Wide::new(name, Mesh::new(positions, vec![[0, 1, 2], [0, 2, 3]]), move |random| {
        let origin = at(0.01 * size * Vec3::from(random.vector()).with_z(0.0)) + 1.8 * Vec3::Z;
        let ahead = level(random);
        Ray::new(origin, at(ahead) - Vec3::Z * degrees.to_radians().tan())
    })
}

/// A grid of 2 km whose heights lie in an interval, seen from 2 above.
fn low_terrain([lower, upper]: [f32; 2]) -> Wide {
    const SIDE: u32 = 64;
    let place = |i: u32| 2000.0 * (i as f32 / SIDE as f32 - 0.5);
    let height = |i: u32| lower + (upper - lower) * Random::new(61, i.into()).unit();
    let positions =
        (0..(SIDE + 1) * (SIDE + 1)).map(|i| [place(i % (SIDE + 1)), place(i / (SIDE + 1)), height(i)]).collect();
    let corners = |i: u32| {
        let a = i / SIDE * (SIDE + 1) + i % SIDE;
        [[a, a + 1, a + SIDE + 2], [a, a + SIDE + 2, a + SIDE + 1]]
    };
    let mesh = Mesh::new(positions, (0..SIDE * SIDE).flat_map(corners).collect());
    Wide::new(format!("terrain 2 km, heights {lower} to {upper}"), mesh, move |random| {
        let origin = (900.0 * Vec3::from(random.vector())).with_z(upper + 2.0);
        Ray::new(origin, level(random) - Vec3::Z * (0.01 + 2.0 * random.unit()))
    })
}

/// A cube of 1 in a box, in its middle or near its wall, as far as f32 has room for a cube there.
fn sky_box(size: f32, is_central: bool) -> Wide {
    let share = if is_central { 0.0 } else { 0.3 };
    let centre = (Vec3::new(1.0, -0.7, 0.2) * (share * size).min(1e6)).round();
    let mut mesh = cube(centre, 0.5);
    meshes::append(&mut mesh, &cube(Vec3::ZERO, 0.5 * size));
    let place = if is_central { "" } else { ", off centre" };
    Wide::new(format!("cube in a sky box of {size:e}{place}"), mesh, move |random| {
        let origin = centre + 3.0 * Vec3::from(random.vector());
        rays::towards(origin.to_array(), (centre + 0.7 * Vec3::from(random.vector())).to_array())
    })
}

/// A unit square, and starts close above it.
fn start_above_square(height: f32) -> Wide {
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    Wide::new(format!("start {height:e} above a unit square"), Mesh::new(positions, vec![[0, 1, 2], [0, 2, 3]]), {
        move |random| {
            let [x, y] = [0, 1].map(|_| 0.05 + 0.9 * random.unit());
            Ray::new([x, y, height], level(random) * random.unit() - Vec3::Z * (0.1 + random.unit()))
        }
    })
}

/// A sphere of radius 1 in a far larger one, off its centre.
fn stadium(half_size: f32) -> Wide {
    let centre = (0.2 * half_size * Vec3::new(1.0, -0.5, 0.3)).round();
    let moved = |mesh: Mesh, scale: f32, by: Vec3| {
        let move_to = |p: &[f32; 3]| (scale * Vec3::from(*p) + by).to_array();
        Mesh { positions: mesh.positions.iter().map(move_to).collect(), ..mesh }
    };
    let mut mesh = moved(meshes::bumpy_sphere(4, 62), 1.0, centre);
    meshes::append(&mut mesh, &moved(meshes::bumpy_sphere(3, 63), half_size, Vec3::ZERO));
    Wide::new(format!("sphere in a stadium of {half_size:e}"), mesh, move |random| {
        let origin = centre + 4.0 * Vec3::from(random.vector());
        rays::towards(origin.to_array(), (centre + 1.2 * Vec3::from(random.vector())).to_array())
    })
}

/// A sphere of some size at an offset on all axes, seen from nearby.
fn placed_sphere(size: f32, offset: f32) -> Wide {
    let mesh = meshes::placed(&meshes::bumpy_sphere(4, 64), size, offset);
    Wide::new(format!("sphere of {size:e} at {offset:e}"), mesh, move |random| {
        let around = |reach: f32, random: &mut Random| {
            random.vector().map(|c| (offset + reach * size * c).clamp(f32::MIN, f32::MAX))
        };
        let (origin, target) = (around(1.5, random), around(1.0, random));
        // Half of each, since the difference of two large numbers may be none.
        Ray::new(origin, core::array::from_fn(|k| 0.5 * target[k] - 0.5 * origin[k]))
    })
}

/// A speck at 1 in a scene from 1 to 2, seen from just below 1, where numbers lie closer.
fn beside_a_binade() -> Wide {
    let mut mesh = meshes::placed(&meshes::bumpy_sphere(2, 65), 1e-4, 1.000_101);
    let far = Mesh::new(vec![[2.0, 2.0, 2.0], [1.5, 2.0, 2.0], [2.0, 1.5, 2.0]], vec![[0, 1, 2]]);
    meshes::append(&mut mesh, &far);
    Wide::new("speck at 1, scene to 2, seen from below 1".into(), mesh, |random| {
        let origin = core::array::from_fn(|_| 1.0 - 1e-4 * random.unit());
        rays::towards(origin, random.vector().map(|c| 1.0001 + 1e-4 * c))
    })
}

/// The cube with a centre and half of an edge.
fn cube(centre: Vec3, half: f32) -> Mesh {
    let side = |corner: usize, axis: usize| if corner >> axis & 1 == 0 { -half } else { half };
    let corner = |i| (centre + Vec3::new(side(i, 0), side(i, 1), side(i, 2))).to_array();
    let face = |[a, b, c, d]: [u32; 4]| [[a, b, d], [a, d, c]];
    let faces = [[0, 2, 1, 3], [4, 5, 6, 7], [0, 1, 4, 5], [2, 6, 3, 7], [0, 4, 2, 6], [1, 3, 5, 7]];
    Mesh::new((0..8).map(corner).collect(), faces.into_iter().flat_map(face).collect())
}
