//! Meshes made in code: closed ones whose rays from inside must hit, and nasty ones.

use core::ops::Range;
use std::collections::HashMap;

use glam::Vec3;
use leafwalk_cpu::Mesh;

pub use leafwalk_compare::scenes::{append, in_sky_box, placed};

use crate::random::Random;

/// An icosahedron with every triangle split into four, `levels` times, on the unit sphere.
pub fn icosphere(levels: u32) -> Mesh {
    let g = 0.5 * (1.0 + 5f32.sqrt());
    let mut positions: Vec<Vec3> = Vec::new();
    for (a, b) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)] {
        positions.extend([[a, b, 0.0], [0.0, a, b], [b, 0.0, a]].map(Vec3::from));
    }
    // Faces: triples at mutual distance 2, turned outward.
    let near = |a: Vec3, b: Vec3| a.distance_squared(b) < 4.1;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                let [p, q, r] = [a, b, c].map(|i| positions[i]);
                if near(p, q) && near(q, r) && near(r, p) {
                    let is_outward = (q - p).cross(r - p).dot(p) > 0.0;
                    triangles.push(if is_outward { [a, b, c] } else { [a, c, b] }.map(|i| i as u32));
                }
            }
        }
    }
    let mut mesh = Mesh::new(positions.iter().map(Vec3::to_array).collect(), triangles);
    for _ in 0..levels {
        mesh = split_in_four(&mesh);
    }
    for p in &mut mesh.positions {
        let vector = Vec3::from(*p);
        *p = (vector / vector.length()).to_array();
    }
    mesh
}

fn split_in_four(mesh: &Mesh) -> Mesh {
    let mut positions = mesh.positions.clone();
    let mut middles = HashMap::new();
    let mut triangles = Vec::new();
    for &[a, b, c] in &mesh.triangles {
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let [p, q] = [a, b].map(|corner| Vec3::from(positions[corner as usize]));
                let m = 0.5 * (p + q);
                let scale = (p.length_squared() / m.length_squared()).sqrt();
                positions.push((m * scale).to_array());
                positions.len() as u32 - 1
            })
        };
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    Mesh::new(positions, triangles)
}

/// An icosphere whose radius varies by up to 30 %; still star-shaped about the origin.
pub fn bumpy_sphere(levels: u32, seed: u64) -> Mesh {
    let mut mesh = icosphere(levels);
    for (i, p) in mesh.positions.iter_mut().enumerate() {
        let scale = 1.0 - 0.3 * Random::new(seed, i as u64).unit();
        *p = p.map(|c| c * scale);
    }
    mesh
}

/// A closed box -1..1 with T-junctions closed by collinear triangles, and faces cut into needles; faces outward.
///
/// Each y face is cut into strips whose widths fall to 1e-6; one long edge of a z face meets their many short ones, and
/// zero-area triangles bridge the two.
pub fn needle_box(strips: u32) -> Mesh {
    let mut builder = Builder::default();
    // Strip borders, denser and denser towards +1.
    let gaps = core::iter::successors(Some(2.0), |gap| Some(gap * 0.6f32));
    let mut borders: Vec<f32> = gaps.take(strips as usize).map(|gap| 1.0 - gap).collect();
    borders.dedup();
    borders.retain(|b| *b < 1.0);
    borders.push(1.0);
    for y in [-1.0, 1.0] {
        let at = |x: f32, z: f32| [x, y, z];
        for pair in borders.windows(2) {
            builder.quad_towards(y, [at(pair[0], -1.0), at(pair[1], -1.0), at(pair[1], 1.0), at(pair[0], 1.0)]);
        }
        // The strips' ends lie on the edges z = +-1, which the z faces do not divide.
        for z in [-1.0, 1.0] {
            for pair in borders.windows(2).skip(1) {
                builder.triangle_towards(y * z, [at(borders[0], z), at(pair[0], z), at(pair[1], z)]);
            }
        }
    }
    for z in [-1.0, 1.0] {
        builder.quad_towards(-z, [[-1.0, -1.0, z], [1.0, -1.0, z], [1.0, 1.0, z], [-1.0, 1.0, z]]);
    }
    for x in [-1.0, 1.0] {
        builder.quad_towards(-x, [[x, -1.0, -1.0], [x, 1.0, -1.0], [x, 1.0, 1.0], [x, -1.0, 1.0]]);
    }
    builder.mesh()
}

/// Triangles at random: from specks to walls, needles of aspect up to 1e6, duplicates, lattice-aligned ones.
pub fn soup(triangles: u32, seed: u64) -> Mesh {
    let mut builder = Builder::default();
    for i in 0..triangles {
        let mut random = Random::new(seed, u64::from(i));
        let centre = random.vector();
        let size = 10f32.powf(-4.0 * random.unit());
        let mut corners: [[f32; 3]; 3] = core::array::from_fn(|_| {
            let offset = random.vector();
            core::array::from_fn(|k| centre[k] + size * offset[k])
        });
        match random.below(8) {
            // A needle: the third corner next to the first.
            0 => {
                let width = 10f32.powf(-6.0 * random.unit());
                corners[2] = core::array::from_fn(|k| corners[0][k] + width * (corners[2][k] - corners[0][k]));
            }
            // On a lattice of 1/16, where cells have their planes.
            1 => corners = corners.map(|corner| corner.map(|c| (c * 16.0).round() / 16.0)),
            // In an axis plane.
            2 => {
                let k = random.below(3);
                corners[1][k] = corners[0][k];
                corners[2][k] = corners[0][k];
            }
            _ => {}
        }
        builder.triangle(corners);
        if random.below(16) == 0 {
            builder.triangle(corners);
        }
    }
    builder.mesh()
}

