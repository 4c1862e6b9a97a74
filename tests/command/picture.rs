//! The pictures that the command draws, decoded and looked at.

use std::io::Cursor;

use leafwalk::Mesh;
use leafwalk_testing::meshes::icosphere;
use leafwalk_testing::shell::{Outcome, Shell, mesh_files, obj};

use super::shell;

/// A decoded picture.
#[derive(Debug, PartialEq)]
struct Picture {
    width: usize,
    pixels: Vec<[u8; 3]>,
}

impl Picture {
    fn decode(png: &[u8]) -> Self {
        let mut reader = png::Decoder::new(Cursor::new(png)).read_info().expect("a PNG");
        let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
        let info = reader.next_frame(&mut bytes).expect("whole pixels");
        assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Rgb, png::BitDepth::Eight));
        let pixels = bytes.chunks_exact(3).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        Self { width: info.width as usize, pixels }
    }

    fn size(&self) -> (usize, usize) {
        (self.width, self.pixels.len() / self.width)
    }

    fn at(&self, x: usize, y: usize) -> [u8; 3] {
        self.pixels[y * self.width + x]
    }

    /// The mean colour of a box of pixels.
    fn mean(&self, columns: core::ops::Range<usize>, rows: core::ops::Range<usize>) -> [f64; 3] {
        let pixels: Vec<_> = rows.flat_map(|y| columns.clone().map(move |x| (x, y))).collect();
        let sum = |k: usize| pixels.iter().map(|(x, y)| f64::from(self.at(*x, *y)[k])).sum::<f64>();
        [0, 1, 2].map(|k| sum(k) / pixels.len() as f64)
    }
}

fn shades() -> [&'static str; 5] {
    ["lit", "normal", "depth", "primitive", "cells"]
}

#[test]
fn the_default_picture_shows_the_room_and_is_the_same_for_any_number_of_threads() {
    let (one, two) = (shell(), shell());
    let start = |shell: &Shell, arguments: &str| shell.command(arguments).spawn().expect("the command starts");
    let runs = [start(&one, "--threads 1 --json"), start(&two, "--threads 2 --json")];
    let [report, _] = runs.map(|run| {
        let outcome = Outcome::of(run.wait_with_output().expect("the command ends"));
        outcome.assert_code(0);
        serde_json::from_str::<serde_json::Value>(&outcome.stdout).expect("a report")
    });
    assert_eq!(one.names(), ["leafwalk.png"]);
    assert!(one.read("leafwalk.png") == two.read("leafwalk.png"), "one and two threads draw different pictures");

    let picture = Picture::decode(&one.read("leafwalk.png"));
    assert_eq!(picture.size(), (960, 720));
    let [red, green, blue] = picture.mean(20..120, 250..450);
    assert!(red > 2.0 * green && red > 2.0 * blue, "no red wall on the left: {red} {green} {blue}");
    let [red, green, blue] = picture.mean(840..940, 150..250);
    assert!(green > 1.5 * red && green > 1.5 * blue, "no green wall on the right: {red} {green} {blue}");
    assert!(picture.mean(420..540, 10..50).iter().all(|c| *c > 250.0), "no light at the top");
    let [floor, shadow] = [picture.mean(250..350, 680..710), picture.mean(450..550, 700..712)];
    assert!(shadow[1] < 0.6 * floor[1], "no shadow under the bumpy sphere: {shadow:?} on {floor:?}");
    assert!(picture.pixels.iter().all(|pixel| pixel.iter().any(|c| *c > 8)), "a black pixel");

    assert!((50_000..=200_000).contains(&report["triangles"].as_u64().expect("a number")));
    // The room is closed.
    assert_eq!(report["primary_rays"], 4 * 960 * 720);
    assert_eq!(report["primary_hits"], report["primary_rays"]);
    assert_eq!(report["walked_rays"], 4096);
    assert!(report["rays"].as_u64().expect("a number") > 4 * 960 * 720);
    for name in ["mrays_per_s", "cells_per_ray", "blocks_per_ray", "build_seconds", "render_seconds"] {
        assert!(report[name].as_f64().expect("a number") > 0.0, "{name}: {report}");
    }
    assert_eq!(report["picture"], "leafwalk.png");
}

