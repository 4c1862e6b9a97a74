//! The command `leafwalk` as a user meets it: what it prints, what it leaves behind, and how it ends.
#![cfg(feature = "cli")]

#[cfg(unix)]
mod interrupts;
mod picture;
mod rays;

use leafwalk::wire::checksum;
use leafwalk::{Builder, Octree};
use leafwalk_core::layout::Section;
use leafwalk_testing::meshes::{bumpy_sphere, icosphere, soup};
use leafwalk_testing::shell::{Outcome, Shell, mesh_files, obj};

/// Rays from all sides at a unit sphere, and one that is invalid.
const RAYS: &str = "0,0,0,1,0,0\n3,0.1,0,-1,0,0\n0,9,0,0,1,0\n0,0,0,0,0,0\n";

/// An empty folder for the command of this build.
fn shell() -> Shell {
    Shell::new(env!("CARGO_BIN_EXE_leafwalk"))
}

fn with_sphere() -> Shell {
    let shell = shell();
    shell.write("sphere.obj", obj(&bumpy_sphere(3, 1)));
    shell.write("rays.csv", RAYS);
    shell
}

fn with_octree() -> Shell {
    let shell = with_sphere();
    shell.run("build sphere.obj -o sphere.lwk").assert_code(0);
    shell
}

#[test]
fn a_mesh_is_built_looked_into_verified_and_traced() {
    let shell = with_sphere();
    let mesh = bumpy_sphere(3, 1);
    let octree = Builder::new().build(&mesh).expect("a mesh that can be built");
    let bytes = size_of_val(octree.as_words());

    let built = shell.json("build sphere.obj -o sphere.lwk");
    assert_eq!(built["triangles"], mesh.triangles.len());
    assert_eq!(built["dropped"], 0);
    assert_eq!(built["leaves"], octree.stats().leaves);
    assert_eq!(built["blocks"], octree.stats().blocks);
    assert_eq!(built["bytes"], bytes);
    assert_eq!(built["bytes_per_triangle"], bytes as f64 / mesh.triangles.len() as f64);
    assert!(built["build_seconds"].as_f64().is_some_and(|seconds| seconds > 0.0));
    let loaded = leafwalk::load_octree(shell.path("sphere.lwk")).expect("a file that was just built");
    assert!(loaded.as_words() == octree.as_words(), "the file holds other words than the library builds");

    let info = shell.json("info sphere.lwk");
    assert_eq!(info["version"], octree.as_words()[1]);
    assert_eq!(info["checksum"], format!("{:08x}", checksum(octree.as_words())));
    let leaves = info["leaves_at_level"].as_array().expect("a list").iter().filter_map(|leaves| leaves.as_u64());
    assert_eq!(leaves.sum::<u64>(), u64::from(octree.stats().leaves));
    let leaves = info["leaves_by_entries"].as_array().expect("a list").iter().filter_map(|leaves| leaves.as_u64());
    assert_eq!(leaves.sum::<u64>(), u64::from(octree.stats().leaves));
    assert_eq!(info["frame_edge"], octree.parts().frame.scale());
    let sections = info["sections"].as_array().expect("a list");
    assert_eq!(sections.len(), Section::ALL.len());
    for (section, printed) in Section::ALL.into_iter().zip(sections) {
        let (offset, words) = octree.span(section);
        assert_eq!((&printed["offset"], &printed["bytes"]), (&(4 * offset).into(), &(4 * words).into()));
    }

    let verified = shell.json("verify sphere.lwk sphere.obj");
    assert_eq!(verified["triangles"], mesh.triangles.len());

    let traced = shell.json("trace sphere.lwk rays.csv -o hits.csv");
    assert_eq!([&traced["rays"], &traced["hits"], &traced["misses"], &traced["invalid"]], [4, 2, 2, 1]);
    assert_eq!(traced["backend"], "cpu");
    assert_eq!(traced.as_object().map(|members| members.len()), Some(7));
    assert_eq!(shell.names(), ["hits.csv", "rays.csv", "sphere.lwk", "sphere.obj"]);
}

#[test]
fn reports_are_text_unless_quiet() {
    let shell = with_sphere();
    let told = shell.run("build sphere.obj -o sphere.lwk --threads 1");
    told.assert_code(0);
    assert!(told.stdout.contains("bytes a triangle") && told.stderr.is_empty(), "{told:?}");
    for quiet in ["build sphere.obj -o other.lwk --quiet", "info -q sphere.lwk", "--quiet verify sphere.lwk"] {
        let quiet = shell.run(quiet);
        quiet.assert_code(0);
        assert!(quiet.stdout.is_empty() && quiet.stderr.is_empty(), "{quiet:?}");
    }
    assert_eq!(shell.read("sphere.lwk"), shell.read("other.lwk"), "threads change the file");
}

