//! Traces on a GPU, or on the CPU where there is none that can. The hits have the same bits either way.
//!
//! `cargo run --release --features gpu --example gpu -- mesh.ply`; the variable LEAFWALK_ADAPTER chooses the GPU by a
//! part of its name, or by `software`.

mod mesh;

use core::error::Error;
use std::time::Instant;

use glam::{DVec3, Vec3};
use leafwalk::gpu::{AdapterChoice, Flavour, GpuTracer};
use leafwalk::{Builder, CpuTracer, Hit, Ray, Tracer, hit_hash};

/// Rays to a square of so many points on each side.
const SIDE: usize = 1024;

/// Traces a batch by either tracer, and returns the hash of its hits.
fn trace<T: Tracer>(tracer: &T, rays: &[Ray]) -> Result<u64, T::Error> {
    let mut hits = vec![Hit::MISS; rays.len()];
    let start = Instant::now();
    tracer.closest_hits(rays, &mut hits)?;
    let seconds = start.elapsed().as_secs_f64();
    let count = hits.iter().filter(|hit| !hit.is_miss()).count();
    println!("{} rays, {count} of them hit, in {seconds:.3} s", rays.len());
    Ok(hit_hash(&hits))
}

fn main() -> Result<(), Box<dyn Error>> {
    // Who walks from leaf to leaf, as GPUs do, is faster with smaller leaves.
    let octree = Builder::for_walks().build(&mesh::from_arguments()?)?;

    let bounds = octree.bounds();
    let [lower, upper] = [bounds.lower, bounds.upper].map(|corner| DVec3::from(corner).as_vec3());
    let eye = 0.5 * (lower + upper) + Vec3::new(0.3, 0.7, 1.0) * (upper - lower).length();
    let target = |k: usize| {
        let [x, y] = [k % SIDE, k / SIDE].map(|place| (place as f32 + 0.5) / SIDE as f32);
        lower + (upper - lower) * Vec3::new(x, y, 1.0 - y)
    };
    let rays: Vec<Ray> = (0..SIDE * SIDE).map(|k| Ray::new(eye, target(k) - eye)).collect();

    let gpu = GpuTracer::new(&octree, AdapterChoice::from_environment(), Flavour::Exact);
    let cpu = CpuTracer::new(octree);
    match gpu {
        Ok(gpu) => {
            println!("{}: {}", gpu.adapter(), gpu.exactness());
            let is_equal = trace(&gpu, &rays)? == trace(&cpu, &rays)?;
            println!("the CPU, which traced second, has {} bits", if is_equal { "the same" } else { "other" });
        }
        Err(error) => {
            println!("the CPU stands in, since: {error}");
            trace(&cpu, &rays)?;
        }
    }
    Ok(())
}
