//! Any mesh: a typed error, or an octree that verifies and answers as brute force does.

use leafwalk_core::Ray;
use leafwalk_cpu::{BruteForce, BuildError, Builder, Mesh, verify_against};

use super::bytes::Bytes;
use super::trace::{check_ray, ray};

const MOST_TRIANGLES: usize = 200;
const RAYS: usize = 16;

/// Builds the mesh that the bytes spell: vertices on a lattice, off it, or of any bits; one index in 32 wild.
pub fn check(bytes: &[u8]) {
    let mut bytes = Bytes::new(bytes);
    let settings = bytes.byte();
    let vertices = 1 + bytes.below(64);
    let positions: Vec<_> = (0..vertices).map(|_| bytes.point()).collect();
    let mut mesh = Mesh::new(positions, Vec::new());
    while !bytes.is_empty() && mesh.triangles.len() < MOST_TRIANGLES {
        mesh.triangles.push(core::array::from_fn(|_| match bytes.byte() {
            wild if wild >= 248 => bytes.word(),
            index => u32::from(index) % vertices as u32,
        }));
    }
    if settings & 128 != 0 {
        // The root lies around 0: planes of cells are on the lattice of the coordinates.
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([[-2.0; 3], [2.0; 3], [2.0, -2.0, 2.0]]);
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    if settings & 1 == 1 {
        mesh.material_ids = (0..mesh.triangles.len() as u32).collect();
    }
    let step_cost = [0.5, 1.0, 4.0, 48.0][usize::from(settings >> 1 & 3)];
    let builder = Builder::new().step_cost(step_cost).max_level(u32::from(settings >> 3 & 15) + 1);
    check_strict(&builder, &mesh);
    check_strict(&builder.clone().compact(), &mesh);

    match builder.clone().lenient().build(&mesh) {
        Ok(octree) => {
            verify_against(&octree, &mesh).expect("what is built verifies");
        }
        Err(error) => assert!(matches!(error, BuildError::IndexOutOfRange { .. }), "{error}"),
    }
}

fn check_strict(builder: &Builder, mesh: &Mesh) {
    let octree = match builder.build(mesh) {
        Ok(octree) => octree,
        Err(BuildError::IndexOutOfRange { triangle, index, vertices }) => {
            assert!(mesh.triangles[triangle].contains(&index) && index as usize >= vertices);
            return;
        }
        Err(BuildError::NonFiniteVertex { vertex, position }) => {
            assert!(!position.iter().all(|c| c.is_finite()), "vertex {vertex}");
            return;
        }
        Err(error) => panic!("{error}"),
    };
    verify_against(&octree, mesh).expect("what is built verifies");
    let oracle = BruteForce::new(mesh).expect("what builds");
    // Rays through the mesh's own vertices, and any.
    let corners: Vec<_> = mesh.triangles.iter().flatten().map(|i| mesh.positions[*i as usize]).collect();
    for pair in corners.windows(2).take(RAYS) {
        let direction = core::array::from_fn(|k| pair[1][k] - pair[0][k]);
        check_ray(&octree, &oracle, &Ray::between(pair[0], direction, -1.0, 2.0));
    }
    let mut spelled = Bytes::new(bytemuck::cast_slice(&corners));
    for _ in 0..RAYS {
        check_ray(&octree, &oracle, &ray(&mut spelled));
    }
}