#[test]
fn settings_reach_the_builder() {
    let shell = with_sphere();
    let flat = shell.json("build sphere.obj -o flat.lwk --max-level 1 --budget 2.5");
    assert_eq!(flat["leaves"], 8);
    assert_eq!(shell.json("info flat.lwk")["max_level"], 1);
    let fine = shell.json("build sphere.obj -o fine.lwk --step-cost 1.5");
    assert!(fine["leaves"].as_u64() > Some(8), "{fine}");
    assert_eq!(shell.json("info fine.lwk")["step_cost"], 1.5);
    shell.json("build sphere.obj -o walks.lwk --for-walks");
    assert_eq!(shell.json("info walks.lwk")["step_cost"], 64.0);
    shell.assert_fails("build sphere.obj -o small.lwk --memory-limit 1000", "1000");
}

#[test]
fn a_compact_octree_answers_as_a_packed_one() {
    let shell = with_octree();
    let packed = shell.json("info sphere.lwk");
    let built = shell.json("build sphere.obj -o compact.lwk --compact");
    let compact = shell.json("info compact.lwk");
    assert_eq!((&packed["compact"], &compact["compact"]), (&false.into(), &true.into()));
    assert_eq!((&compact["triangles"], &compact["blocks"]), (&packed["triangles"], &packed["blocks"]));
    let bytes = [&compact, &packed].map(|info| info["bytes"].as_u64().expect("a number"));
    assert!(5 * bytes[0] < 3 * bytes[1] && built["bytes"] == bytes[0], "{bytes:?}");

    assert_eq!(shell.json("verify compact.lwk sphere.obj")["triangles"], packed["triangles"]);
    shell.run("trace sphere.lwk rays.csv -o packed.csv").assert_code(0);
    shell.run("trace compact.lwk rays.csv -o compact.csv").assert_code(0);
    assert_eq!(shell.read("packed.csv"), shell.read("compact.csv"));
    shell.run("render sphere.lwk -o packed.png --size 64x48").assert_code(0);
    shell.run("render compact.lwk -o compact.png --size 64x48").assert_code(0);
    assert_eq!(shell.read("packed.png"), shell.read("compact.png"));
}

#[test]
fn lost_detail_is_warned_of() {
    let shell = shell();
    // The corners of the second triangle are too near to 0 for the size of the first.
    shell.write(
        "two.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0.5 0.5 0\nv 0.5 0.5 1e-30\nv 0.5 0.5 2e-30\nf 1 2 3\nf 4 5 6\n",
    );
    let outcome = shell.run("build two.obj -o two.lwk");
    outcome.assert_code(0);
    assert!(outcome.stderr.contains("detail lost: 1 triangle"), "{outcome:?}");
}

#[test]
fn damaged_files_are_refused() {
    let shell = with_octree();
    let whole = shell.read("sphere.lwk");
    let uses = |name: &str| {
        [format!("info {name}"), format!("verify {name} sphere.obj"), format!("trace {name} rays.csv -o hits.npy")]
    };
    let damaged: [(&str, Vec<u8>, &str); 8] = [
        ("empty.lwk", Vec::new(), "0 words"),
        ("short.lwk", whole[..12].to_vec(), "3 words"),
        ("cut.lwk", whole[..whole.len() / 8 * 4].to_vec(), "it is cut"),
        ("ragged.lwk", whole[..whole.len() - 3].to_vec(), "4-byte words"),
        ("flipped.lwk", flipped(&whole, whole.len() / 2), "checksum"),
        ("magic.lwk", flipped(&whole, 0), "this is no leafwalk octree"),
        ("version.lwk", flipped(&whole, 4), "format version"),
        ("appended.lwk", [whole.as_slice(), &[0; 4 << 20]].concat(), "something was appended"),
    ];
    for (name, bytes, reason) in &damaged {
        shell.write(name, bytes);
        uses(name).iter().for_each(|arguments| shell.assert_fails(arguments, reason));
    }
    // With a true checksum it is the validation that notices.
    let mut words = leafwalk::load_octree(shell.path("sphere.lwk")).expect("the whole file").into_words();
    let records = Octree::from_words(words.as_slice()).expect("a whole octree").span(Section::Records).0;
    words[records as usize + 1] ^= 1;
    words[3] = checksum(&words);
    shell.write("forged.lwk", words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>());
    shell.assert_fails("info forged.lwk", "record 0");
    for arguments in uses("absent.lwk") {
        shell.assert_fails(&arguments, "absent.lwk: ");
    }
}

