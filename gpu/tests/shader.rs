//! What can be said of the shaders without a GPU: they are those that are committed, they are valid, and their structs
//! are the ones of Rust.

use core::mem::offset_of;
use std::path::Path;

use leafwalk_gpu::Flavour;
use leafwalk_gpu::chunk::{MOST_BINDINGS, Split};
use leafwalk_gpu::pinhole::DeviceCamera;
use leafwalk_gpu::ray::{DeviceAnswer, DeviceHit, DeviceRay};
use leafwalk_gpu::shader;
use leafwalk_gpu::structure::Setup;
use naga::valid::{Capabilities, ValidationFlags, Validator};

/// As WebGPU's default limits split a structure of one binding, and of six.
const WHOLE: Split = Split { bindings: 1, shift: 23 };
const IN_SIX: Split = Split { bindings: MOST_BINDINGS, shift: 23 };

/// Every text, with the name that it is committed under.
fn texts() -> Vec<(String, String)> {
    let of = |flavour: Flavour| {
        [
            (format!("{flavour}.wgsl"), shader::tracing(flavour, WHOLE)),
            (format!("{flavour}_in_six.wgsl"), shader::tracing(flavour, IN_SIX)),
            (format!("{flavour}_camera.wgsl"), shader::camera(flavour)),
            (format!("{flavour}_checks.wgsl"), shader::checks(flavour)),
        ]
    };
    [Flavour::Exact, Flavour::Fast].into_iter().flat_map(of).collect()
}

fn parsed(name: &str, text: &str) -> naga::Module {
    naga::front::wgsl::parse_str(text).unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(text)))
}

/// Run with LEAFWALK_WRITE_SHADERS set to write them anew.
#[test]
fn committed_shaders_are_the_generated_ones() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    for (name, text) in texts() {
        let path = folder.join(&name);
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
    let modules = [shader::tracing(Flavour::Exact, WHOLE), shader::camera(Flavour::Exact)];
    let modules = modules.map(|text| parsed("exact", &text));
    let layout = |wanted: &str| {
        let found = modules
            .iter()
            .flat_map(|module| module.types.iter())
            .find(|(_, ty)| ty.name.as_deref() == Some(wanted))
            .map(|(_, ty)| &ty.inner);
        let Some(naga::TypeInner::Struct { members, span }) = found else { panic!("no struct {wanted}") };
        let name = |member: &naga::StructMember| member.name.clone().unwrap_or_default();
        (members.iter().map(|member| (name(member), member.offset as usize)).collect::<Vec<_>>(), *span as usize)
    };
    macro_rules! of_rust {
        ($ty:ty, $($field:ident),+) => {
            (vec![$((stringify!($field).to_owned(), offset_of!($ty, $field))),+], size_of::<$ty>())
        };
    }
    assert_eq!(layout("CanonicalRay"), of_rust!(DeviceRay, origin, t_min, direction, t_max));
    assert_eq!(layout("Hit"), of_rust!(DeviceHit, t, u, v, primitive));
    assert_eq!(layout("Answer"), of_rust!(DeviceAnswer, hit, cells, blocks, unused_0, unused_1));
    let camera = of_rust!(
        DeviceCamera,
        origin,
        t_min,
        corner,
        t_max,
        right,
        width,
        down,
        height,
        tiles_across,
        first,
        unused_0,
        unused_1
    );
    assert_eq!(layout("Camera"), camera);
    let setup = of_rust!(Setup, records, payloads, blocks, grid, grid_bits, zero, unused_0, unused_1);
    assert_eq!(layout("Setup"), setup);
}

/// A comment such as `// core/src/step.rs: Slab::exit and more` stands above every function and struct, but for those
/// that only WGSL needs; what it names is defined there.
#[test]
fn twins_are_named_and_exist() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/wgsl");
    let mut named = 0;
    for entry in folder.read_dir().expect("the parts") {
        let path = entry.expect("a part").path();
        let part = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let text = std::fs::read_to_string(&path).expect("a text");
        let lines: Vec<&str> = text.lines().collect();
        for at in 0..lines.len() {
            if let Some((file, name)) = twin(lines[at]) {
                let source = std::fs::read_to_string(folder.join("../../..").join(file));
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