#[test]
fn a_mesh_and_its_octree_give_the_same_picture_in_every_shade() {
    let shell = shell();
    shell.write("sphere.obj", obj(&icosphere(4)));
    shell.run("build sphere.obj -o sphere.lwk").assert_code(0);
    for shade in shades() {
        let report = shell.json(&format!("render sphere.obj -o mesh.png --size 80x60 --shade {shade}"));
        shell.json(&format!("--threads 1 render sphere.lwk -o octree.png --size 80x60 --shade {shade}"));
        assert!(shell.read("mesh.png") == shell.read("octree.png"), "{shade}");
        let picture = Picture::decode(&shell.read("mesh.png"));
        assert_eq!(picture.size(), (80, 60));
        assert_ne!(picture.at(40, 30), picture.at(0, 0), "{shade}: nothing in the middle");
        let samples = if shade == "lit" { 4 } else { 1 };
        assert_eq!(report["primary_rays"], samples * 80 * 60, "{shade}");
        let hits = report["primary_hits"].as_u64().expect("a number");
        assert!((samples * 80 * 60 / 8..samples * 80 * 60).contains(&hits), "{shade}: {hits} hits");
        assert_eq!(report["picture"], "mesh.png");
    }
    assert_eq!(shell.names(), ["mesh.png", "octree.png", "sphere.lwk", "sphere.obj"]);
}

#[test]
fn the_work_of_the_walk_is_counted_on_a_sample_and_reported_as_the_walks() {
    let shell = shell();
    shell.write("sphere.obj", obj(&icosphere(4)));
    shell.run("build sphere.obj -o sphere.lwk").assert_code(0);
    let report = |size: &str, shade: &str| {
        let report = shell.json(&format!("render sphere.lwk -o out.png --size {size} --shade {shade}"));
        ["cells_per_ray", "blocks_per_ray", "walked_rays"].map(|name| report[name].as_f64().expect("a number"))
    };
    let [cells, blocks, walked] = report("80x60", "cells");
    assert!(cells > 1.0 && blocks > 0.1, "a test of nothing: {cells} cells and {blocks} blocks a ray");
    assert_eq!(walked, 80.0 * 60.0, "a picture of cells walks all rays");
    for shade in ["normal", "depth", "primitive", "lit"] {
        let sampled = report("80x60", shade);
        assert_eq!(sampled[2], 4096.0, "{shade}");
        let ratios = [sampled[0] / cells, sampled[1] / blocks];
        assert!(ratios.iter().all(|ratio| (0.95..1.05).contains(ratio)), "{shade}: {ratios:?} of all rays' work");
        assert_eq!(report("80x60", shade), sampled, "{shade}: another sample in another run");
    }
    assert_eq!(report("40x30", "normal"), report("40x30", "cells"), "fewer rays than a sample are walked all");

    let printed = |shade: &str| shell.run(&format!("render sphere.lwk -o out.png --size 40x30 --shade {shade}")).stdout;
    let (lit, cells) = (printed("lit"), printed("cells"));
    for line in ["walk: primary rays counted  4096\n", "walk: cells a ray ", "walk: block tests a ray ", "\nspeed  "] {
        assert!(lit.contains(line), "no `{line}` in {lit}");
    }
    for line in ["walk: primary rays counted  1200\n", "\nspeed of the walk  "] {
        assert!(cells.contains(line), "no `{line}` in {cells}");
    }
}

