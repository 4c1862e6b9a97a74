//! Mesh files written here or found in the folder LEAFWALK_SCENES, read back.
#![cfg(feature = "mesh-files")]

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::write::GzEncoder;
use leafwalk::Mesh;
use leafwalk::mesh_file::{Limits, Material, MeshError, MeshFile, load, load_with};
use tempfile::TempDir;

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn write(folder: &TempDir, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    path
}

fn gzip(bytes: impl AsRef<[u8]>) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes.as_ref()).unwrap();
    encoder.finish().unwrap()
}

/// Reads the bytes as a file of that name, and again gzipped: both must give the same.
fn read(name: &str, bytes: impl AsRef<[u8]>) -> MeshFile {
    let folder = folder();
    let plain = load(&write(&folder, name, &bytes)).unwrap();
    let zipped = load(&write(&folder, &format!("{name}.gz"), gzip(&bytes))).unwrap();
    // Not `==`: a NaN must equal itself here, and the zeros differ.
    assert_eq!(format!("{plain:?}"), format!("{zipped:?}"));
    plain
}

/// As [`read`], for bytes that are no mesh.
fn refuse(name: &str, bytes: impl AsRef<[u8]>) -> MeshError {
    let folder = folder();
    let plain = load(&write(&folder, name, &bytes)).unwrap_err();
    let zipped = load(&write(&folder, &format!("{name}.gz"), gzip(&bytes))).unwrap_err();
    assert_eq!(plain.to_string().replace(name, ""), zipped.to_string().replace(&format!("{name}.gz"), ""));
    assert!(plain.to_string().starts_with(&plain.path().display().to_string()), "{plain}");
    plain
}

/// Whether a value matches a pattern; shows it if not.
macro_rules! assert_matches {
    ($value:expr, $pattern:pat $(if $guard:expr)?) => {{
        let value = $value;
        assert!(matches!(&value, $pattern $(if $guard)?), "{value:?}");
    }};
}

fn bits(mesh: &Mesh) -> Vec<[u32; 3]> {
    mesh.positions.iter().map(|position| position.map(f32::to_bits)).collect()
}

// Coordinates that rounding, a detour through f64 or a text of six digits would change.
const CORNERS: [[f32; 3]; 5] = [
    [0.1, -0.0, 3.402_823_5e38],
    [1.175_494_4e-38, 1.0e-45, 16_777_217.0],
    [0.333_333_34, -2.718_281_7, 1.000_000_1],
    [5.0, 6.0, 7.0],
    [8.0, 9.0, 1.0],
];
const TRIANGLES: [[u32; 3]; 3] = [[0, 1, 2], [3, 2, 1], [4, 0, 0]];

fn assert_exact(file: &MeshFile) {
    assert_eq!(bits(&file.mesh), CORNERS.map(|position| position.map(f32::to_bits)));
    assert_eq!(file.mesh.triangles, TRIANGLES);
    assert_eq!(file.mesh.material_ids, []);
    assert_eq!(file.materials, []);
    assert_eq!(file.skipped_faces, 0);
}

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
    assert_eq!(file.mesh.positions, positions);
    assert_eq!(file.mesh.triangles, [[3, 2, 1], [1, 2, 3], [4, 1, 2], [3, 4, 1]]);
}

