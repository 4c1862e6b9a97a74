//! Material libraries beside OBJ files.

use std::fs;

use leafwalk::load_mesh;
use leafwalk::mesh_file::{Material, MeshError};

use crate::files::{folder, gzip, write};

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
    let file = load_mesh(&plain).expect("a file that can be read");
    assert_eq!(file.materials, expected);
    assert_eq!(file.mesh.material_ids(), [4, 1, 1, 5, 5, 0]);
    assert!(file.missing_libraries.is_empty());
    assert_eq!(load_mesh(&zipped).expect("a file that can be read"), file);

    fs::remove_file(folder.path().join("colors.mtl")).expect("a folder of ours");
    write(&folder, "colors.mtl.gz", gzip(mtl));
    assert_eq!(load_mesh(&plain).expect("a file that can be read"), file);
    assert_eq!(load_mesh(&zipped).expect("a file that can be read"), file);

    fs::remove_file(folder.path().join("colors.mtl.gz")).expect("a file that can be read");
    fs::create_dir(folder.path().join("colors.mtl")).expect("a file that can be read");
    let bare = load_mesh(&plain).expect("a file that can be read");
    let names: Vec<&str> = bare.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!(names, ["", "red wall", "unknown", "lamp"]);
    assert!(bare.materials.iter().all(|material| material.diffuse == [0.5; 3] && material.emission == [0.0; 3]));
    assert_eq!(bare.mesh.material_ids(), [0, 1, 1, 2, 2, 3]);
    assert_eq!(bare.missing_libraries, [folder.path().join("colors.mtl")]);
    assert_eq!(bare.mesh.triangles(), file.mesh.triangles());
}

#[test]
fn material_libraries_with_spaces_or_several() {
    let folder = folder();
    write(&folder, "my colors.mtl", "newmtl a\nKd 1 1 1\n");
    write(&folder, "b.mtl", "newmtl b\nKd 0 0 0\nnewmtl a\nKd 0 1 0\n");
    let obj = "mtllib\tmy colors.mtl\nmtllib b.mtl none.mtl\nv 0 0 0\nusemtl b\nf 1 1 1\n";
    let file = load_mesh(write(&folder, "a.obj", obj)).expect("a file that can be read");
    let found: Vec<_> = file.materials.iter().map(|material| (material.name.as_str(), material.diffuse)).collect();
    assert_eq!(found, [("a", [0.0, 1.0, 0.0]), ("b", [0.0; 3])]);
    assert_eq!(file.mesh.material_ids(), [1]);
    assert_eq!(file.missing_libraries, [folder.path().join("none.mtl")]);
    let plain = load_mesh(write(&folder, "c.obj", obj.replace("usemtl b\n", ""))).expect("a file that can be read");
    assert!(plain.materials.is_empty() && plain.mesh.material_ids().is_empty());
}

#[test]
fn bad_material_libraries_name_their_own_file() {
    let folder = folder();
    let obj = write(&folder, "a.obj", "mtllib a.mtl\nv 0 0 0\nusemtl a\nf 1 1 1\n");
    let mtl = write(&folder, "a.mtl", "newmtl a\nnewmtl\nKd 1 1 1\n");
    let error = load_mesh(&obj).expect_err("a file that cannot be read");
    assert_matches!(&error, MeshError::Syntax { line: 2, .. });
    assert_eq!(error.path(), mtl);
    write(&folder, "a.mtl", "newmtl \0");
    assert_matches!(load_mesh(&obj).expect_err("a file that cannot be read"), MeshError::Syntax { line: 1, .. });
    write(&folder, "a.mtl", &gzip("newmtl a\nKd 1 1 1\n")[..20]);
    assert_matches!(load_mesh(&obj).expect_err("a file that cannot be read"), MeshError::Gzip { path, .. } if *path == mtl);
}