/// Triangles at random places in -1..1, of sizes and aspects (length over width) spread evenly on a logarithmic scale.
pub fn shards(triangles: u32, sizes: Range<f32>, most_aspect: f32, seed: u64) -> Mesh {
    let mut builder = Builder::default();
    for i in 0..triangles {
        let mut random = Random::new(seed, u64::from(i));
        let size = sizes.start * (sizes.end / sizes.start).powf(random.unit());
        let width = most_aspect.powf(-random.unit());
        let [centre, along, aside] = core::array::from_fn(|_| random.vector());
        // Somewhere between the ends of its long side, the third corner is moved off it.
        let (at, off) = (random.unit(), width * size);
        let corner =
            |along_by: f32, off: f32| core::array::from_fn(|k| centre[k] + along_by * along[k] + off * aside[k]);
        builder.triangle([corner(-0.5 * size, 0.0), corner(0.5 * size, 0.0), corner((at - 0.5) * size, off)]);
    }
    builder.mesh()
}

/// Walls across the whole scene, nearly parallel and close to each other, with specks between them.
pub fn walls(count: u32, seed: u64) -> Mesh {
    let mut builder = Builder::default();
    for i in 0..count {
        let mut random = Random::new(seed, u64::from(i));
        let at = i as f32 / count as f32 + 1e-5 * random.unit();
        let tilt = 1e-3 * random.signed();
        builder.quad([[-1.0, -1.0, at - tilt], [1.0, -1.0, at], [1.0, 1.0, at + tilt], [-1.0, 1.0, at]]);
        let speck = random.vector();
        builder.triangle(core::array::from_fn(|_| {
            let offset = random.vector();
            core::array::from_fn(|k| speck[k] + 1e-4 * offset[k])
        }));
    }
    builder.mesh()
}

/// A mesh turned about all axes by angles without meaning: what was flat or straight rounds off its plane or line.
pub fn turned(mesh: &Mesh) -> Mesh {
    let mut mesh = mesh.clone();
    for p in &mut mesh.positions {
        for (a, b, angle) in [(0, 1, 0.3f32), (1, 2, 0.7), (2, 0, 1.1)] {
            let (sin, cos) = angle.sin_cos();
            (p[a], p[b]) = (cos * p[a] - sin * p[b], sin * p[a] + cos * p[b]);
        }
    }
    mesh
}

/// Whether every edge is used as often in one direction as in the other, vertices of equal position taken as one: then
/// a ray from inside must hit.
pub fn is_closed(mesh: &Mesh) -> bool {
    let mut uses: HashMap<[[u32; 3]; 2], i32> = HashMap::new();
    for primitive in 0..mesh.triangles.len() {
        // -0 + 0 is 0: equal positions get equal bits.
        let corners = mesh.corners(primitive).map(|corner| corner.map(|c| (c + 0.0).to_bits()));
        for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(a, b)| (corners[a], corners[b])) {
            *uses.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 } * i32::from(a != b);
        }
    }
    uses.values().all(|balance| *balance == 0)
}

/// Shares equal vertices, so that neighbours agree on them bit for bit.
#[derive(Default)]
struct Builder {
    positions: Vec<[f32; 3]>,
    index: HashMap<[u32; 3], u32>,
    triangles: Vec<[u32; 3]>,
}

impl Builder {
    fn vertex(&mut self, position: [f32; 3]) -> u32 {
        let next = self.positions.len() as u32;
        let index = *self.index.entry(position.map(f32::to_bits)).or_insert(next);
        if index == next {
            self.positions.push(position);
        }
        index
    }

    fn triangle(&mut self, corners: [[f32; 3]; 3]) {
        let triangle = corners.map(|corner| self.vertex(corner));
        self.triangles.push(triangle);
    }

    fn quad(&mut self, [a, b, c, d]: [[f32; 3]; 4]) {
        self.triangle([a, b, c]);
        self.triangle([a, c, d]);
    }

    /// A triangle, turned over where `side` is positive.
    fn triangle_towards(&mut self, side: f32, [a, b, c]: [[f32; 3]; 3]) {
        self.triangle(if side > 0.0 { [a, c, b] } else { [a, b, c] });
    }

    /// A quad, turned over where `side` is positive.
    fn quad_towards(&mut self, side: f32, [a, b, c, d]: [[f32; 3]; 4]) {
        self.quad(if side > 0.0 { [a, d, c, b] } else { [a, b, c, d] });
    }

    fn mesh(self) -> Mesh {
        Mesh::new(self.positions, self.triangles)
    }
}