#[test]
fn obj_corners() {
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    let triangles = |faces: &str| read("a.obj", format!("{square}{faces}")).mesh.triangles;
    assert_eq!(triangles("f 1 2 3 4"), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(triangles("f -4 -3 -2 -1"), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(triangles("f -1 1 +2\nv 5 5 5\nf -2 1 2"), [[3, 0, 1], [3, 0, 1]]);
    assert_eq!(triangles("vt 0 0\nvn 0 0 1\nf 1/1/1 2//1 3/99\nf 1/-7 2/ 3/0/0"), [[0, 1, 2], [0, 1, 2]]);
    assert_eq!(triangles("fo 1 2 3"), [[0, 1, 2]]);
    // A face may come before its vertices.
    let file = read("a.obj", format!("f 4 1 3\n{square}"));
    assert_eq!(file.mesh.positions[3], [0.0, 1.0, 0.0]);
    assert_eq!(file.mesh.triangles, [[3, 0, 2]]);
    let pentagon = "v 2 0 0\nv 0.6 1.9 0\nv -1.6 1.2 0\nv -1.6 -1.2 0\nv 0.6 -1.9 0\nf 3 4 5 1 2\n";
    assert_eq!(read("a.obj", pentagon).mesh.triangles, [[2, 3, 4], [2, 4, 0], [2, 0, 1]]);
}

#[test]
fn obj_vertices_with_weight_or_color() {
    let file = read("a.obj", "v 2 4 6 2\nv 1 2 3 0.1 0.2 0.3\nv 1 2 3 0.1 0.2 0.3 1\nv 1 2 3 1\nf 1 2 3\n");
    assert_eq!(file.mesh.positions, [[1.0, 2.0, 3.0]; 4]);
}

#[test]
fn obj_skips_points_and_lines_and_counts_them() {
    let file = read("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl a\nf 1\nf 1 2\nf\nusemtl b\nf 1 2 3\nf 2 3\n");
    assert_eq!(file.mesh.triangles, [[0, 1, 2]]);
    assert_eq!(file.skipped_faces, 4);
    assert_eq!(file.materials[file.mesh.material_ids[0] as usize].name, "b");
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
        assert_eq!(read(name, text).mesh.triangles, [[0; 3]; 0], "{name}");
    }
    assert_eq!(read("a.stl", [0; 84]), MeshFile::default());
}

#[test]
fn not_finite_vertices_pass() {
    let file = read("a.obj", "v nan 0 inf\nv 1 0 -inf\nv 1e39 1 0\nv 0 1 0\nf 1 2 3 4\n");
    assert!(file.mesh.positions[0][0].is_nan());
    assert_eq!(file.mesh.positions[2][0], f32::INFINITY);
    assert_eq!(file.mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    let file = read("a.stl", binary_stl(b"", &[[[f32::NAN, 0.0, 0.0], [0.0; 3], [f32::INFINITY; 3]]]));
    assert!(file.mesh.positions[0][0].is_nan());
    let file = read("a.ply", Ply::default().bytes(&[[f32::NAN; 3]; 3], &[vec![0, 1, 2]]));
    assert!(file.mesh.positions[2][2].is_nan());
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

#[test]
fn materials() {
    let folder = folder();
    let obj = "mtllib colors.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nusemtl red wall\nf 1 2 3 4\n\
               usemtl lamp\nusemtl unknown\nf 1 2 3\ng other\nf 1 3 4\nusemtl lamp\nf 1 2 3\nusemtl unused\n";
    let mtl = "newmtl lamp\nKd 0.25 0.5 0.75\nKe 17 12 4\nillum x\nNs\nd -halo 0.5\nmap_Kd\n\n  newmtl red wall\r\nKd 1 0 0\n\
               newmtl grey\nKd 0.25\nKe 1 2\nnewmtl spectral\nKd spectral steel.rfl\nKe nan 0 0\n";
    let material = |name: &str, diffuse, emission| Material { name: name.to_owned(), diffuse, emission };
    let expected = [
        material("lamp", [0.25, 0.5, 0.75], [17.0, 12.0, 4.0]),
        material("red wall", [1.0, 0.0, 0.0], [0.0; 3]),
        material("grey", [0.25; 3], [0.0; 3]),
        material("spectral", [0.5; 3], [0.0; 3]),
        material("", [0.5; 3], [0.0; 3]),
        material("unknown", [0.5; 3], [0.0; 3]),
    ];
    write(&folder, "colors.mtl", mtl);
    let (plain, zipped) = (write(&folder, "a.obj", obj), write(&folder, "b.obj.gz", gzip(obj)));
    let file = load(&plain).unwrap();
    assert_eq!(file.materials, expected);
    assert_eq!(file.mesh.material_ids, [4, 1, 1, 5, 5, 0]);
    assert!(file.missing_libraries.is_empty());
    assert_eq!(load(&zipped).unwrap(), file);

    fs::remove_file(folder.path().join("colors.mtl")).unwrap();
    write(&folder, "colors.mtl.gz", gzip(mtl));
    assert_eq!(load(&plain).unwrap(), file);
    assert_eq!(load(&zipped).unwrap(), file);

    fs::remove_file(folder.path().join("colors.mtl.gz")).unwrap();
    fs::create_dir(folder.path().join("colors.mtl")).unwrap();
    let bare = load(&plain).unwrap();
    let names: Vec<&str> = bare.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!(names, ["", "red wall", "unknown", "lamp"]);
    assert!(bare.materials.iter().all(|material| material.diffuse == [0.5; 3] && material.emission == [0.0; 3]));
    assert_eq!(bare.mesh.material_ids, [0, 1, 1, 2, 2, 3]);
    assert_eq!(bare.missing_libraries, [folder.path().join("colors.mtl")]);
    assert_eq!(bare.mesh.triangles, file.mesh.triangles);
}

#[test]
fn material_libraries_with_spaces_or_several() {
    let folder = folder();
    write(&folder, "my colors.mtl", "newmtl a\nKd 1 1 1\n");
    write(&folder, "b.mtl", "newmtl b\nKd 0 0 0\nnewmtl a\nKd 0 1 0\n");
    let obj = "mtllib\tmy colors.mtl\nmtllib b.mtl none.mtl\nv 0 0 0\nusemtl b\nf 1 1 1\n";
    let file = load(&write(&folder, "a.obj", obj)).unwrap();
    let found: Vec<_> = file.materials.iter().map(|material| (material.name.as_str(), material.diffuse)).collect();
    assert_eq!(found, [("a", [0.0, 1.0, 0.0]), ("b", [0.0; 3])]);
    assert_eq!(file.mesh.material_ids, [1]);
    assert_eq!(file.missing_libraries, [folder.path().join("none.mtl")]);
    let plain = load(&write(&folder, "c.obj", obj.replace("usemtl b\n", ""))).unwrap();
    assert_eq!((plain.materials, plain.mesh.material_ids), (vec![], vec![]));
}

#[test]
fn bad_material_libraries_name_their_own_file() {
    let folder = folder();
    let obj = write(&folder, "a.obj", "mtllib a.mtl\nv 0 0 0\nusemtl a\nf 1 1 1\n");
    let mtl = write(&folder, "a.mtl", "newmtl a\nnewmtl\nKd 1 1 1\n");
    let error = load(&obj).unwrap_err();
    assert_matches!(&error, MeshError::Syntax { line: 2, .. });
    assert_eq!(error.path(), mtl);
    write(&folder, "a.mtl", "newmtl \0");
    assert_matches!(load(&obj).unwrap_err(), MeshError::Syntax { line: 1, .. });
    write(&folder, "a.mtl", &gzip("newmtl a\nKd 1 1 1\n")[..20]);
    assert_matches!(load(&obj).unwrap_err(), MeshError::Gzip { path, .. } if *path == mtl);
}

/// How a PLY file is written.
#[derive(Clone, Copy)]
struct Ply {
    format: &'static str,
    coordinate: &'static str,
    count: &'static str,
    index: &'static str,
    list: &'static str,
    /// Normals, colours, edges and lists that a mesh does not need, and faces before vertices.
    more: bool,
}

impl Default for Ply {
    fn default() -> Self {
        let format = "binary_little_endian";
        Self { format, coordinate: "float", count: "uchar", index: "int", list: "vertex_indices", more: false }
    }
}

impl Ply {
    fn number(&self, kind: &str, value: f64, out: &mut Vec<u8>) {
        let integer = value as i64;
        let little = match kind {
            _ if self.format == "ascii" && kind == "float" => return write!(out, "{:e} ", value as f32).unwrap(),
            _ if self.format == "ascii" => return write!(out, "{value} ").unwrap(),
            "char" | "int8" | "uchar" | "uint8" => (integer as u8).to_le_bytes().to_vec(),
            "short" | "int16" | "ushort" | "uint16" => (integer as u16).to_le_bytes().to_vec(),
            "int" | "int32" | "uint" | "uint32" => (integer as u32).to_le_bytes().to_vec(),
            "float" | "float32" => (value as f32).to_le_bytes().to_vec(),
            _ => value.to_le_bytes().to_vec(),
        };
        if self.format == "binary_big_endian" { out.extend(little.iter().rev()) } else { out.extend(little) }
    }

    fn bytes(&self, positions: &[[f32; 3]], faces: &[Vec<i64>]) -> Vec<u8> {
        let Self { format, coordinate, count, index, list, more } = *self;
        let extra = if more { "property uchar red\nproperty list uchar float weights\n" } else { "" };
        let vertex = format!(
            "element vertex {}\nproperty {coordinate} x\nproperty {coordinate} y\n{extra}property {coordinate} z\n",
            positions.len()
        );
        let face = format!("element face {}\n{extra}property list {count} {index} {list}\n", faces.len());
        let edge = "element edge 2\nproperty int a\nproperty int b\nelement nothing 7\n";
        let header = if more { [&face, edge, &vertex].concat() } else { [vertex, face].concat() };
        let mut out = format!("ply\nformat {format} 1.0\ncomment made by a test\n{header}end_header\n").into_bytes();
        let newline = |out: &mut Vec<u8>| {
            if format == "ascii" {
                out.push(b'\n')
            }
        };
        let extra = |out: &mut Vec<u8>| {
            if more {
                self.number("uchar", 200.0, out);
                self.number("uchar", 2.0, out);
                self.number("float", 0.5, out);
                self.number("float", -0.25, out);
            }
        };
        let write_faces = |out: &mut Vec<u8>| {
            for face in faces {
                extra(out);
                self.number(count, face.len() as f64, out);
                face.iter().for_each(|&corner| self.number(index, corner as f64, out));
                newline(out);
            }
        };
        if more {
            write_faces(&mut out);
            for _ in 0..2 {
                self.number("int", 0.0, &mut out);
                self.number("int", 1.0, &mut out);
                newline(&mut out);
            }
            (0..7).for_each(|_| newline(&mut out));
        }
        for position in positions {
            self.number(coordinate, position[0].into(), &mut out);
            self.number(coordinate, position[1].into(), &mut out);
            extra(&mut out);
            self.number(coordinate, position[2].into(), &mut out);
            newline(&mut out);
        }
        if !more {
            write_faces(&mut out);
        }
        out
    }
}

const FORMATS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];

#[test]
fn ply_is_exact() {
    let faces = TRIANGLES.map(|triangle| triangle.map(i64::from).to_vec());
    for format in FORMATS {
        for coordinate in ["float", "float32", "double", "float64"] {
            for more in [false, true] {
                let ply = Ply { format, coordinate, more, ..Ply::default() };
                // Text of a double has no exponent here, and the parser reads `1.0` and `1e0`, but not `1.`
                assert_exact(&read("a.ply", ply.bytes(&CORNERS, &faces)));
            }
        }
    }
}

#[test]
fn ply_index_types() {
    let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let faces = [vec![0, 1, 2], vec![3], vec![], vec![1, 2], vec![3, 0, 1, 2]];
    for format in FORMATS {
        for index in ["char", "uchar", "short", "ushort", "int", "uint", "int8", "uint8", "int16", "uint32"] {
            for (count, list) in [("uchar", "vertex_indices"), ("int", "vertex_index"), ("ushort", "vertex_index")] {
                let ply = Ply { format, count, index, list, ..Ply::default() };
                let file = read("a.ply", ply.bytes(&positions, &faces));
                assert_eq!(file.mesh.positions, positions);
                assert_eq!(file.mesh.triangles, [[0, 1, 2], [3, 0, 1], [3, 1, 2]]);
                assert_eq!(file.skipped_faces, 3);
            }
        }
        for coordinate in ["char", "short", "int"] {
            let file = read("a.ply", Ply { format, coordinate, ..Ply::default() }.bytes(&positions, &faces));
            assert_eq!(file.mesh.positions, positions);
        }
    }
}

#[test]
fn ply_header_variants() {
    let ascii = Ply { format: "ascii", ..Ply::default() };
    let text = String::from_utf8(ascii.bytes(&[[1.5; 3]; 3], &[vec![2, 1, 0]])).unwrap();
    for variant in
        [text.replace('\n', "\r\n"), text.replace(" float ", "\tfloat  "), text.replace("made", "obj_info é")]
    {
        let file = read("a.PLY", variant);
        assert_eq!(file.mesh, Mesh::new(vec![[1.5; 3]; 3], vec![[2, 1, 0]]));
    }
}

#[test]
fn bad_ply() {
    let positions = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 4.0, 0.0]];
    for format in FORMATS {
        let refuse = |faces: &[Vec<i64>]| refuse("bad.ply", Ply { format, ..Ply::default() }.bytes(&positions, faces));
        let good = || vec![0, 1, 2];
        assert_matches!(refuse(&[good(), vec![0, 1, 2, 3]]), MeshError::ConcaveFace { face: 2, corner: 3, .. });
        assert_matches!(
            refuse(&[good(), vec![0, 1, 4]]),
            MeshError::IndexOutOfRange { face: 2, index: 4, vertices: 4, .. }
        );
        assert_matches!(
            refuse(&[good(), good(), vec![-1, 1, 2]]),
            MeshError::IndexOutOfRange { face: 3, index: -1, vertices: 4, .. }
        );
        let bytes = Ply { format, ..Ply::default() }.bytes(&positions, &[good(), good()]);
        let cut = &bytes[..bytes.len() - if format == "ascii" { "3 0 1 2 \n".len() } else { 8 }];
        assert_matches!(
            self::refuse("bad.ply", cut),
            MeshError::Truncated { element, read: 1, promised: Some(2), .. } if element == "face"
        );
    }
    let ascii = Ply { format: "ascii", ..Ply::default() };
    let text = String::from_utf8(ascii.bytes(&positions, &[vec![0, 1, 2]])).unwrap();
    for (good, bad) in [
        ("ply\n", "plyx\n"),
        ("ascii", "asciii"),
        ("element vertex 4", "element vertex -4"),
        ("element vertex 4", "element vertex 99999999999999999999"),
        ("element vertex 4", "property int before\nelement vertex 4"),
        ("float x", "floaty x"),
        ("property float x\n", "property float x\nproperty float x\n"),
        ("element face", "element vertex"),
        ("0e0 0e0 0e0", "0e0 0e0"),
        ("0e0 0e0 0e0", "0e0 zero 0e0"),
        ("0e0 0e0 0e0", "0e0 nan 0e0"),
        ("3 0 1 2", "3 0 1"),
        ("3 0 1 2", "3 0 1 2.5"),
        ("3 0 1 2", "-3 0 1 2"),
        ("3 0 1 2", "3 0 1 99999999999"),
        ("3 0 1 2", "99999999999 0 1 2"),
    ] {
        assert!(text.contains(good), "{good}");
        assert_matches!(refuse("bad.ply", text.replacen(good, bad, 1)), MeshError::Syntax { .. });
    }
    for bad in [text.replace("float y", "float w"), text.replace("float y", "list uchar float y")] {
        assert_matches!(refuse("bad.ply", bad), MeshError::MissingProperty { element: "vertex", property: "y", .. });
    }
    for bad in [
        text.replace("vertex_indices", "indices"),
        text.replace("list uchar int", "int"),
        text.replace("list uchar int", "list uchar float"),
        text.replace("list uchar int", "list uchar double"),
    ] {
        assert_matches!(
            refuse("bad.ply", bad),
            MeshError::MissingProperty { element: "face", property: "vertex_indices", .. }
        );
    }
    assert_matches!(
        refuse("bad.ply", text.replace("element face", "element tristrips")),
        MeshError::MissingElement { element: "face", .. }
    );
    assert_matches!(
        refuse("bad.ply", text.replace("element vertex", "element point")),
        MeshError::MissingElement { element: "vertex", .. }
    );
    let no_end = text.split("end_header").next().unwrap();
    assert_matches!(refuse("bad.ply", no_end), MeshError::Truncated { element, .. } if element == "end_header");
    assert_matches!(refuse("bad.ply", ""), MeshError::Truncated { .. });
    let negative = Ply { count: "char", ..Ply::default() };
    let mut bytes = negative.bytes(&positions, &[vec![0, 1, 2]]);
    let at = bytes.len() - 13;
    bytes[at] = 0xfd;
    assert_matches!(refuse("bad.ply", bytes), MeshError::Malformed { element, number: 1, .. } if element == "face");
}

