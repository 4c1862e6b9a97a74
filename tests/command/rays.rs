//! Rays in and hits out through `leafwalk trace`, in every form that files may have.

use leafwalk::{Builder, Hit, HitF64, Mesh, Octree, Ray, RayF64, hit_hash};
use leafwalk_testing::meshes::bumpy_sphere;
use leafwalk_testing::random::Random;
use leafwalk_testing::shell::{Shell, obj};
use npyz::{DType, NpyFile, Order, WriterBuilder};

use super::shell;

const RAYS: u64 = 300;
const NAMES: [&str; 8] = ["ox", "oy", "oz", "dx", "dy", "dz", "t_min", "t_max"];

/// Eight columns in f64, most of which f32 must round: rays in and around the sphere, some of them invalid.
fn rows() -> Vec<[f64; 8]> {
    let row = |i: u64| {
        let mut random = Random::new(5, i);
        let mut row = [0.0; 8];
        row[..6].fill_with(|| 2.0 * f64::from(random.signed()) + f64::from(random.signed()) * 1e-9);
        row[6] = 0.3 * f64::from(random.signed());
        row[7] = 0.1 + 3.0 * f64::from(random.unit());
        match i % 29 {
            3 => row[i as usize % 8] = f64::NAN,
            7 => row[3..6].fill(0.0),
            11 => row[7] = f64::INFINITY,
            13 => row[1] = f64::NEG_INFINITY,
            17 => row[7] = 1e300,
            _ => {}
        }
        row
    };
    (0..RAYS).map(row).collect()
}

/// The ray of the first columns of a row, in f64.
fn ray_f64(row: &[f64]) -> RayF64 {
    let t_min = row.get(6).copied().unwrap_or(0.0);
    let t_max = row.get(7).copied().unwrap_or(f64::INFINITY);
    RayF64::between([row[0], row[1], row[2]], [row[3], row[4], row[5]], t_min, t_max)
}

/// The ray of the first columns of a row, rounded to f32.
fn ray(row: &[f64]) -> Ray {
    let at = |k: usize| row[k] as f32;
    let t_min = if row.len() > 6 { at(6) } else { 0.0 };
    let t_max = if row.len() > 7 { at(7) } else { f32::INFINITY };
    Ray::between([at(0), at(1), at(2)], [at(3), at(4), at(5)], t_min, t_max)
}

fn sphere() -> (Shell, Octree<Vec<u32>>) {
    let shell = shell();
    let octree = Builder::new().build(&bumpy_sphere(3, 1)).expect("a mesh that can be built");
    leafwalk::save_octree(&octree, shell.path("sphere.lwk")).expect("a folder of ours");
    (shell, octree)
}

/// The answers that the library gives to the first columns of the rows, rounded to f32.
fn expected(octree: &Octree<Vec<u32>>, columns: usize) -> Vec<Hit> {
    rows().iter().map(|row| Hit::from(octree.closest_hit(&ray(&row[..columns])))).collect()
}

/// The answers that the library gives to the first columns of the rows in f64.
fn expected_f64(octree: &Octree<Vec<u32>>, columns: usize) -> Vec<HitF64> {
    rows().iter().map(|row| HitF64::from(octree.closest_hit_f64(&ray_f64(&row[..columns])))).collect()
}

/// The same with distances in f32.
fn rounded(hits: &[HitF64]) -> Vec<Hit> {
    hits.iter().map(|hit| Hit::from(*hit)).collect()
}

fn assert_same(found: &[Hit], expected: &[Hit], what: &str) {
    let bits = |hit: &Hit| [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.primitive];
    assert_eq!(found.len(), expected.len(), "{what}");
    for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert_eq!(bits(found), bits(expected), "{what}: ray {i}: {found:?} instead of {expected:?}");
    }
}

#[track_caller]
fn assert_report(report: &serde_json::Value, expected: &[Hit], columns: usize) {
    let hits = expected.iter().filter(|hit| !hit.is_miss()).count();
    let invalid = rows().iter().filter(|row| !ray(&row[..columns]).is_valid()).count();
    assert!(hits > 20 && invalid > 20, "a test of nothing: {hits} hits, {invalid} invalid rays");
    assert_eq!(report["rays"], expected.len());
    assert_eq!(report["hits"], hits);
    assert_eq!(report["misses"], expected.len() - hits);
    assert_eq!(report["invalid"], invalid);
    assert_eq!(report["hit_hash"], format!("{:016x}", hit_hash(expected)));
    assert!(report["mrays_per_s"].as_f64().is_some_and(|speed| speed > 0.0), "{report}");
}

