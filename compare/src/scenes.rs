//! Scenes made of a mesh: elsewhere, larger, in wide surroundings.

use leafwalk_cpu::Mesh;

/// A mesh scaled, then moved.
pub fn placed(mesh: &Mesh, scale: f32, offset: f32) -> Mesh {
    let move_to = |p: &[f32; 3]| p.map(|c| c * scale + offset);
    Mesh { positions: mesh.positions.iter().map(move_to).collect(), ..mesh.clone() }
}

/// Adds another mesh's triangles to a mesh, as they are.
pub fn append(mesh: &mut Mesh, other: &Mesh) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(&other.positions);
    mesh.triangles.extend(other.triangles.iter().map(|triangle| triangle.map(|index| first + index)));
}

/// A mesh in a cube of some edge, whose centre is off the mesh's coordinate 0 by a share of the edge.
pub fn in_sky_box(mesh: &Mesh, edge: f32, share: f32) -> Mesh {
    let side = |corner: usize, k: usize| edge * (share + if corner >> k & 1 == 1 { 0.5 } else { -0.5 });
    let positions = (0..8).map(|corner| [0, 1, 2].map(|k| side(corner, k))).collect();
    let face = |[a, b, c, d]: [u32; 4]| [[a, b, d], [a, d, c]];
    let faces = [[0, 2, 1, 3], [4, 5, 6, 7], [0, 1, 4, 5], [2, 6, 3, 7], [0, 4, 2, 6], [1, 3, 5, 7]];
    let mut whole = mesh.clone();
    append(&mut whole, &Mesh::new(positions, faces.into_iter().flat_map(face).collect()));
    whole
}

/// A mesh longer along one axis, then turned about the others, so that its triangles are slivers that lie along no axis.
pub fn stretched(mesh: &Mesh, factor: f32) -> Mesh {
    let (sine, cosine) = 0.6f32.sin_cos();
    let turn = |[x, y, z]: [f32; 3]| {
        let x = factor * x;
        let (x, y) = (cosine * x - sine * y, sine * x + cosine * y);
        [x, cosine * y - sine * z, sine * y + cosine * z]
    };
    Mesh { positions: mesh.positions.iter().copied().map(turn).collect(), ..mesh.clone() }
}