#[test]
fn counts_of_a_header_allocate_nothing() {
    for format in FORMATS {
        let text = String::from_utf8_lossy(&Ply { format, ..Ply::default() }.bytes(&[], &[])).into_owned();
        let bomb = |good: &str, bad: &str| refuse("bomb.ply", text.replace(good, bad));
        assert_matches!(
            bomb("vertex 0", "vertex 4000000000"),
            MeshError::Truncated { read: 0, promised: Some(4_000_000_000), .. }
        );
        assert_matches!(bomb("face 0", "face 4000000000"), MeshError::Truncated { element, .. } if element == "face");
        assert_matches!(bomb("vertex 0", "vertex 5000000000"), MeshError::TooLarge { count: 5_000_000_000, .. });
        assert_matches!(bomb("face 0", "face 18446744073709551615"), MeshError::TooLarge { count: u64::MAX, .. });
        let other = "element other 18446744073709551615\nproperty list uint int a\nelement face";
        assert_matches!(bomb("element face", other), MeshError::Truncated { element, .. } if element == "other");
        if format != "ascii" {
            // Elements of no bytes: as many as one likes, at once.
            read("empty.ply", text.replace("element face", "element other 18446744073709551615\nelement face"));
        }
    }
    let list = Ply { count: "uint", ..Ply::default() };
    let mut bytes = list.bytes(&[[0.0; 3]], &[vec![0, 0, 0]]);
    let at = bytes.len() - 16;
    bytes[at..at + 4].fill(0xff);
    assert_matches!(refuse("bomb.ply", bytes), MeshError::Truncated { element, read: 0, .. } if element == "face");
    let mut stl = binary_stl(b"", &[[[0.0; 3]; 3]]);
    stl[80..84].fill(0xff);
    assert_matches!(
        refuse("bomb.stl", stl),
        MeshError::Truncated { element, read: 1, promised: Some(0xffff_ffff), .. } if element == "triangle"
    );
}

