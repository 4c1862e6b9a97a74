//! Coordinates that every format must bring through as they are, and meshes that all formats know.

use leafwalk::Mesh;
use leafwalk::mesh_file::MeshFile;

use crate::files::{f32_mesh, read};
use crate::ply::Ply;
use crate::stl::binary_stl;

pub(crate) fn bits(mesh: &Mesh) -> Vec<[u32; 3]> {
    mesh.positions.iter().map(|position| position.map(f32::to_bits)).collect()
}

// Coordinates that rounding, a detour through f64 or a text of six digits would change.
pub(crate) const CORNERS: [[f32; 3]; 5] = [
    [0.1, -0.0, 3.402_823_5e38],
    [1.175_494_4e-38, 1.0e-45, 16_777_217.0],
    [0.333_333_34, -2.718_281_7, 1.000_000_1],
    [5.0, 6.0, 7.0],
    [8.0, 9.0, 1.0],
];
pub(crate) const TRIANGLES: [[u32; 3]; 3] = [[0, 1, 2], [3, 2, 1], [4, 0, 0]];

pub(crate) fn assert_exact(file: &MeshFile) {
    assert_eq!(bits(f32_mesh(file)), CORNERS.map(|position| position.map(f32::to_bits)));
    assert_eq!(file.mesh.triangles(), TRIANGLES);
    assert_eq!(file.mesh.material_ids(), [0; 0]);
    assert!(file.materials.is_empty());
    assert_eq!(file.skipped_faces, 0);
}

#[test]
fn empty_meshes() {
    for (name, text) in [
        ("a.obj", ""),
        ("a.obj", "# nothing\nv 1 2 3"),
        ("a.stl", "solid\nendsolid\n"),
        (
            "a.ply",
            "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\n\
                   element face 0\nproperty list uchar int vertex_index\nend_header\n",
        ),
    ] {
        assert_eq!(read(name, text).mesh.triangles(), [[0; 3]; 0], "{name}");
    }
    assert_eq!(read("a.stl", [0; 84]), MeshFile::default());
}

#[test]
fn not_finite_vertices_pass() {
    let file = read("a.obj", "v nan 0 inf\nv 1 0 -inf\nv 1e39 1 0\nv 0 1 0\nf 1 2 3 4\n");
    assert!(f32_mesh(&file).positions[0][0].is_nan());
    assert_eq!(f32_mesh(&file).positions[2][0], f32::INFINITY);
    assert_eq!(file.mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
    let file = read("a.stl", binary_stl(b"", &[[[f32::NAN, 0.0, 0.0], [0.0; 3], [f32::INFINITY; 3]]]));
    assert!(f32_mesh(&file).positions[0][0].is_nan());
    let file = read("a.ply", Ply::default().bytes(&[[f32::NAN; 3]; 3], &[vec![0, 1, 2]]));
    assert!(f32_mesh(&file).positions[2][2].is_nan());
}
