//! Names, folders and gzip.

use std::fs;

use leafwalk::load_mesh;
use leafwalk::mesh_file::MeshError;

use crate::files::{folder, gzip, write};
use crate::ply::Ply;
use crate::stl::{binary_stl, text_stl};

#[test]
fn names_and_files() {
    let folder = folder();
    for name in ["a.txt", "a", "obj", ".obj", "a.obj.bak", "a.gz", "a.obj.gz.gz", "a.lwk"] {
        let error = load_mesh(write(&folder, name, "v 0 0 0\n")).expect_err("a file that cannot be read");
        assert_matches!(&error, MeshError::UnknownFormat { .. });
        let text = error.to_string();
        assert!([".obj", ".ply", ".stl", ".gz"].iter().all(|read| text.contains(read)), "{text}");
    }
    assert_matches!(
        load_mesh(folder.path().join("none.obj")).expect_err("a file that cannot be read"),
        MeshError::Io { .. }
    );
    fs::create_dir(folder.path().join("folder.obj")).expect("a file that can be read");
    assert_matches!(
        load_mesh(folder.path().join("folder.obj")).expect_err("a file that cannot be read"),
        MeshError::Io { .. }
    );
}

#[test]
fn gzip_by_content_or_name() {
    let folder = folder();
    let text = "v 0 0 0\nf 1 1 1\n";
    let good = load_mesh(write(&folder, "good.obj", text)).expect("a file that can be read");
    assert_eq!(load_mesh(write(&folder, "hidden.obj", gzip(text))).expect("a file that can be read"), good);
    assert_eq!(load_mesh(write(&folder, "a.OBJ.GZ", gzip(text))).expect("a file that can be read"), good);
    let members = [gzip(&text[..9]), gzip(""), gzip(&text[9..])].concat();
    assert_eq!(load_mesh(write(&folder, "members.obj.gz", members)).expect("a file that can be read"), good);
    assert_matches!(
        load_mesh(write(&folder, "plain.obj.gz", text)).expect_err("a file that cannot be read"),
        MeshError::Gzip { .. }
    );
    assert_matches!(
        load_mesh(write(&folder, "empty.obj.gz", "")).expect_err("a file that cannot be read"),
        MeshError::Gzip { .. }
    );
    assert_matches!(
        load_mesh(write(&folder, "twice.obj.gz", gzip(gzip(text)))).expect_err("a file that cannot be read"),
        MeshError::NestedGzip { .. }
    );
    for (name, bytes) in [
        ("cut.obj.gz", gzip(text.repeat(100_000))),
        ("cut.ply.gz", gzip(Ply::default().bytes(&vec![[1.0; 3]; 100_000], &[]))),
        ("cut.stl.gz", gzip(binary_stl(b"", &vec![[[1.0; 3]; 3]; 100_000]))),
        ("cut2.stl.gz", gzip(text_stl(&vec![[[1.0; 3]; 3]; 10_000]))),
    ] {
        load_mesh(write(&folder, name, &bytes)).expect("a file that can be read");
        for cut in [bytes.len() / 2, bytes.len() - 1] {
            assert_matches!(load_mesh(write(&folder, name, &bytes[..cut])).map(drop), Err(MeshError::Gzip { .. }));
        }
        let mut damaged = bytes;
        let checksum = damaged.len() - 8;
        damaged[checksum] ^= 1;
        assert_matches!(load_mesh(write(&folder, name, damaged)).map(drop), Err(MeshError::Gzip { .. }));
    }
}
