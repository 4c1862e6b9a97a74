//! Triangles as the crates take them that leave the triangle test to their user.

use glam::Vec3A;
use leafwalk::Mesh;
use obvhs::triangle::Triangle;

/// All triangles of a mesh.
pub fn all(mesh: &Mesh) -> Vec<Triangle> {
    let corner = |p: [f32; 3]| Vec3A::from_array(p);
    (0..mesh.triangles.len()).map(|i| mesh.corners(i).map(corner)).map(|[v0, v1, v2]| Triangle { v0, v1, v2 }).collect()
}
