//! What can be said of the shaders without a GPU: they are those that are committed, they are valid, and their structs
//! are the ones of Rust.

use core::mem::offset_of;
use std::path::Path;

use leafwalk_gpu::testing::{
    Arithmetic, DeviceAnswer, DeviceHit, DeviceRay, MOST_BINDINGS, MapSetup, OctreeSetup, WordBindings, checks,
    generating, tracing,
};
use naga::valid::{Capabilities, ValidationFlags, Validator};

/// The bindings of an octree of up to 128 MiB, the most that WebGPU promises of one binding.
const WHOLE: WordBindings = WordBindings { count: 1, shift: 23 };
/// A ray generation shader: the camera that the tests with a device make rays by.
const CAMERA: &str = include_str!("device/camera.wgsl");

/// The texts that are committed, with the names of their files.
fn committed() -> [(&'static str, String); 2] {
    [("exact.wgsl", tracing(Arithmetic::Exact, WHOLE)), ("fast.wgsl", tracing(Arithmetic::Fast, WHOLE))]
}

/// Every text that there is: kernels that trace octrees in any number of bindings, make rays, and check.
fn texts() -> Vec<(String, String)> {
    let of = |arithmetic: Arithmetic| {
        let bindings = (1..=MOST_BINDINGS).map(move |count| {
            (format!("{arithmetic} in {count}"), tracing(arithmetic, WordBindings { count, ..WHOLE }))
        });
        bindings.chain([
            (format!("{arithmetic}, rays"), generating(arithmetic, CAMERA)),
            (format!("{arithmetic}, checks"), checks(arithmetic)),
        ])
    };
    [Arithmetic::Exact, Arithmetic::Fast, Arithmetic::Unguarded].into_iter().flat_map(of).collect()
}

fn parsed(name: &str, text: &str) -> naga::Module {
    naga::front::wgsl::parse_str(text).unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(text)))
}

/// To bless a change of the shaders, run this test with the environment variable LEAFWALK_WRITE_SHADERS set: it then
/// writes the two texts anew, and passes.
#[test]
fn committed_shaders_are_the_generated_ones() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    let entries = folder.read_dir().expect("the folder is there");
    let mut files: Vec<String> =
        entries.map(|entry| entry.expect("a file").file_name().to_string_lossy().into_owned()).collect();
    files.sort();
    assert_eq!(files, committed().map(|(name, _)| name), "other texts are generated where they are needed");
    for (name, text) in committed() {
        let path = folder.join(name);
        if std::env::var_os("LEAFWALK_WRITE_SHADERS").is_some() {
            std::fs::write(&path, &text).expect("the folder is there");
        }
        let committed = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(committed == text, "{name} is out of date: run this test with LEAFWALK_WRITE_SHADERS=1");
    }
}

#[test]
fn shaders_are_valid_without_any_capability() {
    for (name, text) in texts() {
        let module = parsed(&name, &text);
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
        let info =
            validator.validate(&module).unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(&text)));
        for index in 0..module.entry_points.len() {
            let is_used = |(handle, variable): &(naga::Handle<naga::GlobalVariable>, &naga::GlobalVariable)| {
                let is_storage = matches!(variable.space, naga::AddressSpace::Storage { .. });
                is_storage && !info.get_entry_point(index)[*handle].is_empty()
            };
            let used = module.global_variables.iter().filter(is_used).count();
            assert!(used <= 8, "{name}: {} uses {used} storage buffers", module.entry_points[index].name);
        }
    }
}