#[derive(npyz::Deserialize)]
struct Row {
    t: f32,
    u: f32,
    v: f32,
    primitive: u32,
}

fn read_npy(bytes: &[u8]) -> Vec<Hit> {
    let file = NpyFile::new(bytes).expect("an npy file");
    assert_eq!(file.dtype().descr(), "[('t', '<f4'), ('u', '<f4'), ('v', '<f4'), ('primitive', '<u4'), ]");
    assert_eq!(file.shape().len(), 1);
    let rows = file.into_vec::<Row>().expect("rows of hits");
    rows.into_iter().map(|row| Hit { t: row.t, u: row.u, v: row.v, primitive: row.primitive }).collect()
}

fn read_csv(bytes: &[u8]) -> Vec<Hit> {
    let text = core::str::from_utf8(bytes).expect("text");
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("t,u,v,primitive"));
    let hit = |line: &str| {
        let fields: Vec<&str> = line.split(',').collect();
        let &[t, u, v, primitive] = fields.as_slice() else { panic!("{line}") };
        let [t, u, v] = [t, u, v].map(|field| field.parse().expect("a number"));
        Hit { t, u, v, primitive: primitive.parse().expect("an index") }
    };
    lines.map(hit).collect()
}

/// An npy file of the first columns of the rows.
fn npy(item: &str, order: Order, columns: usize) -> Vec<u8> {
    let rows = rows();
    let items: Vec<f64> = match order {
        Order::C => rows.iter().flat_map(|row| row[..columns].iter().copied()).collect(),
        Order::Fortran => (0..columns).flat_map(|column| rows.iter().map(move |row| row[column])).collect(),
    };
    let dtype = DType::Plain(item.parse().expect("a type"));
    let shape = [rows.len() as u64, columns as u64];
    let mut bytes = Vec::new();
    if item.ends_with('8') {
        let options = npyz::WriteOptions::new().dtype(dtype).shape(&shape).order(order);
        let mut file = options.writer(&mut bytes).begin_nd().expect("a header");
        file.extend(items).and_then(|()| file.finish()).expect("room in memory");
    } else {
        let options = npyz::WriteOptions::new().dtype(dtype).shape(&shape).order(order);
        let mut file = options.writer(&mut bytes).begin_nd().expect("a header");
        file.extend(items.into_iter().map(|item| item as f32)).and_then(|()| file.finish()).expect("room in memory");
    }
    bytes
}

#[test]
fn npy_of_every_kind_gives_the_answers_of_the_library() {
    let (shell, octree) = sphere();
    for columns in 6..=8 {
        let by_size = [expected(&octree, columns), rounded(&expected_f64(&octree, columns))];
        for item in ["<f4", ">f4", "<f8", ">f8"] {
            for order in [Order::C, Order::Fortran] {
                let what = format!("{item} {order:?} {columns}");
                let expected = &by_size[usize::from(item.ends_with('8'))];
                shell.write("rays.npy", npy(item, order, columns));
                let report = shell.json("trace sphere.lwk rays.npy -o hits.npy");
                assert_report(&report, expected, columns);
                assert_same(&read_npy(&shell.read("hits.npy")), expected, &what);
            }
        }
    }
    assert_eq!(shell.names(), ["hits.npy", "rays.npy", "sphere.lwk"]);
}

#[test]
fn csv_with_and_without_a_header_gives_the_answers_of_the_library() {
    let (shell, octree) = sphere();
    for columns in 6..=8 {
        let expected = rounded(&expected_f64(&octree, columns));
        for (header, separator, end) in [(false, ",", "\n"), (true, ",", "\r\n"), (true, " ,\t", "\n\n")] {
            let line = |fields: Vec<String>| fields.join(separator) + end;
            let row = |row: [f64; 8]| line(row[..columns].iter().map(|field| field.to_string()).collect());
            let names = header.then(|| line(NAMES[..columns].iter().map(|name| name.to_string()).collect()));
            let text: String = names.into_iter().chain(rows().into_iter().map(row)).collect();
            shell.write("rays.csv", text.as_bytes());
            let report = shell.json("trace sphere.lwk rays.csv -o hits.csv");
            assert_report(&report, &expected, columns);
            assert_same(&read_csv(&shell.read("hits.csv")), &expected, &format!("{columns} columns, header {header}"));
        }
    }
}

