//! Real scenes.

use std::fs;
use std::path::{Path, PathBuf};

use leafwalk::load_mesh;
use leafwalk::mesh_file::Material;

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
    for entry in fs::read_dir(folder).expect("a folder of scenes") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a file").to_string_lossy().into_owned();
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
        let file = load_mesh(&path).expect("a file that can be read");
        let name = path.file_name().expect("a file that can be read").to_string_lossy();
        let mesh = file.mesh.as_f32().expect("coordinates that f32 holds");
        let counts = (mesh.triangles.len(), mesh.positions.len());
        match SCENES.iter().find(|scene| scene.0 == name) {
            Some(&(_, triangles, vertices)) => assert_eq!(counts, (triangles, vertices), "{name}"),
            None => println!("{name}: {counts:?} triangles and vertices, not in the table"),
        }
        assert_eq!(file.skipped_faces, 0, "{name}");
        assert!(file.missing_libraries.is_empty(), "{name}");
        let material = |id: u32| &file.materials[id as usize];
        let ids = &mesh.material_ids;
        if name.starts_with("CornellBox-") && !name.contains("Empty") {
            let lamps = ids.iter().filter(|&&id| material(id).emission != [0.0; 3]).count();
            assert!(lamps > 0, "{name}: no light");
        }
        if name == "CornellBox-Original.obj" {
            let left = Material { name: "leftWall".to_owned(), diffuse: [0.63, 0.065, 0.05], emission: [0.0; 3] };
            assert_eq!(ids.len(), mesh.triangles.len());
            assert_eq!(ids.iter().filter(|&&id| *material(id) == left).count(), 2);
            assert_eq!(ids.iter().filter(|&&id| material(id).emission == [17.0, 12.0, 4.0]).count(), 2);
        }
        if name == "conference.obj.gz" {
            assert_eq!((ids.len(), ids[0]), (259_499, 0));
            assert_eq!(material(0).diffuse, [0.639_216, 0.6, 0.607_843]);
        }
    }
}
