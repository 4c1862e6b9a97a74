//! `Bsp` is bounded whatever the mesh, and needs its margin.

use glam::Vec3;
use leafwalk::Mesh;
use leafwalk::structures::bsp::Settings;
use leafwalk::structures::{Bsp, Exact, Line, Scene, Structure, Traced};
use leafwalk_testing::meshes;
use leafwalk_testing::random::Random;

use crate::comparison::{compare, endures, leads, needs_margin};

#[test]
fn same_answer_with_planes_on_edges() {
    compare::<Bsp>("planes of triangles and on their edges", &Settings::default());
}

#[test]
fn same_answer_with_planes_of_triangles() {
    compare::<Bsp>("planes of triangles", &Settings::own_planes_only());
}

#[test]
fn the_margin_is_missed() {
    needs_margin::<Bsp>("planes of triangles", &Settings::default());
}

#[test]
fn no_number_leads_astray() {
    endures::<Bsp>(&Settings::default());
}

/// Many triangles in one place, needles, walls through one another, and triangles that no plane keeps apart.
fn unruly() -> Vec<(&'static str, Mesh)> {
    let one = meshes::soup(1, 100);
    let heap = Mesh { triangles: vec![one.triangles[0]; 3000], ..one };
    let fan = Mesh::new(
        (0..=2000)
            .map(|i| [0.0, (i as f32 * 0.003).cos(), (i as f32 * 0.003).sin()])
            .chain([[1.0, 0.0, 0.0]])
            .collect(),
        (0..2000).map(|i| [i, i + 1, 2001]).collect(),
    );
    vec![
        ("heap", heap),
        ("fan", fan),
        ("needles", meshes::needle_box(400)),
        ("shards", meshes::shards(3000, 0.5..1.0, 1000.0, 101)),
        ("walls", meshes::walls(500, 102)),
    ]
}

#[test]
fn memory_is_bounded() {
    for settings in [Settings::default(), Settings::own_planes_only()] {
        for (name, mesh) in unruly() {
            let traced = Traced::<Bsp, Exact>::conservative(&mesh, &settings).expect("a mesh that builds");
            let (listed, all) = (traced.structure().listed().len(), mesh.triangles.len());
            eprintln!("{name}, {settings:?}: {all} triangles, {listed} listed, {} bytes", traced.structure().bytes());
            assert!(listed <= (1 + settings.copies) * all, "{name}, {settings:?}: {listed} of {all}");
        }
    }
}

/// A plane takes what lies in it off both sides: a heap of one triangle is a node with two empty children.
#[test]
fn what_lies_in_a_plane_is_listed_once() {
    let (_, heap) = unruly().swap_remove(0);
    let traced = Traced::<Bsp, Exact>::conservative(&heap, &Settings::default()).expect("a mesh that builds");
    assert_eq!(traced.structure().listed().len(), heap.triangles.len());
}

/// Neither building nor a line minds numbers of any kind; and every triangle is listed.
#[test]
fn no_number_is_too_wild() {
    let numbers = [0.0, -0.0, 1.0, -3.0, 2.0, 1e-38, 1e-45, 1e30, -f32::MAX, f32::INFINITY, f32::NAN];
    // All, those without NaN, those without infinity as well, and moderate ones.
    for count in [11, 10, 9, 5] {
        for index in 0..200 {
            let mut random = Random::new(104, index);
            let mut point = || Vec3::from([(); 3].map(|()| numbers[random.below(count)]));
            let scene = Scene { corners: (0..60).map(|_| [point(), point(), point()]).collect(), margin: 0.0 };
            let bsp = Bsp::build(&scene, &Settings::default());
            let mut found = bsp.listed().to_vec();
            found.sort_unstable();
            found.dedup();
            assert_eq!(found.len(), scene.len(), "{scene:?}");
            for _ in 0..20 {
                let [origin, direction, limits] = [point(), point(), point()];
                let line = Line::new(origin.into(), direction.into(), limits.x, limits.y);
                leads(&bsp, &line);
            }
        }
    }
}
