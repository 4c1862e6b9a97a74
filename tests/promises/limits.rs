//! P8: a hit's t lies strictly between the ray's limits, so the loop over all hits of a ray ends.

use leafwalk::{BruteForce, Builder, CpuTracer, Hit, Mesh, Ray, Tracer};
use leafwalk_core::step::Slab;
use leafwalk_core::testing::{Policy, Standard};
use leafwalk_testing::differences::Source;
use leafwalk_testing::random::Random;
use leafwalk_testing::rays::{Target, extent, hex, point_on, towards};
use leafwalk_testing::tally::{Tally, scaled, tally};
use leafwalk_testing::tracers::{Named, Stepping};
use leafwalk_testing::{meshes, rays};

const RAYS: u64 = 4_000;

/// Rays from inside and from up to 1e7 sizes away, in directions of all lengths.
fn from_anywhere(mesh: &Mesh) -> impl Fn(&mut Random) -> Ray + Sync + use<'_> {
    let (centre, size) = extent(mesh);
    move |random: &mut Random| {
        let distance = size * 10f32.powf(8.0 * random.unit() - 1.0);
        let away = random.direction();
        let origin = core::array::from_fn(|k| centre[k] + distance * away[k]);
        let target = [Target::Inside, Target::Edge][random.below(2)];
        let ray = towards(origin, point_on(mesh, target, random));
        let scale = 2f32.powi(random.below(60) as i32 - 30);
        Ray { direction: ray.direction.map(|c| c * scale), ..ray }
    }
}

/// The rays that give a hit outside their limits, or lose one that lies between them: cut at hits, and between the
/// numbers next to them.
fn faults(tracers: &[Named<'_>], oracle: &BruteForce, source: Source<'_>, count: u64, seed: u64) -> Tally {
    tally(count, |indices, tally| {
        for index in indices {
            let mut random = Random::new(seed, index);
            let ray = source(&mut random);
            // All that the ray hits, by what is reported without limits: the hits behind its origin, too.
            let all = oracle.every_hit(&Ray { t_min: -f32::MAX, ..ray });
            tally.hit(!all.is_empty());
            let Some(cut) = all.get(random.below(all.len().max(1))) else { continue };
            let beside = |random: &mut Random| match random.below(3) {
                0 => cut.t,
                1 => cut.t.next_up(),
                _ => cut.t.next_down(),
            };
            let limits = match random.below(4) {
                0 => (beside(&mut random), f32::INFINITY),
                1 => (-f32::MAX, beside(&mut random)),
                2 => (cut.t.next_down(), cut.t.next_up()),
                _ => (beside(&mut random), beside(&mut random)),
            };
            let ray = Ray { t_min: limits.0, t_max: limits.1, ..ray };
            let between = |hit: &&Hit| ray.t_min < hit.t && hit.t < ray.t_max;
            let expected = all.iter().find(between).map(|hit| hit.t);
            for (name, tracer) in tracers {
                let mut hit = [Hit::MISS];
                tracer.closest_hits(&[ray], &mut hit).expect("equal lengths");
                let found = hit[0].ok().map(|hit| hit.t);
                if found != expected {
                    tally.fault(index, || {
                        format!("{name}, seed {seed}, ray {index}: {found:?}, not {expected:?}\n{}", hex(&ray))
                    });
                }
            }
        }
    })
}

fn check(name: &str, mesh: &Mesh, seed: u64) {
    let octree = Builder::new().build(mesh).expect("a mesh that builds");
    let oracle = BruteForce::new(mesh).expect("a mesh that builds");
    let batches = CpuTracer::new(octree.view());
    let tracers: [Named<'_>; 2] = [("the octree", &octree), ("batches", &batches)];
    let source = from_anywhere(mesh);
    faults(&tracers, &oracle, &source, scaled(RAYS), seed).passes(&format!("P8, {name}"), 0.5);
}

#[test]
fn hits_lie_strictly_between_the_limits() {
    check("icosphere", &meshes::icosphere(2), 161);
    check("soup", &meshes::soup(300, 162), 162);
    check("soup x 1e-3 + 10", &meshes::placed(&meshes::soup(300, 163), 1e-3, 10.0), 163);
    check("soup x 1e30", &meshes::placed(&meshes::soup(300, 164), 1e30, 0.0), 164);
    check("soup x 1e-38", &meshes::placed(&meshes::soup(300, 165), 1e-38, 0.0), 165);
}

#[derive(Clone, Copy)]
struct Rounded;
impl Policy for Rounded {
    const ROUNDS_LIMITS: bool = true;
}

#[test]
fn limits_that_are_rounded_are_noticed() {
    let mesh = meshes::soup(300, 166);
    let octree = Builder::new().build(&mesh).expect("a mesh that builds");
    let oracle = BruteForce::new(&mesh).expect("a mesh that builds");
    let (parts, source) = (octree.parts(), from_anywhere(&mesh));
    let sound = Stepping::<Slab, Standard>::new(&parts);
    faults(&[("the walk", &sound)], &oracle, &source, RAYS, 166).passes("limits where t crosses them", 0.5);
    let rounded = Stepping::<Slab, Rounded>::new(&parts);
    faults(&[("the walk", &rounded)], &oracle, &source, RAYS, 166).catches("rounded limits");
}

/// Restarted at each hit, a ray gives every distance that is reported once, in order, and then nothing.
#[test]
fn the_loop_over_all_hits_ends() {
    let mesh = meshes::soup(300, 167);
    let octree = Builder::new().build(&mesh).expect("a mesh that builds");
    let oracle = BruteForce::new(&mesh).expect("a mesh that builds");
    let tracer = CpuTracer::new(octree.view());
    let sources: [Source<'_>; 2] = [&from_anywhere(&mesh), &|random: &mut Random| {
        let (centre, size) = extent(&mesh);
        rays::hard(&mesh, centre, size, random)
    }];
    for (source, seed) in sources.into_iter().zip(167..) {
        let mut several = 0;
        for index in 0..2000 {
            let mut ray = source(&mut Random::new(seed, index));
            let mut expected: Vec<f32> = oracle.every_hit(&ray).iter().map(|hit| hit.t).collect();
            expected.dedup();
            several += u32::from(expected.len() > 1);
            let mut found = Vec::new();
            while let Some(hit) = tracer.closest_hit(&ray) {
                found.push(hit.t);
                ray.t_min = hit.t;
                assert!(found.len() <= expected.len(), "{}", hex(&ray));
            }
            assert_eq!(found, expected, "{}", hex(&ray));
        }
        assert!(several > 300, "{several} rays with several hits");
    }
}