fn binary_stl(name: &[u8], triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
    let mut out = name.to_vec();
    out.resize(80, b' ');
    out.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        out.extend([0; 12]);
        out.extend(triangle.iter().flatten().flat_map(|x| x.to_le_bytes()));
        out.extend([0x12, 0x34]);
    }
    out
}

fn text_stl(triangles: &[[[f32; 3]; 3]]) -> String {
    let mut out = "solid a\n".to_owned();
    for triangle in triangles {
        out += " facet normal 0 0 1\n  outer loop\n";
        for [x, y, z] in triangle {
            out += &format!("   vertex {x:e} {y:e} {z:e}\n");
        }
        out += "  endloop\n endfacet\n";
    }
    out + "endsolid a\n"
}

#[test]
fn stl_is_exact() {
    // In the order in which STL's corners first show them.
    let triangles = TRIANGLES.map(|triangle| triangle.map(|index| CORNERS[index as usize]));
    assert_exact(&read("a.stl", binary_stl(b"", &triangles)));
    assert_exact(&read("a.stl", binary_stl(b"solid of bytes", &triangles)));
    assert_exact(&read("a.stl", binary_stl(&[b'\n'; 80], &triangles)));
    let text = text_stl(&triangles);
    assert_exact(&read("a.stl", &text));
    assert_exact(&read("a.STL", text.replace('\n', "\r\n")));
    assert_exact(&read("a.stl", text.replace("solid a", "solid")));
    assert_exact(&read("a.stl", text.replace("normal 0 0 1", "normal -nan inf nan")));
    assert_exact(&read("a.stl", format!("\n\t{}\n\n", text.replace("solid a", "solid C:\\caf\u{e9}\\"))));
    let second = text.rfind(" facet").unwrap();
    assert_exact(&read("a.stl", format!("{}endsolid a\n\nsolid b\n{}", &text[..second], &text[second..])));
}

