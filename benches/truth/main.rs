//! How often ours and other tracers are wrong: answers to many rays, judged exactly on the caller's own mesh. No times.
//!
//! `cargo bench --bench truth [--features embree,tinybvh] [-- SCENE ...]` judges P, S, D and R of real scenes, found by
//! LEAFWALK_SCENES; without it, of a scene made in code. With `--wide` it judges scenes whose extent is far larger than
//! what is looked at, and scenes in UTM coordinates.

use clap::Parser;
use leafwalk::mesh_file::AnyMesh;
use leafwalk::{Builder, CpuTracer, HitF64, Mesh, Octree, Ray, RayF64};
use leafwalk_rivals::{Answer, Rival, ours};
use leafwalk_testing::random::Random;
use leafwalk_testing::scenes::{REAL, real};
use leafwalk_testing::truth::{Counts, Hit, Oracle, Verdict, per_million};
use leafwalk_testing::utm::{self, Utm};
use leafwalk_testing::wide::{self, Wide};
use leafwalk_testing::{meshes, workloads};

/// Judges tracers.
#[derive(Parser)]
struct Arguments {
    /// Beginnings of the names of scenes; all by default.
    scenes: Vec<String>,
    /// Only rivals with one of these in their names, comma-separated; ours run always.
    #[arg(long, value_delimiter = ',', default_value = "bvh,parry,embree single,embree ROBUST single")]
    rivals: Vec<String>,
    /// Primary rays are this many squared; a multiple of 8.
    #[arg(long, default_value_t = 1024)]
    side: u32,
    /// Judges the wide scenes, and those in UTM coordinates.
    #[arg(long)]
    wide: bool,
    /// Rays of each wide scene.
    #[arg(long, default_value_t = 100_000)]
    wide_rays: u64,
    /// Cargo passes it.
    #[arg(long, hide = true)]
    bench: bool,
}

impl Arguments {
    fn wants_scene(&self, name: &str) -> bool {
        self.scenes.is_empty() || self.scenes.iter().any(|part| name.starts_with(part.as_str()))
    }

    /// Ours, and the rivals that are wanted.
    fn tracers<'a>(&self, octree: &'a Octree<Vec<u32>>, mesh: &Mesh) -> Vec<Box<dyn Rival + 'a>> {
        let mut tracers = vec![ours::default(octree)];
        let is_wanted = |name: &str| self.rivals.iter().any(|part| name.contains(part.as_str()));
        let rivals = if self.wide { leafwalk_rivals::for_any_extent(mesh) } else { leafwalk_rivals::all(mesh) };
        tracers.extend(rivals.into_iter().filter(|rival| is_wanted(rival.name())));
        tracers
    }
}

fn main() {
    let arguments = Arguments::parse();
    if arguments.wide { judge_wide(&arguments) } else { judge_scenes(&arguments) }
}

fn judge_scenes(arguments: &Arguments) {
    let wanted = REAL.iter().filter(|scene| arguments.wants_scene(scene.name));
    let mut scenes: Vec<(&str, Mesh, bool)> = wanted
        .filter_map(|scene| {
            let path = real(scene.file, scene.name)?;
            let mesh = leafwalk::load_mesh(&path).expect("a readable scene").mesh.into_f32();
            Some((scene.name, mesh, scene.inside))
        })
        .collect();
    if scenes.is_empty() {
        scenes.push(("bumpy sphere", meshes::bumpy_sphere(6, 1), false));
    }
    println!("{:>14} {:>4} {:>24} {HEAD}", "", "", "");
    let mut totals: Vec<(String, Counts)> = Vec::new();
    for (name, mesh, inside) in scenes {
        let octree = Builder::new().build(&mesh).expect("a mesh that builds");
        let oracle = Oracle::new(&mesh);
        let tracers = arguments.tracers(&octree, &mesh);
        for workload in workloads::all(&octree, &mesh, inside, arguments.side) {
            let truths = oracle.closest_hits(&workload.rays);
            for rival in &tracers {
                let counts = match workload.is_occlusion {
                    true => occlusions(&**rival, &workload.rays, &truths),
                    false => closest(&oracle, &**rival, &workload.rays, &truths).0,
                };
                println!("{name:>14} {:>4} {:>24} {}", workload.name, rival.name(), row(&counts));
                match totals.iter_mut().find(|(name, _)| name == rival.name()) {
                    Some((_, total)) => *total += counts,
                    None => totals.push((rival.name().into(), counts)),
                }
            }
        }
    }
    for (name, total) in totals {
        println!("{:>14} {:>4} {name:>24} {}", "all", "PSDR", row(&total));
    }
}

