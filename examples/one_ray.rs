//! Follows light through a mesh of mirrors, one ray after another: where a ray starts is known only when the one before
//! it has its hit, so they cannot be a batch.
//!
//! `cargo run --release --example one_ray -- mesh.ply`

mod mesh;

use core::error::Error;

use glam::{DVec3, Vec3};
use leafwalk::{Builder, CpuTracer, Ray};

const BEAMS: usize = 20_000;
const MOST_MIRRORS: usize = 8;
/// Multiples of these, without their whole parts, fill a cube evenly.
const STRIDES: Vec3 = Vec3::new(0.819_172_5, 0.671_043_6, 0.549_700_5);

fn main() -> Result<(), Box<dyn Error>> {
    let mesh = mesh::from_arguments()?;
    let octree = Builder::new().build(&mesh)?;
    let bounds = octree.bounds();
    let frame = octree.frame();
    let tracer = CpuTracer::new(octree);

    // A lamp above the mesh sends its light to points all over the mesh's box.
    let [lower, upper] = [bounds.lower, bounds.upper].map(|corner| DVec3::from(corner).as_vec3());
    let lamp = 0.5 * (lower + upper) + Vec3::new(0.3, 1.0, 0.2) * (upper - lower).length();

    let mut beams = [0; MOST_MIRRORS + 1];
    let mut length = 0.0;
    for beam in 0..BEAMS {
        let target = lower + (upper - lower) * (beam as f32 * STRIDES).fract();
        let mut ray = Ray::new(lamp, (target - lamp).normalize());
        let mut mirrors = 0;
        while mirrors < MOST_MIRRORS
            && let Some(hit) = tracer.closest_hit(&ray)
        {
            let primitive = hit.primitive as usize;
            let reflected = Vec3::from(ray.direction).reflect(mesh.normal(primitive).into());
            // It starts a little off the triangle, on the side that it leads to, and so does not hit the triangle again.
            ray = hit.spawn(&frame, &mesh.corners(primitive), reflected.to_array());
            mirrors += 1;
            length += f64::from(hit.t);
        }
        beams[mirrors] += 1;
    }

    for (mirrors, count) in beams.iter().enumerate() {
        println!("{count:6} beams met {mirrors} mirrors");
    }
    println!("from the lamp to its last mirror a beam goes {:.3} units on average", length / BEAMS as f64);
    Ok(())
}
