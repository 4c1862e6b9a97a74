//! Where tracers differ from one that is right.

use leafwalk_core::{Hit, Ray, Tracer};
use leafwalk_cpu::Mesh;

use super::rays;
use super::tally::{Tally, bits, tally};
use super::tracers::{Any, Named};
use crate::random::Random;

/// A ray of numbers that depend on nothing but the seed and the index.
pub type Source<'a> = &'a (dyn Fn(&mut Random) -> Ray + Sync);

/// Rays of every hard kind at a mesh.
pub fn hard(mesh: &Mesh) -> impl Fn(&mut Random) -> Ray + Sync + use<'_> {
    let (centre, size) = rays::extent(mesh);
    move |random: &mut Random| rays::hard(mesh, centre, size, random)
}

/// The rays on which a tracer differs from another that is right; half of the hits are traced with the ray cut next to
/// them instead.
///
/// # Panics
/// When a tracer fails.
pub fn differences(tracers: &[Named<'_>], oracle: Any<'_>, source: Source<'_>, count: u64, seed: u64) -> Tally {
    tally(count, |indices, tally| {
        let mut randoms: Vec<Random> = indices.clone().map(|index| Random::new(seed, index)).collect();
        let mut rays: Vec<Ray> = randoms.iter_mut().map(source).collect();
        let mut expected = vec![Hit::MISS; rays.len()];
        let mut found = expected.clone();
        let mut occluded = vec![false; rays.len()];
        oracle.closest_hits(&rays, &mut expected).expect("equal lengths");
        // Cut twice, a ray may be left with the gap between two hits.
        for _ in 0..2 {
            for ((ray, hit), random) in rays.iter_mut().zip(&mut expected).zip(&mut randoms) {
                if !hit.is_miss() && random.below(3) == 0 {
                    *ray = rays::cut(ray, hit.t, random);
                    oracle.closest_hits(&[*ray], core::slice::from_mut(hit)).expect("equal lengths");
                }
            }
        }
        for hit in &expected {
            tally.hit(!hit.is_miss());
        }
        for (name, tracer) in tracers {
            tracer.closest_hits(&rays, &mut found).expect("equal lengths");
            tracer.occlusions(&rays, &mut occluded).expect("equal lengths");
            for (i, index) in indices.clone().enumerate() {
                if bits(&found[i]) != bits(&expected[i]) || occluded[i] == expected[i].is_miss() {
                    tally.fault(index, || {
                        let (found, occluded, expected) = (found[i], occluded[i], expected[i]);
                        let ray = rays::hex(&rays[i]);
                        let place = format!("{name}, seed {seed}, ray {index}");
                        format!("{place}: {found:?}, occluded {occluded}, expected {expected:?}\n{ray}")
                    });
                }
            }
        }
    })
}