#[derive(npyz::Deserialize)]
struct RowF64 {
    t: f64,
    u: f32,
    v: f32,
    primitive: u32,
}

#[test]
fn distances_are_in_f64_on_request() {
    let (shell, octree) = sphere();
    let bits = |hit: &HitF64| (hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.primitive);
    let of_f32: Vec<HitF64> = rows().iter().map(|row| octree.closest_hit_f64(&ray(row).into()).into()).collect();
    for (item, expected) in [("<f4", of_f32), ("<f8", expected_f64(&octree, 8))] {
        shell.write("rays.npy", npy(item, Order::C, 8));
        let report = shell.json("trace sphere.lwk rays.npy -o hits.npy --t f64");
        assert_report(&report, &rounded(&expected), 8);
        let bytes = shell.read("hits.npy");
        let file = NpyFile::new(bytes.as_slice()).expect("an npy file");
        assert_eq!(file.dtype().descr(), "[('t', '<f8'), ('u', '<f4'), ('v', '<f4'), ('primitive', '<u4'), ]");
        let rows = file.into_vec::<RowF64>().expect("rows of hits").into_iter();
        let found: Vec<_> = rows.map(|RowF64 { t, u, v, primitive }| HitF64 { t, u, v, primitive }).collect();
        assert!(found.iter().map(bits).eq(expected.iter().map(bits)), "{item}");

        shell.run("trace sphere.lwk rays.npy -o hits.csv --t f64").assert_code(0);
        let text = String::from_utf8(shell.read("hits.csv")).expect("text");
        let distances = text.lines().skip(1).map(|line| line.split(',').next().and_then(|t| t.parse::<f64>().ok()));
        assert!(distances.eq(expected.iter().map(|hit| Some(hit.t))), "{item}");
    }
}

/// A scene in UTM coordinates, from its file to the hits: it is traced where it is, to the last bit of the library.
#[test]
fn utm_coordinates_go_through_files() {
    let shell = shell();
    let corners =
        [[500_000.123, 4_500_000.004, 10.5], [500_010.456, 4_500_000.25, 10.5], [500_000.2, 4_500_000.1, 20.0]];
    let mesh = Mesh::new_f64(corners.to_vec(), vec![[0, 1, 2]]);
    let text = corners.map(|[x, y, z]| format!("v {x} {y} {z}\n")).concat();
    shell.write("utm.obj", text + "f 1 2 3\n");
    shell.run("build utm.obj -o utm.lwk").assert_code(0);
    let octree = Builder::new().build(&mesh).expect("a mesh that can be built");
    let loaded = leafwalk::load_octree(shell.path("utm.lwk")).expect("a file that was just built");
    assert!(loaded.as_words() == octree.as_words());
    shell.run("verify utm.lwk utm.obj").assert_code(0);
    let info = shell.json("info utm.lwk");
    let anchor: Vec<_> = (0..3).filter_map(|k| info["frame_anchor"][k].as_f64()).collect();
    assert_eq!(anchor, octree.frame().anchor);
    let moved = info["frame_rounding"].as_f64().expect("a number");
    assert!(moved > 0.0 && moved < 1e-6, "{moved}");

    let ray = RayF64::new([500_003.3, 4_495_000.001, 13.0], [0.0, 1.0, 0.0002]);
    shell.write("rays.csv", "500003.3,4495000.001,13,0,1,0.0002\n");
    shell.run("trace utm.lwk rays.csv -o hits.csv --t f64").assert_code(0);
    let hit = octree.closest_hit_f64(&ray).expect("a ray at the triangle");
    let text = String::from_utf8(shell.read("hits.csv")).expect("text");
    assert_eq!(text, format!("t,u,v,primitive\n{:?},{:?},{:?},0\n", hit.t, hit.u, hit.v));
    assert!((hit.t - 5000.08).abs() < 0.05 && f64::from(hit.t as f32) != hit.t, "{hit:?}");
}