#[test]
fn structs_have_the_offsets_of_rust() {
    let tracing = parsed("tracing", &tracing(Arithmetic::Exact, WHOLE));
    let checks = parsed("checks", &checks(Arithmetic::Exact));
    let layout = |module: &naga::Module, wanted: &str| {
        let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(wanted)).map(|(_, ty)| &ty.inner);
        let Some(naga::TypeInner::Struct { members, span }) = found else { panic!("no struct {wanted}") };
        let name = |member: &naga::StructMember| member.name.clone().unwrap_or_default();
        (members.iter().map(|member| (name(member), member.offset as usize)).collect::<Vec<_>>(), *span as usize)
    };
    macro_rules! of_rust {
        ($ty:ty, $($field:ident),+) => {
            (vec![$((stringify!($field).to_owned(), offset_of!($ty, $field))),+], size_of::<$ty>())
        };
    }
    assert_eq!(layout(&tracing, "CanonicalRay"), of_rust!(DeviceRay, origin, t_min, direction, t_max));
    assert_eq!(layout(&tracing, "Hit"), of_rust!(DeviceHit, t, u, v, primitive));
    assert_eq!(layout(&tracing, "Answer"), of_rust!(DeviceAnswer, hit, cells, blocks, unused_0, unused_1));
    let setup = of_rust!(
        OctreeSetup,
        records,
        payloads,
        blocks,
        grid,
        corner,
        grid_bits,
        hull_lower,
        zero,
        hull_upper,
        bvh,
        lattices,
        unused_0,
        unused_1,
        unused_2
    );
    assert_eq!(layout(&tracing, "Setup"), setup);
    assert_eq!(layout(&checks, "Setup"), of_rust!(MapSetup, first, zero, unused_0, unused_1));
}

/// A comment such as `// core/src/step.rs: Slab::exit and more` stands above every function and struct, but for those
/// that only WGSL needs; what it names is defined there.
#[test]
fn twins_are_named_and_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let parts = root.join("src/shader/wgsl").read_dir().expect("the parts");
    let parts = parts.map(|entry| entry.expect("a part").path());
    let mut named = 0;
    for path in parts.chain([root.join("tests/device/camera.wgsl")]) {
        let part = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let text = std::fs::read_to_string(&path).expect("a text");
        let lines: Vec<&str> = text.lines().collect();
        for at in 0..lines.len() {
            if let Some((file, name)) = twin(lines[at]) {
                let source = std::fs::read_to_string(root.join("..").join(file));
                let source = source.unwrap_or_else(|_| panic!("{part}.wgsl: there is no {file}"));
                let lacks = name.split("::").find(|name| !defines(&source, name));
                assert_eq!(lacks, None, "{part}.wgsl: {}", lines[at]);
                named += 1;
            }
            let needs_one = lines[at].starts_with("fn ") || lines[at].starts_with("struct ");
            let mut above = lines[..at].iter().rev().take_while(|line| line.starts_with(['/', '@']));
            let has_one = above.any(|line| twin(line).is_some()) || OF_WGSL_ALONE.contains(&part.as_str());
            assert!(!needs_one || has_one, "{part}.wgsl: {} names no twin", lines[at]);
        }
    }
    assert!(named > 40, "only {named} comments name a twin");
}

/// Parts whose functions have no twins of their own: what is an operator in Rust, and what guards it.
const OF_WGSL_ALONE: [&str; 3] = ["operations", "guarded", "unguarded"];

/// The file and the item that a comment names, if it begins with any.
fn twin(line: &str) -> Option<(&str, &str)> {
    let (file, rest) = line.strip_prefix("// ")?.split_once(".rs: ")?;
    let name = rest.split(|c: char| !c.is_alphanumeric() && !"_:".contains(c)).next()?;
    Some((&line["// ".len()..][..file.len() + ".rs".len()], name))
}

/// Whether Rust's text has an item or a field of that name.
fn defines(source: &str, name: &str) -> bool {
    let is_whole = |rest: &str| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_');
    let is_item = ["fn ", "struct ", "enum ", "trait ", "const "].iter().any(|before| {
        let wanted = format!("{before}{name}");
        source.match_indices(&wanted).any(|(at, _)| is_whole(&source[at + wanted.len()..]))
    });
    is_item || ["", "pub "].iter().any(|visible| source.contains(&format!("\n    {visible}{name}: ")))
}
