//! Speed charted against accuracy: structures and triangle tests, ours and others, and other tracers, on the rays of a
//! renderer and on rays aimed where methods fail; each answer is judged exactly.
//!
//! `cargo bench --bench accuracy [--features embree] [-- SCENE ... --out docs]`; LEAFWALK_SCENES names the folder of real
//! scenes, without it the default is made in code. Writes accuracy.csv, and accuracy.svg of the first scene.

mod report;

use core::time::Duration;
use std::path::PathBuf;

use clap::Parser;
use leafwalk::{Hit, Mesh, Ray};
use leafwalk_compare::measure::{Sample, quantile};
use leafwalk_compare::methods::{self, Built, Method};
use leafwalk_compare::truth::Oracle;
use leafwalk_rivals::{Prepared, Rival, ours, timed};
use leafwalk_testing::{meshes, scenes};

use report::{Report, Row};

/// Families of methods that are for small scenes, and the most triangles of these.
const SMALL: [(&str, usize); 2] = [("none", 1000), ("BSP", 100_000)];

/// Measures methods beside each other.
#[derive(Parser)]
struct Arguments {
    /// bunny, armadillo, dragon, conference, sponza; bunny by default.
    scenes: Vec<String>,
    /// The folder to write to, from the root of the repository.
    #[arg(long, default_value = "target/bench")]
    out: PathBuf,
    /// Only methods with one of these in their names, comma-separated.
    #[arg(long, value_delimiter = ',')]
    methods: Vec<String>,
    /// Primary rays are this many squared; a multiple of 8.
    #[arg(long, default_value_t = 256, value_parser = leafwalk_testing::workloads::side)]
    side: u32,
    /// Rays aimed where methods fail.
    #[arg(long, default_value_t = 200_000)]
    hard: u64,
    /// Rounds of each measurement of speed.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
    /// Cargo passes it.
    #[arg(long, hide = true)]
    bench: bool,
}

/// A tracer under measurement, and what is said of it beside its numbers.
struct Contender {
    rival: Box<dyn Rival>,
    family: &'static str,
    test: &'static str,
    handling: String,
    build: Option<Duration>,
}

fn main() {
    let arguments = Arguments::parse();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    let mut report = Report::default();
    for (name, mesh, inside) in chosen(&arguments.scenes) {
        println!("{name}: {} triangles", mesh.triangles.len());
        let oracle = Oracle::new(&mesh);
        let typical = Sample::typical(&oracle, &mesh, inside, arguments.side).expect("a mesh that builds");
        let hard = Sample::hard(&oracle, &mesh, arguments.hard, 1);
        pool.install(|| {
            let contenders = contenders(&arguments, &mesh);
            let speeds = speeds(&contenders, typical.rays(), arguments.rounds);
            for (contender, speed) in contenders.iter().zip(speeds) {
                for (rays_of, sample) in [("typical", &typical), ("hard", &hard)] {
                    report.add(Row {
                        scene: name.clone(),
                        triangles: mesh.triangles.len(),
                        method: contender.rival.name().to_string(),
                        family: contender.family,
                        test: contender.test,
                        handling: contender.handling.clone(),
                        bytes: contender.rival.bytes(),
                        build: contender.build,
                        speed,
                        rays_of,
                        accuracy: sample.judge(&answers(&*contender.rival, sample.rays())),
                    });
                }
            }
        });
    }
    report.print();
    if let Err(error) = report.write(&arguments.out) {
        eprintln!("cannot write to {}: {error}", arguments.out.display());
        std::process::exit(1);
    }
}

/// Real scenes by the start of their names, or a sphere where there are none.
fn chosen(names: &[String]) -> Vec<(String, Mesh, bool)> {
    let is_chosen = |name: &str| match names {
        [] => name == "bunny",
        _ => names.iter().any(|chosen| name.starts_with(chosen.as_str())),
    };
    let chosen = scenes::REAL.into_iter().filter(|real| is_chosen(real.name)).filter_map(|real| {
        let path = scenes::real(real.file, real.name)?;
        let mesh = leafwalk::load_mesh(&path).expect("a readable scene").mesh.into_f32();
        Some((real.name.to_string(), mesh, real.inside))
    });
    let chosen: Vec<_> = chosen.collect();
    if chosen.is_empty() { vec![("bumpy sphere".into(), meshes::bumpy_sphere(5, 1), false)] } else { chosen }
}

fn contenders(arguments: &Arguments, mesh: &Mesh) -> Vec<Contender> {
    let is_wanted = |method: &Method| {
        let is_named = arguments.methods.is_empty() || arguments.methods.iter().any(|part| method.name.contains(part));
        is_named && SMALL.iter().all(|(family, most)| method.family != *family || mesh.triangles.len() <= *most)
    };
    let ours = methods::all().into_iter().filter(is_wanted).map(|method| {
        let (built, build) = timed(|| method.build(mesh).expect("a mesh that builds"));
        let Built { tracer, bytes } = built;
        Contender {
            rival: ours::any(method.name, tracer, bytes),
            family: method.family,
            test: method.test,
            handling: method.handling.to_string(),
            build: Some(build),
        }
    });
    let others = leafwalk_rivals::all(mesh).into_iter().filter(|rival| {
        arguments.methods.is_empty() || arguments.methods.iter().any(|part| rival.name().contains(part.as_str()))
    });
    let others = others.map(|rival| Contender {
        family: if rival.name().starts_with("embree") { "Embree" } else { "others" },
        test: "its own",
        handling: "its own".into(),
        build: rival.rebuild(mesh),
        rival,
    });
    ours.chain(others).collect()
}

/// The closest hits as the tracer gives them; weights are not judged.
fn answers(rival: &dyn Rival, rays: &[Ray]) -> Vec<Hit> {
    let mut prepared = rival.closest(rays);
    prepared.trace();
    let hit = |answer: leafwalk_rivals::Answer| Hit { t: answer.t, u: 0.0, v: 0.0, primitive: answer.primitive };
    prepared.answers().into_iter().map(hit).collect()
}

/// Millions of rays a second: the median of rounds in which all take turns.
fn speeds(contenders: &[Contender], rays: &[Ray], rounds: u32) -> Vec<f64> {
    let mut prepared: Vec<Box<dyn Prepared<_> + '_>> =
        contenders.iter().map(|contender| contender.rival.closest(rays)).collect();
    let mut times = vec![Vec::new(); contenders.len()];
    for round in 0..=rounds {
        for (batch, times) in prepared.iter_mut().zip(&mut times) {
            batch.reset();
            let ((), time) = timed(|| batch.trace());
            // The first round warms up.
            if round > 0 {
                times.push(time.as_secs_f64());
            }
        }
    }
    times.into_iter().map(|mut times| rays.len() as f64 / quantile(&mut times, 0.5) / 1e6).collect()
}
