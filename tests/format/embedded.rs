//! The file in the example `embedded` is what the builder makes of a hill.

use std::path::Path;
use std::{env, fs};

use leafwalk::{Builder, Mesh, write_octree};

/// Squares along each side of the hill.
const SIDE: u32 = 8;

/// Ground with a point every 100 metres; the y axis points up.
fn hill() -> Mesh {
    let mut mesh = Mesh::default();
    for z in 0..=SIDE {
        for x in 0..=SIDE {
            let (rise, bumps) = (x * (SIDE - x) * z * (SIDE - z), (5 * x + 3 * z) % 4);
            mesh.positions.push([100.0 * x as f32, rise as f32 + 5.0 * bumps as f32, 100.0 * z as f32]);
        }
    }
    for z in 0..SIDE {
        for x in 0..SIDE {
            let near = z * (SIDE + 1) + x;
            let far = near + SIDE + 1;
            mesh.triangles.extend([[near, far, far + 1], [near, far + 1, near + 1]]);
        }
    }
    mesh
}

/// After a change of the builder that changes the words, this test writes the file anew where the environment variable
/// LEAFWALK_WRITE_EMBEDDED is set.
#[test]
fn the_embedded_file_is_what_the_builder_makes() {
    let octree = Builder::for_walks().compact().build(&hill()).expect("a mesh that builds");
    let mut bytes = Vec::new();
    write_octree(&octree, &mut bytes).expect("a vector takes all");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/embedded.lwk");
    if env::var_os("LEAFWALK_WRITE_EMBEDDED").is_some() {
        fs::write(&path, &bytes).expect("a folder that can be written to");
    }
    let committed = fs::read(&path).expect("the file of the example");
    assert!(committed == bytes, "examples/embedded.lwk is out of date: run this test with LEAFWALK_WRITE_EMBEDDED=1");
}
