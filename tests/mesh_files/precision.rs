//! Whether a mesh is of f32 or of f64, and that neither loses more than it must.

use leafwalk::mesh_file::{AnyMesh, MeshFile};

use crate::files::{f32_mesh, read};
use crate::ply::{FORMATS, Ply};

/// Half way between two numbers of f32, and a little more: f64 ends half way, from where f32 goes down to the even one.
const ABOVE_HALF_WAY: &str = "1.0000000596046447753906250000001";

/// Corners in UTM coordinates, to millimetres.
const UTM: [[f64; 3]; 3] =
    [[500_000.123, 4_500_000.004, 10.5], [500_010.456, 4_500_000.25, 10.5], [500_000.2, 4_500_009.999, 20.0]];

fn obj(positions: &[[f64; 3]], rest: &str) -> String {
    let lines = positions.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n"));
    lines.collect::<String>() + rest
}

fn f64_positions(file: &MeshFile) -> &[[f64; 3]] {
    let AnyMesh::F64(mesh) = &file.mesh else { panic!("a mesh of f32") };
    &mesh.positions
}

#[test]
fn text_is_rounded_to_f32_once() {
    assert_eq!(ABOVE_HALF_WAY.parse::<f64>().expect("a number") as f32, 1.0, "no text to test with");
    let text = |rest: &str| format!("v {ABOVE_HALF_WAY} 0 -{ABOVE_HALF_WAY}\nv 4 0 0 {rest}\nv 0 4 0\nf 1 2 3\n");
    for weight in ["", "1", "2"] {
        let file = read("a.obj", text(weight));
        assert_eq!(f32_mesh(&file).positions[0], [1.000_000_1, 0.0, -1.000_000_1]);
    }
    for (lists, list) in [("", ""), ("property list uchar float weights\n", "2 0.5 0.5 ")] {
        let header = format!(
            "ply\nformat ascii 1.0\nelement vertex 3\n{lists}property double x\nproperty float y\nproperty double z\n\
             element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        );
        let text = format!("{list}{ABOVE_HALF_WAY} 0 -{ABOVE_HALF_WAY}\n{list}4 0 0\n{list}0 4 0\n3 0 1 2\n");
        let file = read("a.ply", header + &text);
        assert_eq!(f32_mesh(&file).positions[0], [1.000_000_1, 0.0, -1.000_000_1]);
    }
}

#[test]
fn utm_coordinates_stay_f64() {
    let file = read("a.obj", obj(&UTM, "f 1 2 3\n"));
    assert_eq!(f64_positions(&file), UTM);
    assert_eq!((file.mesh.triangles(), file.mesh.as_f32()), (&[[0, 1, 2]][..], None));
    let rounded = UTM.map(|position| position.map(|c| c as f32));
    assert_eq!(file.mesh.into_f32().positions, rounded);

    // A vertex that no triangle uses has no say, wherever it lies.
    for stray in [[0.0; 3], [1e39, 0.0, 0.0], [f64::NAN; 3]] {
        let file = read("a.obj", obj(&[stray, UTM[0], UTM[1], UTM[2]], "f 2 3 4\n"));
        assert_eq!(f64_positions(&file)[1..], UTM);
    }
    // Weights divide in f64.
    let double = UTM.map(|position| position.map(|c| 2.0 * c));
    let weighted = double.map(|[x, y, z]| format!("v {x} {y} {z} 2\n")).concat();
    assert_eq!(f64_positions(&read("a.obj", weighted + "f 1 2 3\n")), UTM);
}

#[test]
fn doubles_and_whole_numbers_of_ply_stay_f64() {
    let corners = [[0_i32, 0, 0], [16_777_217, 0, 0], [16_777_217, 1, 1]];
    for format in FORMATS {
        let double = Ply { format, coordinate: "double", ..Ply::default() };
        assert_eq!(f64_positions(&read("a.ply", double.bytes_f64(&UTM, &[vec![0, 1, 2]]))), UTM);
        let whole = Ply { format, coordinate: "int", ..Ply::default() };
        let near = corners.map(|corner| corner.map(f64::from));
        // The extent is as large as the numbers are, so what f32 cannot tell apart is under a roundoff of it.
        let file = read("a.ply", whole.bytes_f64(&near, &[vec![0, 1, 2]]));
        assert_eq!(f32_mesh(&file).positions[1][0], 16_777_216.0);
        let far = near.map(|[x, y, z]| [16_777_217.0 + x / 16_777_217.0, y, z]);
        assert_eq!(f64_positions(&read("a.ply", whole.bytes_f64(&far, &[vec![0, 1, 2]]))), far);
    }
}

#[test]
fn a_mesh_is_of_f32_up_to_a_roundoff_of_its_extent() {
    // A triangle as large as `extent` whose corner rounding moves by 2^-26.
    let corner = 1.0 + f64::from(f32::EPSILON) / 8.0;
    let text = |extent: f64| obj(&[[corner, 0.0, 0.0], [1.0, extent, 0.0], [1.0, 0.0, 0.0]], "f 1 2 3\n");
    assert_eq!(f32_mesh(&read("a.obj", text(0.25))).positions[0], [1.0, 0.0, 0.0]);
    assert_eq!(f64_positions(&read("a.obj", text(0.249)))[0], [corner, 0.0, 0.0]);
}