#[test]
fn stl_merges_equal_bits_only() {
    let triangle = [[0.0, 1.0, 2.0], [-0.0, 1.0, 2.0], [0.0, 1.0, 2.0]];
    for file in [read("a.stl", binary_stl(b"", &[triangle])), read("a.stl", text_stl(&[triangle]))] {
        assert_eq!(file.mesh.triangles, [[0, 1, 0]]);
        assert_eq!(file.mesh.positions[1][0].to_bits(), (-0.0_f32).to_bits());
    }
}

#[test]
fn bad_stl() {
    let triangles = TRIANGLES.map(|triangle| triangle.map(|index| CORNERS[index as usize]));
    let bytes = binary_stl(b"", &triangles);
    assert_matches!(refuse("bad.stl", ""), MeshError::Truncated { element, .. } if element == "header");
    assert_matches!(refuse("bad.stl", &bytes[..83]), MeshError::Truncated { element, .. } if element == "header");
    for cut in [84, 100, 84 + 149] {
        let read = (cut as u64 - 84) / 50;
        assert_matches!(
            refuse("bad.stl", &bytes[..cut]),
            MeshError::Truncated { read: found, promised: Some(3), .. } if *found == read
        );
    }
    let mut few = bytes.clone();
    few[80] = 2;
    assert_matches!(refuse("bad.stl", few), MeshError::FalseCount { count: 2, .. });
    let text = text_stl(&triangles);
    let whole = text.trim_end().strip_suffix("endsolid a").unwrap();
    assert_matches!(refuse("bad.stl", whole), MeshError::Truncated { read: 3, promised: None, .. });
    for (cut, found) in [("outer", 2), ("vertex", 2), ("endfacet", 2), (" facet", 2)] {
        let cut = &text[..text.rfind(cut).unwrap()];
        assert_matches!(refuse("bad.stl", cut), MeshError::Truncated { read, .. } if *read == found);
    }
    for (good, bad) in [
        ("outer", "inner"),
        ("vertex 5e0 6e0 7e0", "vertex 5e0 6e0"),
        ("vertex 5e0 6e0 7e0", "vertex 5e0 6e0 x"),
        ("vertex 5e0 6e0 7e0", "vertex 5e0 6e0 nan"),
        ("endloop\n", "vertex 0 0 0\nendloop\n"),
        ("   vertex", "endsolid a\n   vertex"),
        ("endloop", "endl\0oop"),
    ] {
        assert!(text.contains(good), "{good}");
        let bad = if bad.contains('\0') { text.repeat(9).replace(good, bad) } else { text.replacen(good, bad, 1) };
        assert!(
            matches!(refuse("bad.stl", &bad), MeshError::Syntax { line: 3.., .. } | MeshError::Truncated { .. }),
            "{bad}"
        );
    }
    assert_matches!(
        refuse("bad.stl", text.replacen("vertex 5e0 6e0 7e0", "vertex 5e0 6e0", 1)),
        MeshError::Syntax { line: 11, .. }
    );
}