#[test]
fn shades_show_what_they_say() {
    let shell = shell();
    // A square that faces the camera at distance 4, and one behind it to the right at distance 6.
    shell.write(
        "squares.obj",
        "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\nv 1 -1 -2\nv 3 -1 -2\nv 3 1 -2\nv 1 1 -2\nf 5 6 7 8\n",
    );
    let draw = |shade: &str| {
        let camera = "--eye 0,0,4 --at 0,0,0 --fov 60 --size 60x60";
        let report = shell.json(&format!("render squares.obj -o out.png {camera} --shade {shade}"));
        (Picture::decode(&shell.read("out.png")), report)
    };
    let (near, far, outside) = ((30, 30), (48, 30), (5, 5));

    let (normals, _) = draw("normal");
    assert_eq!([near, far].map(|(x, y)| normals.at(x, y)), [[128, 128, 255]; 2]);
    assert_eq!(normals.at(outside.0, outside.1), [0; 3]);

    let (depths, report) = draw("depth");
    let at = |(x, y): (usize, usize)| depths.at(x, y)[0];
    assert!(at(near) > at(far) && at(far) > at(outside) && at(outside) == 0);
    let lowest = report["scale_lowest"].as_f64().expect("a number");
    assert!((lowest - 4.0).abs() < 0.01, "nearest at {lowest}, not 4");

    let (primitives, _) = draw("primitive");
    let colours: std::collections::BTreeSet<_> = primitives.pixels.iter().collect();
    assert_eq!(colours.len(), 4 + 1, "four triangles and the background");

    let (cells, report) = draw("cells");
    let brightest = cells.pixels.iter().map(|pixel| u32::from(pixel[1])).max();
    assert_eq!(brightest, Some(255), "no pixel at the end of the scale");
    assert!(report["scale_highest"].as_f64().expect("a number") >= 1.0);
}

#[test]
fn light_and_materials_of_the_mesh_are_shown() {
    let shell = shell();
    // A red floor, and a blue plate above its far part, which shades it.
    let floor = "usemtl red\nv -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nf 4 3 2 1\n";
    let plate = "usemtl blue\nv -2 1 -2\nv 0 1 -2\nv 0 1 2\nv -2 1 2\nf 8 7 6 5\n";
    shell.write("plate.obj", format!("mtllib plate.mtl\n{floor}{plate}"));
    shell.write("plate.mtl", "newmtl red\nKd 0.8 0.1 0.1\nnewmtl blue\nKd 0.1 0.1 0.8\n");
    let camera = "--eye 0,6,0.01 --at 0,0,0 --fov 50 --size 60x60";
    shell.json(&format!("render plate.obj -o out.png {camera}"));
    let picture = Picture::decode(&shell.read("out.png"));
    let is = |[x, y]: [usize; 2], k: usize| {
        let pixel = picture.at(x, y);
        (0..3).all(|other| other == k || pixel[k] > pixel[other].saturating_mul(2))
    };
    assert!(is([45, 30], 0), "the floor is not red: {:?}", picture.at(45, 30));
    assert!(is([15, 30], 2), "the plate is not blue: {:?}", picture.at(15, 30));
    // The light stands to the left of the camera: the plate's shadow falls to the right, beside its edge.
    let [lit, shaded] = [picture.at(50, 30)[0], picture.at(33, 30)[0]];
    assert!(f64::from(shaded) < 0.8 * f64::from(lit), "no shadow beside the plate: {shaded} beside {lit}");
}

