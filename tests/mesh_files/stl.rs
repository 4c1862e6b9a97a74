//! STL files.

use leafwalk::mesh_file::MeshError;

use crate::exact::{CORNERS, TRIANGLES, assert_exact};
use crate::files::{f32_mesh, read, refuse};

pub(crate) fn binary_stl(name: &[u8], triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
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

pub(crate) fn text_stl(triangles: &[[[f32; 3]; 3]]) -> String {
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
    let second = text.rfind(" facet").expect("a facet");
    assert_exact(&read("a.stl", format!("{}endsolid a\n\nsolid b\n{}", &text[..second], &text[second..])));
}

#[test]
fn stl_merges_equal_bits_only() {
    let triangle = [[0.0, 1.0, 2.0], [-0.0, 1.0, 2.0], [0.0, 1.0, 2.0]];
    for file in [read("a.stl", binary_stl(b"", &[triangle])), read("a.stl", text_stl(&[triangle]))] {
        assert_eq!(file.mesh.triangles(), [[0, 1, 0]]);
        assert_eq!(f32_mesh(&file).positions[1][0].to_bits(), (-0.0_f32).to_bits());
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
    let whole = text.trim_end().strip_suffix("endsolid a").expect("its last line");
    assert_matches!(refuse("bad.stl", whole), MeshError::Truncated { read: 3, promised: None, .. });
    for (cut, found) in [("outer", 2), ("vertex", 2), ("endfacet", 2), (" facet", 2)] {
        let cut = &text[..text.rfind(cut).expect("a word of the text")];
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