#[test]
fn names_and_files() {
    let folder = folder();
    for name in ["a.txt", "a", "obj", ".obj", "a.obj.bak", "a.gz", "a.obj.gz.gz", "a.lwk"] {
        let error = load(&write(&folder, name, "v 0 0 0\n")).unwrap_err();
        assert_matches!(&error, MeshError::UnknownFormat { .. });
        let text = error.to_string();
        assert!([".obj", ".ply", ".stl", ".gz"].iter().all(|read| text.contains(read)), "{text}");
    }
    assert_matches!(load(&folder.path().join("none.obj")).unwrap_err(), MeshError::Io { .. });
    fs::create_dir(folder.path().join("folder.obj")).unwrap();
    assert_matches!(load(&folder.path().join("folder.obj")).unwrap_err(), MeshError::Io { .. });
}

#[test]
fn gzip_by_content_or_name() {
    let folder = folder();
    let text = "v 0 0 0\nf 1 1 1\n";
    let good = load(&write(&folder, "good.obj", text)).unwrap();
    assert_eq!(load(&write(&folder, "hidden.obj", gzip(text))).unwrap(), good);
    assert_eq!(load(&write(&folder, "a.OBJ.GZ", gzip(text))).unwrap(), good);
    let members = [gzip(&text[..9]), gzip(""), gzip(&text[9..])].concat();
    assert_eq!(load(&write(&folder, "members.obj.gz", members)).unwrap(), good);
    assert_matches!(load(&write(&folder, "plain.obj.gz", text)).unwrap_err(), MeshError::Gzip { .. });
    assert_matches!(load(&write(&folder, "empty.obj.gz", "")).unwrap_err(), MeshError::Gzip { .. });
    assert_matches!(load(&write(&folder, "twice.obj.gz", gzip(gzip(text)))).unwrap_err(), MeshError::NestedGzip { .. });
    for (name, bytes) in [
        ("cut.obj.gz", gzip(text.repeat(100_000))),
        ("cut.ply.gz", gzip(Ply::default().bytes(&vec![[1.0; 3]; 100_000], &[]))),
        ("cut.stl.gz", gzip(binary_stl(b"", &vec![[[1.0; 3]; 3]; 100_000]))),
        ("cut2.stl.gz", gzip(text_stl(&vec![[[1.0; 3]; 3]; 10_000]))),
    ] {
        load(&write(&folder, name, &bytes)).unwrap();
        for cut in [bytes.len() / 2, bytes.len() - 1] {
            assert_matches!(load(&write(&folder, name, &bytes[..cut])).map(drop), Err(MeshError::Gzip { .. }));
        }
        let mut damaged = bytes;
        let checksum = damaged.len() - 8;
        damaged[checksum] ^= 1;
        assert_matches!(load(&write(&folder, name, damaged)).map(drop), Err(MeshError::Gzip { .. }));
    }
}

