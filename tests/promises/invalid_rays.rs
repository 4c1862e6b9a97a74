//! P5: an invalid ray misses and visits no leaf; unusual rays that are valid get their answers.

use leafwalk::{Builder, CpuTracer, Hit, Octree, Ray, Tracer, Work};
use leafwalk_core::step::{Pluecker, Slab, Step};
use leafwalk_core::testing::{self, Standard};
use leafwalk_testing::meshes;
use leafwalk_testing::random::Random;
use leafwalk_testing::rays::hex;
use leafwalk_testing::tally::bits;

fn sphere() -> Octree<Vec<u32>> {
    Builder::new().build(&meshes::icosphere(3)).expect("a mesh that builds")
}

/// A ray from inside the sphere: it hits.
fn valid(random: &mut Random) -> Ray {
    Ray::new(random.vector().map(|c| 0.4 * c), random.direction())
}

/// Every component of a valid ray made each kind of invalid number, and directions without a length.
fn invalid() -> Vec<Ray> {
    let nan = [f32::NAN, -f32::NAN, f32::from_bits(0x7f80_0001), f32::from_bits(0xffff_ffff)];
    let infinite = [f32::INFINITY, f32::NEG_INFINITY];
    let mut rays = Vec::new();
    for (i, &number) in nan.iter().chain(&infinite).enumerate() {
        for component in 0..8 {
            let mut ray = valid(&mut Random::new(101, (8 * i + component) as u64));
            let is_t_max = component == 7;
            match component {
                0..3 => ray.origin[component] = number,
                3 => ray.t_min = number,
                4..7 => ray.direction[component - 4] = number,
                _ => ray.t_max = number,
            }
            // An infinite t_max is no limit, or leaves nothing.
            if !is_t_max || number.is_nan() {
                rays.push(ray);
            }
        }
    }
    for signs in 0..8 {
        let zero = core::array::from_fn(|k| if signs >> k & 1 == 1 { -0.0 } else { 0.0 });
        rays.push(Ray::new([0.1, 0.2, 0.3], zero));
    }
    rays
}

fn visits_nothing<S: Step>(octree: &Octree<Vec<u32>>, ray: &Ray) {
    let parts = octree.parts();
    let walk = testing::walk::<S, Standard>(&parts);
    assert_eq!(walk.closest_hit_with_work(ray), (None, Work::default()), "{}", hex(ray));
    assert!(!walk.occluded(ray), "{}", hex(ray));
    walk.visit(ray, |record, _| panic!("visited record {record}: {}", hex(ray)));
}

#[test]
fn invalid_rays_miss_and_visit_nothing() {
    let octree = sphere();
    for ray in invalid() {
        assert!(!ray.is_valid(), "{}", hex(&ray));
        visits_nothing::<Slab>(&octree, &ray);
        visits_nothing::<Pluecker>(&octree, &ray);
    }
}

#[test]
fn invalid_rays_in_a_batch_leave_their_neighbours_alone() {
    let octree = sphere();
    let invalid = invalid();
    let count = 20_000;
    // Runs of both kinds, of all lengths that a packet could be left with.
    let is_invalid = |i: usize| Random::new(102, (i / 3) as u64).below(2) == 0;
    let ray =
        |i: usize| if is_invalid(i) { invalid[i % invalid.len()] } else { valid(&mut Random::new(103, i as u64)) };
    let rays: Vec<Ray> = (0..count).map(ray).collect();
    let tracer = CpuTracer::new(octree.view());
    let (mut hits, mut occluded) = (vec![Hit { t: 1.0, u: 2.0, v: 3.0, primitive: 4 }; count], vec![true; count]);
    tracer.closest_hits(&rays, &mut hits).expect("equal lengths");
    tracer.occlusions(&rays, &mut occluded).expect("equal lengths");
    for i in 0..count {
        let (walked, work) = octree.closest_hit_with_work(&rays[i]);
        assert_eq!(bits(&hits[i]), bits(&Hit::from(walked)), "{}", hex(&rays[i]));
        if is_invalid(i) {
            assert_eq!((bits(&hits[i]), occluded[i]), (bits(&Hit::MISS), false), "{}", hex(&rays[i]));
            assert_eq!(work, Work::default(), "{}", hex(&rays[i]));
        } else {
            assert!(!hits[i].is_miss() && occluded[i] && work.cells > 0, "{}", hex(&rays[i]));
        }
    }
}

/// The hit of a ray along x from inside, with its direction scaled.
fn along_x(octree: &Octree<Vec<u32>>, origin_x: f32, scale: f32) -> Hit {
    octree.closest_hit(&Ray::new([origin_x, 0.1, 0.2], [scale, 0.0, 0.0])).expect("a hit from inside")
}

#[test]
fn directions_of_any_length_give_the_same_hit() {
    let octree = sphere();
    let unit = along_x(&octree, 0.95, 1.0);
    for exponent in -149..=127 {
        let hit = along_x(&octree, 0.95, 2f64.powi(exponent) as f32);
        let t = (f64::from(unit.t) * 2f64.powi(-exponent)).min(f64::from(f32::MAX)) as f32;
        assert_eq!(bits(&hit), bits(&Hit { t, ..unit }), "direction 2^{exponent}");
    }
    // Not a power of two, and subnormal: the direction itself is rounded, t is not exact.
    let hit = along_x(&octree, 0.95, 1e-40);
    let direction = f64::from(1e-40f32);
    approx::assert_relative_eq!(f64::from(hit.t) * direction, f64::from(unit.t), max_relative = 1e-6);
    assert_eq!(hit.primitive, unit.primitive);
}

#[test]
fn a_t_beyond_all_numbers_is_the_largest() {
    // The wall is 0.5 away or more, which takes t above 2^128 where a direction is shorter than 2^-129.
    let octree = sphere();
    let hit = along_x(&octree, 0.1, 1e-40);
    assert_eq!(bits(&hit), bits(&Hit { t: f32::MAX, ..along_x(&octree, 0.1, 1.0) }));
}

#[test]
fn nothing_lies_between_limits_that_leave_nothing() {
    let octree = sphere();
    for (t_min, t_max) in [
        (1.0, 1.0),
        (0.9, 0.8),
        (0.0, 0.0),
        (0.0, -0.0),
        (-1.0, -2.0),
        (0.0, f32::NEG_INFINITY),
        (f32::MAX, f32::INFINITY),
    ] {
        for index in 0..100 {
            let ray = Ray { t_min, t_max, ..valid(&mut Random::new(104, index)) };
            assert_eq!(octree.closest_hit(&ray), None, "{}", hex(&ray));
            assert!(!octree.occluded(&ray), "{}", hex(&ray));
        }
    }
}

#[test]
fn negative_limits_reach_behind_the_origin() {
    let octree = sphere();
    for index in 0..1000 {
        let ahead = valid(&mut Random::new(105, index));
        // The same line from far behind: its first hit is the one behind the origin.
        let back = Ray { t_min: -100.0, t_max: 0.0, ..ahead };
        let behind = octree.closest_hit(&back).expect("a hit behind");
        assert!(behind.t < 0.0 && octree.occluded(&back), "{}", hex(&back));
        let turned = Ray::new(ahead.origin, ahead.direction.map(|c| -c));
        assert_eq!(octree.closest_hit(&turned).expect("a hit from inside").t, -behind.t, "{}", hex(&back));
        let whole = Ray { t_min: -100.0, ..ahead };
        assert_eq!(
            octree.closest_hit(&whole),
            Some(behind),
            "the closest is the one of the smallest t: {}",
            hex(&whole)
        );
    }
}