fn judge_wide(arguments: &Arguments) {
    println!("{:>42} {:>24} {HEAD} {:>9} {:>9}", "", "", "error", "relative");
    for scene in wide::all().iter().filter(|scene| arguments.wants_scene(&scene.name)) {
        let Wide { name, mesh, .. } = scene;
        let octree = Builder::new().build(mesh).expect("a mesh that builds");
        let oracle = Oracle::new(mesh);
        let rays: Vec<Ray> = (0..arguments.wide_rays).map(|index| scene.ray(&mut Random::new(91, index))).collect();
        let truths = oracle.closest_hits(&rays);
        for rival in arguments.tracers(&octree, mesh) {
            let (counts, [error, relative]) = closest(&oracle, &*rival, &rays, &truths);
            println!("{name:>42} {:>24} {} {error:>9.1e} {relative:>9.1e}", rival.name(), row(&counts));
        }
    }
    for scene in utm::all().iter().filter(|scene| arguments.wants_scene(&scene.name)) {
        judge_utm(scene, arguments);
    }
}

/// Ours in f64, and all tracers in f32, judged by what the scene is in f64.
fn judge_utm(scene: &Utm, arguments: &Arguments) {
    let Utm { name, mesh, .. } = scene;
    let oracle = Oracle::new(mesh);
    let rays: Vec<RayF64> = (0..arguments.wide_rays).map(|index| scene.ray(&mut Random::new(91, index))).collect();
    let truths = oracle.closest_hits(&rays);
    let print = |tracer: &str, answers: &mut dyn Iterator<Item = (f64, u32)>| {
        let (counts, [error, relative]) = judge(&oracle, &rays, &truths, answers);
        println!("{name:>42} {tracer:>24} {} {error:>9.1e} {relative:>9.1e}", row(&counts));
    };
    let tracer = CpuTracer::new(Builder::new().build(mesh).expect("a mesh that builds"));
    let mut hits = vec![HitF64::MISS; rays.len()];
    tracer.closest_hits_f64(&rays, &mut hits).expect("equal lengths");
    print("leafwalk f64", &mut hits.iter().map(|hit| (hit.t, hit.primitive)));

    let rounded = AnyMesh::F64(mesh.clone()).into_f32();
    let octree = Builder::new().build(&rounded).expect("a mesh that builds");
    let rays: Vec<Ray> = rays.iter().map(|ray| Ray::from(*ray)).collect();
    for rival in arguments.tracers(&octree, &rounded) {
        let mut prepared = rival.closest(&rays);
        prepared.trace();
        let answers = prepared.answers().into_iter().map(|Answer { t, primitive }| (f64::from(t), primitive));
        print(rival.name(), &mut answers.into_iter());
    }
}

/// Judges closest hits; see [`judge`].
fn closest(oracle: &Oracle, rival: &dyn Rival, rays: &[Ray], truths: &[Option<Hit>]) -> (Counts, [f64; 2]) {
    let mut prepared = rival.closest(rays);
    prepared.trace();
    let answers = prepared.answers().into_iter().map(|Answer { t, primitive }| (f64::from(t), primitive));
    judge(oracle, rays, truths, answers)
}

/// Judges closest hits, each a t and a primitive. On the right surface, they are off by so much at most, in length and as a
/// share of t.
fn judge<R: Copy + Into<RayF64>>(
    oracle: &Oracle,
    rays: &[R],
    truths: &[Option<Hit>],
    answers: impl Iterator<Item = (f64, u32)>,
) -> (Counts, [f64; 2]) {
    let (mut counts, mut errors) = (Counts::default(), [0f64; 2]);
    for ((ray, truth), (t, primitive)) in rays.iter().zip(truths).zip(answers) {
        let verdict = oracle.judge(ray, truth.as_ref(), t, primitive);
        counts.add(verdict);
        if let (Verdict::Right | Verdict::Neighbour | Verdict::Off, Some(hit)) = (verdict, truth) {
            let ray: RayF64 = (*ray).into();
            let length = ray.direction.iter().map(|c| c * c).sum::<f64>().sqrt();
            let off = (t - hit.t).abs();
            errors = [errors[0].max(off * length), errors[1].max(off / hit.t.abs())];
        }
    }
    (counts, errors)
}

fn occlusions(rival: &dyn Rival, rays: &[Ray], truths: &[Option<Hit>]) -> Counts {
    let mut prepared = rival.occluded(rays);
    prepared.trace();
    Counts::of(truths.iter().zip(prepared.answers()).map(|(truth, is)| Verdict::on_occlusion(truth.as_ref(), is)))
}

/// Columns of [`row`]; faults come with the two shares between which theirs is with 95 % confidence.
const HEAD: &str = "      rays neighbour    off  wrong missed  false    faults per million (95 %)  ";

fn row(counts: &Counts) -> String {
    let Counts { rays, neighbours, off, wrong, missed, not_there } = *counts;
    let [share, low, high] = per_million(counts.faults(), rays);
    format!(
        "{rays:>10} {neighbours:>9} {off:>6} {wrong:>6} {missed:>6} {not_there:>6} {share:>10.3} {low:>8.3} {high:>10.3}"
    )
}