#[test]
fn limits() {
    let folder = folder();
    let (obj, ply) = ("v 0 0 0\nf 1 1 1\n".to_owned(), Ply::default().bytes(&[[1.0; 3]; 9], &[]));
    let stl = [binary_stl(b"", &[[[1.0; 3]; 3]; 9]), text_stl(&[[[1.0; 3]; 3]; 9]).into_bytes()];
    for (name, bytes) in
        [("a.obj", obj.into_bytes()), ("a.ply", ply), ("a.stl", stl[0].clone()), ("b.stl", stl[1].clone())]
    {
        let size = bytes.len() as u64;
        let paths = [write(&folder, name, &bytes), write(&folder, &format!("{name}.gz"), gzip(&bytes))];
        for path in paths {
            let at_most = |max_bytes| load_with(&path, &Limits { max_bytes, ..Limits::default() });
            at_most(size).unwrap();
            at_most(u64::MAX).unwrap();
            for limit in [size - 1, size / 2, 1, 0] {
                assert_matches!(at_most(limit).unwrap_err(), MeshError::TooManyBytes { limit: found, .. } if *found == limit);
            }
        }
    }
}

#[test]
fn bombs_stop_at_the_limit() {
    let folder = folder();
    let limits = Limits { max_bytes: 1 << 20, ..Limits::default() };
    let bombs = [
        ("bomb.obj.gz", "#\n".repeat(4 << 20).into_bytes()),
        ("bomb.ply.gz", Ply::default().bytes(&vec![[1.0; 3]; 1 << 20], &[])),
        ("bomb.stl.gz", binary_stl(b"", &vec![[[1.0; 3]; 3]; 1 << 18])),
    ];
    for (name, bytes) in bombs {
        let path = write(&folder, name, gzip(bytes));
        assert_matches!(load_with(&path, &limits).unwrap_err(), MeshError::TooManyBytes { limit: 0x10_0000, .. });
    }
}

#[test]
fn long_lines_stop_at_the_limit() {
    let folder = folder();
    let long = "1 ".repeat(16 << 20);
    let header = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
                  element face 0\nproperty list int int vertex_indices\nend_header\n";
    for (name, text, line) in [
        ("a.obj.gz", format!("v 0 0 0\nf {long}"), 2),
        ("b.obj.gz", format!("v 0 0 0\nf 1 \\\n{}", "1 1 1 1 1 1 \\\n".repeat(2 << 20)), 0),
        ("a.ply.gz", format!("ply\ncomment {long}"), 2),
        ("b.ply.gz", format!("{header}{long}"), 10),
        ("a.stl.gz", format!("solid a\nfacet normal {long}"), 2),
    ] {
        let error = load(&write(&folder, name, gzip(text))).unwrap_err();
        assert_matches!(error, MeshError::LineTooLong { line: at, limit: 0x100_0000, .. } if line == 0 || *at == line);
    }
    let limits = Limits { max_line: 8, ..Limits::default() };
    let exact = |text: &str| load_with(&write(&folder, "c.obj", text), &limits);
    exact("v 0 0 0\nf 1 1 1\n").unwrap();
    exact("v 0 0 0\nf 1 1 1\r\n").map(drop).unwrap_err();
    let header = refuse("d.ply", format!("ply\n{}", "comment of a header without end\n".repeat(1 << 16)));
    assert_matches!(header, MeshError::Syntax { .. });
}

/// A hash that is good enough to choose bytes: the finaliser of MurmurHash3.
fn hash(x: u64) -> u64 {
    let x = (x ^ (x >> 33)).wrapping_mul(0xff51_afd7_ed55_8ccd);
    let x = (x ^ (x >> 33)).wrapping_mul(0xc4ce_b9fe_1a85_ec53);
    x ^ (x >> 33)
}

