//! Any ray, on a fixed octree: the answer of testing every triangle, all bits.

use std::sync::LazyLock;

use leafwalk_core::{Hit, Octree, Ray};
use leafwalk_cpu::{BruteForce, Builder, Mesh};

use super::bytes::Bytes;
use crate::tally::bits;

/// Traces the rays that the bytes spell.
pub fn check(bytes: &[u8]) {
    static SCENE: LazyLock<([Octree<Vec<u32>>; 2], BruteForce)> = LazyLock::new(|| {
        let mesh = lattice_mesh();
        let packed = Builder::new().step_cost(1.0);
        let octrees = [packed.clone(), packed.compact()].map(|builder| builder.build(&mesh).expect("a valid mesh"));
        (octrees, BruteForce::new(&mesh).expect("a valid mesh"))
    });
    let mut bytes = Bytes::new(bytes);
    while !bytes.is_empty() {
        let ray = ray(&mut bytes);
        SCENE.0.iter().for_each(|octree| check_ray(octree, &SCENE.1, &ray));
    }
}

/// Panics where the octree does not answer as brute force does.
pub fn check_ray(octree: &Octree<impl AsRef<[u32]>>, oracle: &BruteForce, ray: &Ray) {
    let bits = |hit: Option<Hit>| bits(&Hit::from(hit));
    let (found, expected) = (octree.closest_hit(ray), oracle.closest_hit(ray));
    assert_eq!(bits(found), bits(expected), "{found:?}, expected {expected:?} for {ray:?}");
    assert_eq!(octree.occluded(ray), expected.is_some(), "occluded, {ray:?}");
}

/// The ray that bytes spell.
pub(super) fn ray(bytes: &mut Bytes<'_>) -> Ray {
    let (origin, direction) = (bytes.point(), bytes.point());
    let (t_min, t_max) = match bytes.byte() % 4 {
        0 | 1 => (0.0, f32::INFINITY),
        2 => (bytes.coordinate(), bytes.coordinate()),
        _ => (f32::from_bits(bytes.word()), f32::from_bits(bytes.word())),
    };
    Ray::between(origin, direction, t_min, t_max)
}

/// Two crossing sheets of triangles on a lattice of 1/8, a needle, a wall, and a speck that deepens the octree. Around
/// 0, so that planes of cells are multiples of powers of two.
fn lattice_mesh() -> Mesh {
    let mut positions = Vec::new();
    let mut add = |corners: [[f32; 3]; 3]| positions.extend(corners);
    for (i, j) in (0..8).flat_map(|i| (0..8).map(move |j| (i, j))) {
        let [x, y] = [i, j].map(|i| i as f32 / 8.0);
        let step = 0.125;
        add([[x, y, 0.5], [x + step, y, 0.5], [x, y + step, 0.5]]);
        add([[x, 0.25, y], [x, 0.25, y + step], [x + step, 0.375, y]]);
    }
    add([[-1.0, -1.0, 0.25], [1.0, 1.0, 0.25], [1.0, 0.999_999, 0.25]]);
    add([[-1.0, -1.0, -1.0], [1.0, -1.0, -0.5], [-1.0, 1.0, 1.0]]);
    for i in 0..32 {
        let [x, y] = [i % 4, i / 4].map(|i| 0.25 + i as f32 * 1e-3);
        add([[x, y, 0.25], [x + 1e-3, y, 0.251], [x, y + 1e-3, 0.25]]);
    }
    let triangles = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh::new(positions, triangles)
}