#[test]
fn wrong_cameras_are_refused() {
    let shell = shell();
    shell.write("sphere.obj", obj(&icosphere(1)));
    let wrong = [
        "--size 0x10",
        "--size 10x0",
        "--size 99999x10",
        "--size 10",
        "--size 10x-3",
        "--size 4294967297x1",
        "--fov 0",
        "--fov -10",
        "--fov 180",
        "--fov nan",
        "--fov wide",
        "--eye 1,2",
        "--eye 1,2,3,4",
        "--at 1,x,3",
        "--eye nan,0,0",
        "--at inf,0,0",
        "--up 1e39,0,0",
        "--shade shiny",
    ];
    for arguments in wrong {
        let outcome = shell.run(&format!("render sphere.obj -o out.png {arguments}"));
        outcome.assert_code(2);
        assert!(outcome.stderr.contains("error: ") && outcome.stdout.is_empty(), "{arguments}: {outcome:?}");
        assert_eq!(shell.names(), ["sphere.obj"], "{arguments}");
    }
    let render = "render sphere.obj -o out.png --size 20x20";
    shell.assert_fails(&format!("{render} --eye 1,2,3 --at 1,2,3"), "(1, 2, 3) looks at its own place");
    shell.assert_fails(&format!("{render} --eye 0,5,0 --at 0,0,0"), "up (0, 1, 0) is zero or lies along");
    shell.assert_fails(&format!("{render} --up 0,0,0"), "up (0, 0, 0) is zero or lies along");
    shell.run(&format!("{render} --eye 0,5,0 --at 0,0,0 --up 0,0,-1")).assert_code(0);
    assert_eq!(shell.names(), ["out.png", "sphere.obj"]);
}

#[test]
fn failures_leave_nothing_behind() {
    let shell = shell();
    shell.write("sphere.obj", obj(&icosphere(1)));
    shell.write("broken.obj", "v 0 0 0\nf 1 2 3\n");
    shell.write("broken.lwk", b"lwok");
    shell.assert_fails("render sphere.obj -o missing/out.png", "missing/out.png");
    shell.assert_fails("render sphere.obj -o sphere.obj", "sphere.obj");
    shell.assert_fails("render sphere.obj -o .", ".");
    shell.assert_fails("render absent.obj -o out.png", "absent.obj");
    shell.assert_fails("render broken.obj -o out.png", "broken.obj");
    shell.assert_fails("render broken.lwk -o out.png", "broken.lwk");
    std::fs::create_dir(shell.path("leafwalk.png")).expect("a folder");
    shell.assert_fails("", "leafwalk.png");
}

#[test]
fn meshes_without_extent_are_drawn() {
    let shell = shell();
    let point = Mesh::new(vec![[3.0, 4.0, 5.0]; 3], vec![[0, 1, 2]]);
    let far = Mesh::new(vec![[1e30, 0.0, 0.0], [0.0, 1e30, 0.0], [0.0, 0.0, -1e30]], vec![[0, 1, 2]]);
    let tiny = Mesh::new(vec![[1e-30, 0.0, 0.0], [0.0, 1e-30, 0.0], [0.0, 0.0, 1e-30]], vec![[0, 1, 2]]);
    for (name, mesh, is_seen) in
        [("none", Mesh::default(), false), ("point", point, false), ("far", far, true), ("tiny", tiny, true)]
    {
        shell.write("mesh.obj", obj(&mesh));
        for shade in shades() {
            let report = shell.json(&format!("render mesh.obj -o out.png --size 32x24 --shade {shade}"));
            assert_eq!(Picture::decode(&shell.read("out.png")).size(), (32, 24));
            assert_eq!(report["primary_hits"].as_u64().expect("a number") > 0, is_seen, "{name} {shade}");
        }
    }
}

#[test]
fn real_scenes_fill_their_pictures() {
    let Some(folder) = std::env::var_os("LEAFWALK_SCENES") else {
        println!("skipped: LEAFWALK_SCENES is not set");
        return;
    };
    for file in mesh_files(folder.as_ref()) {
        let shell = shell();
        let mut command = shell.command("render --size 64x48 -o out.png --json");
        let outcome = Outcome::of(command.arg(&file).output().expect("the command starts"));
        outcome.assert_code(0);
        let report: serde_json::Value = serde_json::from_str(&outcome.stdout).expect("a report");
        let share = report["primary_hits"].as_f64().expect("a number") / (4.0 * 64.0 * 48.0);
        // A box seen from a corner covers about half of the picture that frames it.
        assert!((0.1..0.9).contains(&share), "{}: {share} of the picture", file.display());
    }
}
