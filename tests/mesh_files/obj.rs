//! OBJ files.

use leafwalk::mesh_file::MeshError;

use crate::exact::{CORNERS, TRIANGLES, assert_exact};
use crate::files::{f32_mesh, read, refuse};

#[test]
fn obj_is_exact() {
    let mut text = String::new();
    for [x, y, z] in CORNERS {
        text += &format!("v {x} {y} {z}\n");
    }
    for triangle in TRIANGLES {
        let [a, b, c] = triangle.map(|index| index + 1);
        text += &format!("f {a} {b} {c}\n");
    }
    assert_exact(&read("a.obj", &text));
    assert_exact(&read("A.OBJ", text.replace('\n', "\r\n")));
    assert_exact(&read("a.obj", format!("\u{feff}{}", text.trim_end())));
    assert_exact(&read(
        "a.obj",
        text.replace("\nf ", " # inline\n\ns 1\n# C:\\folder\\\n  f\t").replace(" 3.", "\\\n 3."),
    ));
    let latin = [b"# caf\xe9\ng caf\xe9\n", text.as_bytes()].concat();
    assert_exact(&read("a.obj", latin));
}

#[test]
fn obj_keeps_the_order_of_the_file_and_shares_vertices_across_groups() {
    let file = read(
        "a.obj",
        "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 1 1 0\no first\nf 4 3 2\ng second\nf 2 3 4\nl 1 2 3 4\np 1\n\
         v 0 1 0\nv 8 8 8\no third\nf 5 2 3\nusemtl\ng first\nf 4 5 2\n",
    );
    let positions = [[9.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [8.0; 3]];
    assert_eq!(f32_mesh(&file).positions, positions);
    assert_eq!(file.mesh.triangles(), [[3, 2, 1], [1, 2, 3], [4, 1, 2], [3, 4, 1]]);
}

#[test]
fn obj_corners() {
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    let triangles = |faces: &str| read("a.obj", format!("{square}{faces}")).mesh.triangles().to_vec();
    assert_eq!(triangles("f 1 2 3 4"), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(triangles("f -4 -3 -2 -1"), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(triangles("f -1 1 +2\nv 5 5 5\nf -2 1 2"), [[3, 0, 1], [3, 0, 1]]);
    assert_eq!(triangles("vt 0 0\nvn 0 0 1\nf 1/1/1 2//1 3/99\nf 1/-7 2/ 3/0/0"), [[0, 1, 2], [0, 1, 2]]);
    assert_eq!(triangles("fo 1 2 3"), [[0, 1, 2]]);
    // A face may come before its vertices.
    let file = read("a.obj", format!("f 4 1 3\n{square}"));
    assert_eq!(f32_mesh(&file).positions[3], [0.0, 1.0, 0.0]);
    assert_eq!(file.mesh.triangles(), [[3, 0, 2]]);
    let pentagon = "v 2 0 0\nv 0.6 1.9 0\nv -1.6 1.2 0\nv -1.6 -1.2 0\nv 0.6 -1.9 0\nf 3 4 5 1 2\n";
    assert_eq!(read("a.obj", pentagon).mesh.triangles(), [[2, 3, 4], [2, 4, 0], [2, 0, 1]]);
}

#[test]
fn obj_vertices_with_weight_or_color() {
    let file = read("a.obj", "v 2 4 6 2\nv 1 2 3 0.1 0.2 0.3\nv 1 2 3 0.1 0.2 0.3 1\nv 1 2 3 1\nf 1 2 3\n");
    assert_eq!(f32_mesh(&file).positions, [[1.0, 2.0, 3.0]; 4]);
}

#[test]
fn obj_skips_points_and_lines_and_counts_them() {
    let file = read("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl a\nf 1\nf 1 2\nf\nusemtl b\nf 1 2 3\nf 2 3\n");
    assert_eq!(file.mesh.triangles(), [[0, 1, 2]]);
    assert_eq!(file.skipped_faces, 4);
    assert_eq!(file.materials[file.mesh.material_ids()[0] as usize].name, "b");
}

#[test]
fn bad_obj() {
    let square = "v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\n";
    let refuse = |rest: &str| refuse("bad.obj", format!("{square}{rest}"));
    assert_matches!(refuse("f 1 2 3\nf 0 1 2\n"), MeshError::ZeroIndex { face: 2, line: 6, .. });
    assert_matches!(refuse("f 1/1 2/1 -0/1"), MeshError::ZeroIndex { face: 1, .. });
    assert_matches!(refuse("f 1\nf 0"), MeshError::ZeroIndex { face: 2, .. });
    assert_matches!(refuse("f 1 2 5"), MeshError::IndexOutOfRange { face: 1, index: 5, vertices: 4, .. });
    assert_matches!(refuse("f 1 2 3\nf 1 2 -5"), MeshError::IndexOutOfRange { face: 2, index: -5, vertices: 4, .. });
    assert_matches!(refuse("f 1 2 9223372036854775807"), MeshError::IndexOutOfRange { index: i64::MAX, .. });
    assert_matches!(refuse("f 1 2 -9223372036854775808"), MeshError::IndexOutOfRange { index: i64::MIN, .. });
    assert_matches!(refuse("f 1 2 4294967297"), MeshError::IndexOutOfRange { index: 4_294_967_297, .. });
    for bad in ["f 1 2 9223372036854775808", "f 1 2 x", "f 1 2 3.0", "f 1 2 /3", "v 1 2", "v 1 2 x", "v 1 2 3 0", "v"] {
        assert_matches!(refuse(&format!("\n{bad}\nf 1 2 3\n")), MeshError::Syntax { line: 6, .. });
    }
    assert_matches!(refuse("f 1 2 \0"), MeshError::Syntax { line: 5, .. });
    assert_matches!(refuse("# old\rf 1 2 3\r"), MeshError::Syntax { line: 5, .. });
    let concave = refuse("f 1 2 3\nf 1 2\nf 1 2 3 4\n");
    assert_matches!(&concave, MeshError::ConcaveFace { face: 3, corners: 4, corner: 3, .. });
    let text = concave.to_string();
    assert!(text.contains("bad.obj") && text.contains("face 3") && text.contains("triangles"), "{text}");
    assert_matches!(refuse("v 4 4 4\nf 1 2 5 4"), MeshError::NonPlanarFace { face: 1, corners: 4, .. });
}