#[test]
fn numbers_in_csv_are_written_in_many_ways() {
    let (shell, octree) = sphere();
    shell.write(
        "rays.csv",
        "\u{feff}OX,oy,oz,dx,dy,dz,t_min,t_max\n 0 ,+0,-0.0,1e0,.5,\"0\",-1E-3,Inf\n0,0,0,1,0.5,0,0,infinity",
    );
    let report = shell.json("trace sphere.lwk rays.csv -o hits.csv");
    assert_eq!([&report["rays"], &report["hits"], &report["invalid"]], [2, 2, 0]);
    let hit = octree.closest_hit(&Ray::new([0.0; 3], [1.0, 0.5, 0.0])).expect("a ray from inside");
    assert_same(&read_csv(&shell.read("hits.csv")), &[hit; 2], "both lines are the same ray");
}

#[test]
fn no_rays_are_no_failure() {
    let (shell, _) = sphere();
    shell.write("none.csv", "ox,oy,oz,dx,dy,dz\n");
    shell.write("none.npy", header("'<f8'", "(0, 8)"));
    for rays in ["none.csv", "none.npy"] {
        let report = shell.json(&format!("trace sphere.lwk {rays} -o hits.npy"));
        assert_eq!([&report["rays"], &report["hits"], &report["misses"]], [0, 0, 0]);
        assert_eq!(report["hit_hash"], format!("{:016x}", hit_hash(&[])));
        assert!(read_npy(&shell.read("hits.npy")).is_empty());
    }
}

#[test]
fn a_mesh_can_stand_for_its_octree() {
    let (shell, octree) = sphere();
    shell.write("sphere.obj", obj(&bumpy_sphere(3, 1)));
    shell.write("rays.npy", npy("<f4", Order::C, 6));
    shell.run("trace sphere.obj rays.npy -o hits.npy").assert_code(0);
    assert_same(&read_npy(&shell.read("hits.npy")), &expected(&octree, 6), "built in memory");
}

/// The start of an npy file of version 1.
fn header(descr: &str, shape: &str) -> Vec<u8> {
    raw_header(1, &format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}\n"))
}

fn raw_header(version: u8, text: &str) -> Vec<u8> {
    let length = match version {
        1 => (text.len() as u16).to_le_bytes().to_vec(),
        _ => (text.len() as u32).to_le_bytes().to_vec(),
    };
    [b"\x93NUMPY", [version, 0].as_slice(), &length, text.as_bytes()].concat()
}

#[test]
fn npy_headers_of_later_versions_are_read() {
    let (shell, _) = sphere();
    let text = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 6), }";
    for version in [1, 2, 3] {
        shell.write("rays.npy", [raw_header(version, text), vec![0; 48]].concat());
        let report = shell.json("trace sphere.lwk rays.npy -o hits.npy");
        assert_eq!([&report["rays"], &report["invalid"]], [2, 2]);
    }
}

