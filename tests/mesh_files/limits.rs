//! Files that claim or hold too much.

use leafwalk::mesh_file::{Limits, MeshError};
use leafwalk::{load_mesh, load_mesh_with_limits};

use crate::files::{folder, gzip, read, refuse, write};
use crate::ply::{FORMATS, Ply};
use crate::stl::{binary_stl, text_stl};

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
            let at_most = |max_bytes| load_mesh_with_limits(&path, &Limits { max_bytes, ..Limits::default() });
            at_most(size).expect("a file that can be read");
            at_most(u64::MAX).expect("a file that can be read");
            for limit in [size - 1, size / 2, 1, 0] {
                assert_matches!(at_most(limit).expect_err("a file that cannot be read"), MeshError::TooManyBytes { limit: found, .. } if *found == limit);
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
        assert_matches!(
            load_mesh_with_limits(&path, &limits).expect_err("a file that cannot be read"),
            MeshError::TooManyBytes { limit: 0x10_0000, .. }
        );
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
        let error = load_mesh(write(&folder, name, gzip(text))).expect_err("a file that cannot be read");
        assert_matches!(error, MeshError::LineTooLong { line: at, limit: 0x100_0000, .. } if line == 0 || *at == line);
    }
    let limits = Limits { max_line: 8, ..Limits::default() };
    let exact = |text: &str| load_mesh_with_limits(write(&folder, "c.obj", text), &limits);
    exact("v 0 0 0\nf 1 1 1\n").expect("a file that can be read");
    exact("v 0 0 0\nf 1 1 1\r\n").map(drop).expect_err("a file that cannot be read");
    let header = refuse("d.ply", format!("ply\n{}", "comment of a header without end\n".repeat(1 << 16)));
    assert_matches!(header, MeshError::Syntax { .. });
}
