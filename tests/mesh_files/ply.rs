//! PLY files.

use std::io::Write as _;

use leafwalk::Mesh;
use leafwalk::mesh_file::MeshError;

use crate::exact::{CORNERS, TRIANGLES, assert_exact};
use crate::files::{f32_mesh, read, refuse};

/// How a PLY file is written.
#[derive(Clone, Copy)]
pub(crate) struct Ply {
    pub(crate) format: &'static str,
    pub(crate) coordinate: &'static str,
    pub(crate) count: &'static str,
    pub(crate) index: &'static str,
    pub(crate) list: &'static str,
    /// Normals, colours, edges and lists that a mesh does not need, and faces before vertices.
    pub(crate) more: bool,
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
            _ if self.format == "ascii" && kind == "float" => {
                return write!(out, "{:e} ", value as f32).expect("room in memory");
            }
            _ if self.format == "ascii" => return write!(out, "{value} ").expect("room in memory"),
            "char" | "int8" | "uchar" | "uint8" => (integer as u8).to_le_bytes().to_vec(),
            "short" | "int16" | "ushort" | "uint16" => (integer as u16).to_le_bytes().to_vec(),
            "int" | "int32" | "uint" | "uint32" => (integer as u32).to_le_bytes().to_vec(),
            "float" | "float32" => (value as f32).to_le_bytes().to_vec(),
            _ => value.to_le_bytes().to_vec(),
        };
        if self.format == "binary_big_endian" { out.extend(little.iter().rev()) } else { out.extend(little) }
    }

    pub(crate) fn bytes(&self, positions: &[[f32; 3]], faces: &[Vec<i64>]) -> Vec<u8> {
        let positions: Vec<_> = positions.iter().map(|position| position.map(f64::from)).collect();
        self.bytes_f64(&positions, faces)
    }

    pub(crate) fn bytes_f64(&self, positions: &[[f64; 3]], faces: &[Vec<i64>]) -> Vec<u8> {
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
            self.number(coordinate, position[0], &mut out);
            self.number(coordinate, position[1], &mut out);
            extra(&mut out);
            self.number(coordinate, position[2], &mut out);
            newline(&mut out);
        }
        if !more {
            write_faces(&mut out);
        }
        out
    }
}

pub(crate) const FORMATS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];

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
                assert_eq!(f32_mesh(&file).positions, positions);
                assert_eq!(file.mesh.triangles(), [[0, 1, 2], [3, 0, 1], [3, 1, 2]]);
                assert_eq!(file.skipped_faces, 3);
            }
        }
        for coordinate in ["char", "short", "int"] {
            let file = read("a.ply", Ply { format, coordinate, ..Ply::default() }.bytes(&positions, &faces));
            assert_eq!(f32_mesh(&file).positions, positions);
        }
    }
}

#[test]
fn ply_header_variants() {
    let ascii = Ply { format: "ascii", ..Ply::default() };
    let text = String::from_utf8(ascii.bytes(&[[1.5; 3]; 3], &[vec![2, 1, 0]])).expect("text");
    for variant in
        [text.replace('\n', "\r\n"), text.replace(" float ", "\tfloat  "), text.replace("made", "obj_info é")]
    {
        let file = read("a.PLY", variant);
        assert_eq!(*f32_mesh(&file), Mesh::new(vec![[1.5; 3]; 3], vec![[2, 1, 0]]));
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
    let text = String::from_utf8(ascii.bytes(&positions, &[vec![0, 1, 2]])).expect("text");
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
    let no_end = text.split("end_header").next().expect("a header");
    assert_matches!(refuse("bad.ply", no_end), MeshError::Truncated { element, .. } if element == "end_header");
    assert_matches!(refuse("bad.ply", ""), MeshError::Truncated { .. });
    let negative = Ply { count: "char", ..Ply::default() };
    let mut bytes = negative.bytes(&positions, &[vec![0, 1, 2]]);
    let at = bytes.len() - 13;
    bytes[at] = 0xfd;
    assert_matches!(refuse("bad.ply", bytes), MeshError::Malformed { element, number: 1, .. } if element == "face");
}