#[test]
fn huge_files_cost_neither_time_nor_memory() {
    let shell = with_octree();
    shell.write("other.lwk", "something else");
    for (name, reason) in [("other.lwk", "this is no leafwalk octree"), ("sphere.lwk", "something was appended")] {
        let file = std::fs::File::options().write(true).open(shell.path(name)).expect("a file of ours");
        file.set_len(1 << 40).expect("room for a sparse file");
        let outcome = shell.run(&format!("info {name}"));
        outcome.assert_code(1);
        assert!(outcome.stderr.contains(reason), "{outcome:?}");
    }
}

fn flipped(bytes: &[u8], at: usize) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    bytes[at] ^= 0x10;
    bytes
}

#[test]
fn another_mesh_is_told_from_the_one_built() {
    let shell = with_octree();
    shell.write("other.obj", obj(&bumpy_sphere(3, 2)));
    shell.write("coarse.obj", obj(&icosphere(2)));
    shell.assert_fails("verify sphere.lwk other.obj", "sphere.lwk: built from another mesh");
    shell.assert_fails("verify sphere.lwk coarse.obj", "number of triangles");
}

#[test]
fn bad_meshes_are_refused() {
    let shell = shell();
    shell.write("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
    shell.write("infinite.obj", "v 0 0 0\nv 1 0 0\nv 0 1e39 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n");
    shell.write("mesh.xyz", "0 0 0\n");
    shell.assert_fails("build index.obj -o out.lwk", "index.obj");
    shell.assert_fails("build infinite.obj -o out.lwk", "vertex 2");
    shell.assert_fails("build mesh.xyz -o out.lwk", "mesh.xyz: unknown format");
    shell.assert_fails("build absent.obj -o out.lwk", "absent.obj");
    shell.assert_fails("verify absent.lwk absent.obj", "absent.lwk");
    let lenient = shell.json("build infinite.obj -o out.lwk --lenient");
    assert_eq!([&lenient["triangles"], &lenient["dropped"]], [2, 1]);
}

#[test]
fn outputs_that_cannot_be_written_are_refused() {
    let shell = with_octree();
    std::fs::create_dir(shell.path("folder.lwk")).expect("a folder");
    std::fs::create_dir(shell.path("folder.npy")).expect("a folder");
    shell.assert_fails("build sphere.obj -o absent/out.lwk", "absent/out.lwk: cannot be written");
    shell.assert_fails("build sphere.obj -o folder.lwk", "folder.lwk: cannot be written");
    shell.assert_fails("trace sphere.lwk rays.csv -o absent/hits.npy", "absent/hits.npy: cannot be written");
    shell.assert_fails("trace sphere.lwk rays.csv -o folder.npy", "folder.npy: cannot be written");
    shell.assert_fails("trace sphere.lwk rays.csv -o rays.csv", "rays.csv: is an input");
    shell.assert_fails("trace sphere.lwk rays.csv -o ./rays.csv", "rays.csv: is an input");

    let mut permissions = shell.path("sphere.lwk").metadata().expect("a file").permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(shell.path("sphere.lwk"), permissions).expect("a file of ours");
    shell.assert_fails("build sphere.obj -o sphere.lwk", "sphere.lwk: cannot be written");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told_and_links_are_followed() {
    let shell = with_octree();
    std::os::unix::fs::symlink("/dev/full", shell.path("full.lwk")).expect("a link");
    std::os::unix::fs::symlink("sphere.lwk", shell.path("link.lwk")).expect("a link");
    shell.assert_fails("build sphere.obj -o full.lwk", "full.lwk: cannot be written");
    shell.run("build sphere.obj -o link.lwk --max-level 0").assert_code(0);
    assert!(shell.path("link.lwk").is_symlink());
    assert_eq!(shell.json("info sphere.lwk")["leaves"], 1);
}

#[cfg(unix)]
#[test]
fn outputs_get_the_permissions_of_new_files_and_keep_those_they_had() {
    use std::os::unix::fs::PermissionsExt;
    let shell = with_octree();
    let mode = |name: &str| shell.path(name).metadata().expect("a file").permissions().mode() & 0o777;
    assert_eq!(mode("sphere.lwk"), mode("sphere.obj"));
    std::fs::set_permissions(shell.path("sphere.lwk"), PermissionsExt::from_mode(0o640)).expect("a file of ours");
    shell.run("build sphere.obj -o sphere.lwk").assert_code(0);
    assert_eq!(mode("sphere.lwk"), 0o640);
}

#[test]
fn wrong_usage_is_told_from_failed_work() {
    let shell = with_octree();
    let before = shell.names();
    for arguments in [
        "frobnicate",
        "sphere.obj",
        "build",
        "build sphere.obj",
        "build sphere.obj -o sphere.txt",
        "build sphere.obj -o out.lwk --threads 0",
        "build sphere.obj -o out.lwk --threads 60000",
        "build sphere.obj -o out.lwk --threads many",
        "build sphere.obj -o out.lwk --max-level 17",
        "build sphere.obj -o out.lwk --budget 0.5",
        "build sphere.obj -o out.lwk --budget inf",
        "build sphere.obj -o out.lwk --step-cost 0.25",
        "build sphere.obj -o out.lwk --step-cost nan",
        "info",
        "verify",
        "trace sphere.lwk rays.csv",
        "trace sphere.lwk rays.txt -o hits.csv",
        "trace sphere.lwk rays.csv -o hits",
        "trace sphere.lwk rays.csv -o hits.csv --backend tpu",
        "trace sphere.lwk rays.csv -o hits.csv --flavour fast",
        "render sphere.lwk -o a.png --adapter software",
        "render sphere.lwk -o a.png --or-cpu",
        // Before the work: the rays are not even looked for.
        "trace sphere.lwk absent.csv -o hits.csv --flavour fast",
    ] {
        let outcome = shell.run(arguments);
        outcome.assert_code(2);
        assert!(outcome.stderr.contains("error: ") && outcome.stdout.is_empty(), "{arguments}: {outcome:?}");
    }
    assert_eq!(shell.names(), before);
}

#[test]
#[cfg(not(feature = "gpu"))]
fn a_build_without_gpus_says_how_to_get_one_that_has_them() {
    let shell = with_octree();
    for arguments in
        ["gpu", "trace sphere.lwk rays.csv -o hits.csv --backend gpu", "render sphere.lwk -o a.png --backend gpu"]
    {
        let outcome = shell.run(arguments);
        outcome.assert_code(2);
        assert!(outcome.stderr.contains("--features gpu") && outcome.stdout.is_empty(), "{outcome:?}");
    }
}

#[test]
fn help_shows_examples_of_every_command() {
    let shell = shell();
    for command in ["", "render", "build", "info", "verify", "trace", "gpu"] {
        let help = shell.run(&format!("{command} --help"));
        help.assert_code(0);
        assert!(help.stdout.contains(&format!("  leafwalk {command}")), "{help:?}");
    }
}

#[test]
fn a_reader_that_left_is_no_failure() {
    let shell = with_octree();
    let mut child = shell.command("info sphere.lwk").spawn().expect("the command starts");
    drop(child.stdout.take());
    let outcome = Outcome::of(child.wait_with_output().expect("it ends"));
    outcome.assert_code(0);
    assert_eq!(outcome.stderr, "");
}

#[test]
fn real_scenes_go_through_every_command() {
    let Some(folder) = std::env::var_os("LEAFWALK_SCENES") else {
        return println!("skipped: real scenes through the command: LEAFWALK_SCENES is not set");
    };
    let scenes = mesh_files(folder.as_ref());
    assert!(!scenes.is_empty(), "LEAFWALK_SCENES names a folder without meshes");
    for scene in scenes {
        let shell = shell();
        let scene = scene.display();
        let built = shell.json(&format!("build {scene} -o scene.lwk"));
        let info = shell.json("info scene.lwk");
        assert_eq!(info["triangles"], built["triangles"], "{scene}");
        let verified = shell.json(&format!("verify scene.lwk {scene}"));
        let counted =
            verified["triangles"].as_u64().zip(built["dropped"].as_u64()).map(|(kept, dropped)| kept + dropped);
        assert_eq!(counted, built["triangles"].as_u64(), "{scene}");

        let octree = leafwalk::load_octree(shell.path("scene.lwk")).expect("a file that was just verified");
        let rays = leafwalk_testing::rays::primary(&octree.bounds(), 32);
        let row = |ray: &leafwalk::Ray| {
            let [[x, y, z], [dx, dy, dz]] = [ray.origin, ray.direction];
            format!("{x},{y},{z},{dx},{dy},{dz},{},{}\n", ray.t_min, ray.t_max)
        };
        shell.write("rays.csv", rays.iter().map(row).collect::<String>());
        let traced = shell.json("trace scene.lwk rays.csv -o hits.npy");
        let mut hits = vec![leafwalk::Hit::MISS; rays.len()];
        leafwalk::Tracer::closest_hits(&octree, &rays, &mut hits).expect("equal lengths");
        assert_eq!(traced["hit_hash"], format!("{:016x}", leafwalk::hit_hash(&hits)), "{scene}");
        assert!(traced["hits"].as_u64().is_some_and(|hits| hits > 0), "{scene}: {traced}");
        println!("{scene}: {} triangles, {} of {} rays hit", built["triangles"], traced["hits"], traced["rays"]);
    }
}