/// Every file cut off anywhere, and with bytes changed anywhere, is a mesh whose indices are in range or an error.
#[test]
fn damaged_files_are_meshes_or_errors() {
    let folder = folder();
    write(&folder, "a.mtl", "newmtl a\nKd 1 1 1\nKe 1 1 1\n");
    let faces = [vec![0, 1, 2], vec![0, 1, 2, 3], vec![3, 2]];
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let triangles = [[square[0], square[1], square[2]], [square[1], square[2], square[3]]];
    let obj =
        "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl a\nf 1 2 3 4\nusemtl b\nf -1/2 -2//3 1\nf 1 2\n";
    let ply = |format, more| Ply { format, more, ..Ply::default() }.bytes(&square, &faces);
    let obj = obj.as_bytes().to_vec();
    let stl = text_stl(&triangles).into_bytes();
    let seeds = [
        ("a.obj", obj.clone()),
        ("z.obj", gzip(obj)),
        ("a.ply", ply("ascii", true)),
        ("b.ply", ply("binary_little_endian", true)),
        ("c.ply", ply("binary_big_endian", false)),
        ("a.stl", binary_stl(b"solid", &triangles)),
        ("b.stl", stl),
    ];
    let mut read = 0;
    for (name, seed) in seeds {
        let mut check = |bytes: &[u8]| {
            if let Ok(MeshFile { mesh, materials, .. }) = load(&write(&folder, name, bytes)) {
                read += 1;
                assert!(mesh.triangles.iter().flatten().all(|&index| (index as usize) < mesh.positions.len()));
                assert!(mesh.material_ids.iter().all(|&id| (id as usize) < materials.len()));
                assert!(mesh.material_ids.is_empty() || mesh.material_ids.len() == mesh.triangles.len());
            }
        };
        for cut in 0..=seed.len() {
            check(&seed[..cut]);
        }
        for trial in 0..500 {
            let mut bytes = seed.clone();
            for change in 0..=hash(trial) % 3 {
                let (place, value) = (hash(trial * 8 + change + 1), hash(trial * 8 + change + 5));
                // Half of the changes copy a byte of the file: those stay closer to the format.
                let other = bytes[value as usize % bytes.len()];
                let at = place as usize % bytes.len();
                bytes[at] = if place >> 63 == 0 { other } else { (value >> 32) as u8 };
            }
            check(&bytes);
        }
    }
    assert!(read > 400, "{read}: hardly any damaged file was still a mesh, so this tests little");
}

/// Triangles and vertices of the scenes, as the table beside them counts.
const SCENES: [(&str, usize, usize); 16] = [
    ("bunny.ply.gz", 69_451, 35_947),
    ("dragon.ply.gz", 871_414, 437_645),
    ("dragon_res3.ply.gz", 47_794, 22_998),
    ("armadillo_100k.ply.gz", 99_976, 49_990),
    ("armadillo_346k_resampled.ply.gz", 345_944, 172_974),
    ("conference.obj.gz", 259_499, 148_232),
    ("sponza.obj.gz", 66_454, 39_999),
    ("CornellBox-Original.obj", 36, 72),
    ("CornellBox-Mirror.obj", 36, 72),
    ("CornellBox-Sphere.obj", 2_188, 1_116),
    ("CornellBox-Water.obj", 7_088, 3_666),
    ("CornellBox-Glossy.obj", 1_112, 578),
    ("CornellBox-Empty-CO.obj", 12, 24),
    ("CornellBox-Empty-RG.obj", 12, 24),
    ("CornellBox-Empty-White.obj", 12, 24),
    ("CornellBox-Empty-Squashed.obj", 12, 2_574),
];

fn mesh_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            mesh_files(&path, found);
        } else if [".obj", ".ply", ".stl"].iter().any(|format| name.trim_end_matches(".gz").ends_with(format)) {
            found.push(path);
        }
    }
}

#[test]
fn scenes_load() {
    let Some(scenes) = std::env::var_os("LEAFWALK_SCENES") else {
        println!("skipped: LEAFWALK_SCENES names no folder of scenes");
        return;
    };
    let mut found = Vec::new();
    mesh_files(Path::new(&scenes), &mut found);
    assert!(!found.is_empty(), "no mesh files in {scenes:?}");
    for path in found {
        let file = load(&path).unwrap();
        let name = path.file_name().unwrap().to_string_lossy();
        let counts = (file.mesh.triangles.len(), file.mesh.positions.len());
        match SCENES.iter().find(|scene| scene.0 == name) {
            Some(&(_, triangles, vertices)) => assert_eq!(counts, (triangles, vertices), "{name}"),
            None => println!("{name}: {counts:?} triangles and vertices, not in the table"),
        }
        assert_eq!(file.skipped_faces, 0, "{name}");
        assert!(file.missing_libraries.is_empty(), "{name}");
        let material = |id: u32| &file.materials[id as usize];
        let ids = &file.mesh.material_ids;
        if name.starts_with("CornellBox-") && !name.contains("Empty") {
            let lamps = ids.iter().filter(|&&id| material(id).emission != [0.0; 3]).count();
            assert!(lamps > 0, "{name}: no light");
        }
        if name == "CornellBox-Original.obj" {
            let left = Material { name: "leftWall".to_owned(), diffuse: [0.63, 0.065, 0.05], emission: [0.0; 3] };
            assert_eq!(ids.len(), file.mesh.triangles.len());
            assert_eq!(ids.iter().filter(|&&id| *material(id) == left).count(), 2);
            assert_eq!(ids.iter().filter(|&&id| material(id).emission == [17.0, 12.0, 4.0]).count(), 2);
        }
        if name == "conference.obj.gz" {
            assert_eq!((ids.len(), ids[0]), (259_499, 0));
            assert_eq!(material(0).diffuse, [0.639_216, 0.6, 0.607_843]);
        }
    }
}
