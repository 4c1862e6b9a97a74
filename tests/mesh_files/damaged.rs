//! Damaged files.

use leafwalk::load_mesh;
use leafwalk::mesh_file::MeshFile;

use crate::files::{folder, gzip, write};
use crate::ply::Ply;
use crate::stl::{binary_stl, text_stl};

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
            if let Ok(MeshFile { mesh, materials, .. }) = load_mesh(write(&folder, name, bytes)) {
                read += 1;
                let mesh = mesh.into_f32();
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