#[test]
fn malformed_npy_is_refused() {
    let (shell, _) = sphere();
    let whole = npy("<f4", Order::C, 7);
    let fortran = npy("<f8", Order::Fortran, 8);
    let cases: Vec<(&str, Vec<u8>)> = vec![
        ("the header is cut", Vec::new()),
        ("the header is cut", whole[..50].to_vec()),
        ("it does not start as one", b"ox,oy,oz,dx,dy,dz\n0,0,0,1,0,0\n".to_vec()),
        ("ends after 2099 of 2100 items", whole[..whole.len() - 1].to_vec()),
        ("ends after 2 of 2400 items", fortran[..fortran.len() - 2398 * 8].to_vec()),
        ("goes on after its 2100 items", [whole.as_slice(), b"\n"].concat()),
        ("ends after 0 of 6000000000000 items", header("'<f4'", "(1000000000000, 6)")),
        ("shape [100, 5]", header("'<f4'", "(100, 5)")),
        ("shape [100, 9]", header("'<f4'", "(100, 9)")),
        ("shape [6]", header("'<f4'", "(6,)")),
        ("shape []", header("'<f4'", "()")),
        ("shape [2, 3, 6]", header("'<f4'", "(2, 3, 6)")),
        ("items of type '<i4'", header("'<i4'", "(100, 6)")),
        ("items of type '<f2'", header("'<f2'", "(100, 6)")),
        ("items of type '|O'", header("'|O'", "(100, 6)")),
        ("items of type [('ox', '<f4')", header("[('ox', '<f4')]", "(100, 6)")),
        ("this is no npy file that holds rays", header("'<q9'", "(100, 6)")),
        ("dimension cannot be negative", header("'<f4'", "(-1, 6)")),
        ("something else than a table", header("'<f4'", "(9223372036854775807, 8, 8)")),
        ("something else than a table", header("'<f4'", "(0xffffffffffffffff, 8)")),
        ("something else than a table", header(&"[".repeat(500), "(100, 6)")),
        ("the header is too long", raw_header(2, &" ".repeat(20_000))),
        ("this is no npy file that holds rays", raw_header(1, "{'descr': '<f4'}")),
        ("this is no npy file that holds rays", raw_header(9, "{'descr': '<f4'}")),
    ];
    for (reason, bytes) in cases {
        shell.write("rays.npy", bytes);
        shell.assert_fails("trace sphere.lwk rays.npy -o hits.npy", reason);
    }
    shell.assert_fails("trace sphere.lwk absent.npy -o hits.npy", "absent.npy: cannot be read");
}

/// Headers with a few bytes changed: an error or an answer, but no panic and no hang.
#[test]
fn npy_headers_at_random_end_well() {
    const SYNTAX: &[u8] = b"([{}])',:0123456789<>|=fixeOj+-\\ ";
    let (shell, _) = sphere();
    let whole = [header("'<f4'", "(2, 6)"), vec![0; 48]].concat();
    for i in 0..200 {
        let mut random = Random::new(6, i);
        let mut bytes = whole.clone();
        for _ in 0..=random.below(4) {
            let at = 8 + random.below(bytes.len() - 56);
            bytes[at] = match random.below(2) {
                0 => SYNTAX[random.below(SYNTAX.len())],
                _ => random.bits() as u8,
            };
        }
        shell.write("rays.npy", &bytes);
        let outcome = shell.run("trace sphere.lwk rays.npy -o hits.npy");
        assert!(matches!(outcome.code, Some(0 | 1)), "case {i}: {outcome:?}");
    }
}

#[test]
fn malformed_csv_is_refused() {
    let (shell, _) = sphere();
    let good = "0,0,0,1,0,0\n";
    let cases: Vec<(&str, Vec<u8>)> = vec![
        ("line 1: 5 columns", b"0,0,0,1,0\n".to_vec()),
        ("line 1: 9 columns", b"0,0,0,1,0,0,0,1,2\n".to_vec()),
        ("line 1: 1 columns", b"0 0 0 1 0 0\n".to_vec()),
        ("line 1, column 1: this is no text", b"\x93NUMPY\n".to_vec()),
        ("line 3: 7 columns, but 6 in the lines before", format!("{good}{good}0,0,0,1,0,0,0\n").into_bytes()),
        ("line 2, column 3: 'abc' is no number", format!("{good}0,0,abc,1,0,0\n").into_bytes()),
        ("line 2, column 6: '' is no number", format!("{good}0,0,0,1,0,\n").into_bytes()),
        ("line 4, column 1: 'ox' is no number", format!("{good}\n\nox,oy,oz,dx,dy,dz\n").into_bytes()),
        ("line 1, column 4: 'dz' is no number, and a header names 'dx'", b"ox,oy,oz,dz,dy,dx\n".to_vec()),
        ("line 2, column 2: this is no text", [good.as_bytes(), b"0,\xff,0,1,0,0\n"].concat()),
        ("is no number", format!("{good}0,0,{},1,0,0\n", "x".repeat(1 << 20)).into_bytes()),
        ("'\\0' is no number", format!("{good}0,0,\0,1,0,0\n").into_bytes()),
    ];
    for (reason, bytes) in cases {
        let what = String::from_utf8_lossy(&bytes[..bytes.len().min(80)]).into_owned();
        println!("{what:?}");
        shell.write("rays.csv", bytes);
        shell.assert_fails("trace sphere.lwk rays.csv -o hits.csv", reason);
    }
}
