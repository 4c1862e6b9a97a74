//! Scenes of f64 in UTM coordinates, of which f32 keeps half metres: alone, and in surroundings up to 1e9 times their size.

use glam::DVec3;
use leafwalk_core::RayF64;
use leafwalk_cpu::Mesh;

use super::meshes;
use crate::random::Random;

/// Where all scenes are, in metres: easting, northing, height.
pub const PLACE: DVec3 = DVec3::new(500_000.123_456, 4_500_000.004, 47.11);
/// How long and high [`wall`] is.
pub const SIDE: f64 = 10.0;

/// A mesh, and rays at what is looked at.
pub struct Utm {
    /// As tables print it.
    pub name: String,
    /// All of it.
    pub mesh: Mesh<f64>,
    aim: Box<dyn Fn(&mut Random) -> RayF64 + Sync>,
}

impl Utm {
    fn new(name: String, mesh: Mesh<f64>, aim: impl Fn(&mut Random) -> RayF64 + Sync + 'static) -> Self {
        Self { name, mesh, aim: Box::new(aim) }
    }

    /// A ray of numbers that depend on nothing but the seed and the index.
    pub fn ray(&self, random: &mut Random) -> RayF64 {
        (self.aim)(random)
    }
}

/// All scenes in UTM coordinates.
pub fn all() -> Vec<Utm> {
    let mut scenes = vec![Utm::new("UTM wall 10 m".into(), wall(0.05), at_wall), scanned_ground()];
    scenes.extend([(100.0, 1.0), (1.0, 1e3), (1.0, 1e6), (4e-3, 1e9)].map(|(size, share)| sphere_inside(size, share)));
    scenes
}

/// A wall along x, with stones that stand out by so much at most.
pub fn wall(depth: f64) -> Mesh<f64> {
    const SQUARES: u32 = 40;
    let row = SQUARES + 1;
    let position = |i: u32| {
        let [x, z] = [i % row, i / row].map(|k| f64::from(k) * SIDE / f64::from(SQUARES));
        (PLACE + DVec3::new(x, depth * f64::from(Random::new(81, i.into()).unit()), z)).to_array()
    };
    let square = |i: u32| [[i, i + 1, i + row], [i + row, i + 1, i + row + 1]];
    let squares = (0..SQUARES * SQUARES).map(|i| i / SQUARES * row + i % SQUARES);
    Mesh::new_f64((0..row * row).map(position).collect(), squares.flat_map(square).collect())
}

/// A ray from 3 to 30 m away, at the wall or past it.
pub fn at_wall(random: &mut Random) -> RayF64 {
    let mut between = |low: f64, high: f64| low + (high - low) * f64::from(random.unit());
    let target = PLACE + DVec3::new(between(-1.0, SIDE + 1.0), 0.025, between(-1.0, SIDE + 1.0));
    let away = DVec3::new(between(-1.0, 1.0), between(0.6, 1.0), between(-1.0, 1.0)).normalize();
    let side = if between(0.0, 1.0) < 0.5 { 1.0 } else { -1.0 };
    let origin = target + side * away * between(3.0, 30.0);
    RayF64::new(origin, (target - origin) * between(0.01, 2.0))
}

/// Two triangles of ground, 2 km wide and tilted; a scanner 1.8 m above it looks a degree down.
fn scanned_ground() -> Utm {
    let at = |x: f64, y: f64| PLACE + DVec3::new(x, y, 0.31 * x + 0.17 * y);
    let corners = [(-1e3, -1e3), (1e3, -1e3), (1e3, 1e3), (-1e3, 1e3)];
    let mesh = Mesh::new_f64(corners.map(|(x, y)| at(x, y).to_array()).to_vec(), vec![[0, 1, 2], [0, 2, 3]]);
    Utm::new("UTM ground 2 km, 1 degree down".into(), mesh, move |random| {
        let [x, y] = [0, 1].map(|_| 20.0 * f64::from(random.signed()));
        let (sin, cos) = (f64::from(random.signed()) * core::f64::consts::PI).sin_cos();
        let ahead = at(cos, sin) - PLACE - DVec3::Z * 1f64.to_radians().tan();
        RayF64::new(at(x, y) + 1.8 * DVec3::Z, ahead)
    })
}

/// A sphere of a radius, in a box, off its centre, that is so many times as wide; or alone.
fn sphere_inside(size: f64, share: f64) -> Utm {
    let sphere = meshes::bumpy_sphere(3, 84);
    let place = |p: &[f32; 3]| (PLACE + size * DVec3::from_array(p.map(f64::from))).to_array();
    let mut mesh = Mesh::new_f64(sphere.positions.iter().map(place).collect(), sphere.triangles);
    let mut name = format!("UTM sphere of {size:e}");
    if share > 1.0 {
        let first = mesh.positions.len() as u32;
        let lower = PLACE - share * size * DVec3::new(0.3, 0.6, 0.2);
        let side = |corner: u32, k: u32| f64::from(corner >> k & 1);
        let corner = |i| (lower + share * size * DVec3::new(side(i, 0), side(i, 1), side(i, 2))).to_array();
        mesh.positions.extend((0..8).map(corner));
        let face = |[a, b, c, d]: [u32; 4]| [[a, b, d], [a, d, c]].map(|t| t.map(|i| first + i));
        let faces = [[0, 2, 1, 3], [4, 5, 6, 7], [0, 1, 4, 5], [2, 6, 3, 7], [0, 4, 2, 6], [1, 3, 5, 7]];
        mesh.triangles.extend(faces.into_iter().flat_map(face));
        name += &format!(" in a box {share:e} times as wide");
    }
    Utm::new(name, mesh, move |random| {
        let mut around = |reach: f64| PLACE + reach * size * DVec3::from_array(random.vector().map(f64::from));
        let (origin, target) = (around(3.0), around(0.9));
        RayF64::new(origin, target - origin)
    })
}
