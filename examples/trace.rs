//! Traces a batch of rays, one for each pixel of a picture, on all cores, and prints a small copy of the picture.
//!
//! `cargo run --release --example trace -- mesh.ply`

mod mesh;

use core::error::Error;
use std::time::Instant;

use glam::{DVec3, Vec3};
use leafwalk::{Builder, CpuTracer, Hit, Ray, Tracer};

const WIDTH: usize = 1024;
const HEIGHT: usize = 768;
/// From black to white.
const SHADES: &[u8] = b".:-=+*#%@";

fn main() -> Result<(), Box<dyn Error>> {
    let mesh = mesh::from_arguments()?;
    let start = Instant::now();
    let octree = Builder::new().build(&mesh)?;
    println!("{} triangles, built in {:.3} s", mesh.triangles.len(), start.elapsed().as_secs_f64());

    // A camera that looks down on the whole mesh.
    let bounds = octree.bounds();
    let [lower, upper] = [bounds.lower, bounds.upper].map(|corner| DVec3::from(corner).as_vec3());
    let back = Vec3::new(0.3, 0.7, 1.0).normalize();
    let right = Vec3::Y.cross(back).normalize();
    let up = back.cross(right);
    let eye = 0.5 * (lower + upper) + 1.2 * (upper - lower).length() * back;

    // Rays that are neighbours in the picture are neighbours in the slice: that is how a batch goes fastest.
    let through = |pixel: usize| {
        let x = (pixel % WIDTH) as f32 / WIDTH as f32 - 0.5;
        let y = (pixel / WIDTH) as f32 / HEIGHT as f32 - 0.5;
        Ray::new(eye, right * x - up * (y * HEIGHT as f32 / WIDTH as f32) - back)
    };
    let rays: Vec<Ray> = (0..WIDTH * HEIGHT).map(through).collect();

    let tracer = CpuTracer::new(octree);
    let mut hits = vec![Hit::MISS; rays.len()];
    let start = Instant::now();
    tracer.closest_hits(&rays, &mut hits)?;
    let seconds = start.elapsed().as_secs_f64();

    // A triangle is the brighter the more it faces the camera.
    let shade = |ray: &Ray, hit: &Hit| {
        if hit.is_miss() {
            return ' ';
        }
        let normal = Vec3::from(mesh.normal(hit.primitive as usize));
        let facing = normal.dot(Vec3::from(ray.direction).normalize()).abs();
        SHADES[(facing * (SHADES.len() - 1) as f32).round() as usize].into()
    };
    for row in (0..HEIGHT).step_by(HEIGHT / 32) {
        let pixels = (0..WIDTH).step_by(WIDTH / 80).map(|column| row * WIDTH + column);
        let line: String = pixels.map(|pixel| shade(&rays[pixel], &hits[pixel])).collect();
        println!("{}", line.trim_end());
    }
    let count = hits.iter().filter(|hit| !hit.is_miss()).count();
    println!("{} rays, {count} of them hit, in {seconds:.3} s", rays.len());
    Ok(())
}
