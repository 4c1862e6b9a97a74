//! Scans a mesh as a laser scanner on a vehicle does, and writes what it saw to `lidar.ply` in the current folder: points
//! that know how much light came back. The y axis points up.
//!
//! `cargo run --release --example lidar -- sponza.obj`

mod mesh;

use core::error::Error;
use core::f32::consts::TAU;
use std::fs::File;
use std::io::{BufWriter, Write};

use glam::{DVec3, Quat, Vec3};
use leafwalk::{Builder, CpuTracer, Hit, Ray, Tracer};

const OUTPUT: &str = "lidar.ply";
/// Lasers above each other, from 25 degrees below the horizon to 15 above.
const LASERS: usize = 64;
const ELEVATIONS: [f32; 2] = [-25.0, 15.0];
/// How often all lasers fire in a revolution.
const SHOTS: usize = 1800;
const REVOLUTIONS: usize = 4;
/// What returns less than this share of its light is not noticed.
const LEAST_INTENSITY: f32 = 0.05;

fn main() -> Result<(), Box<dyn Error>> {
    let mesh = mesh::from_arguments()?;
    let octree = Builder::new().build(&mesh)?;
    let bounds = octree.bounds();
    let tracer = CpuTracer::new(octree);

    // The scanner moves through the middle half of the mesh along its longer side, low above its floor.
    let [lower, upper] = [bounds.lower, bounds.upper].map(|corner| DVec3::from(corner).as_vec3());
    let size = upper - lower;
    let way = if size.x > size.z { size * Vec3::X } else { size * Vec3::Z } * 0.5;
    let start = lower + size * Vec3::new(0.5, 0.2, 0.5) - 0.5 * way;

    let (mut points, mut lost) = (Vec::new(), 0);
    let mut hits = vec![Hit::MISS; SHOTS * LASERS];
    for revolution in 0..REVOLUTIONS {
        let shot = |shot: usize| {
            let time = (revolution as f32 + shot as f32 / SHOTS as f32) / REVOLUTIONS as f32;
            let turn = Quat::from_rotation_y(TAU * shot as f32 / SHOTS as f32);
            (0..LASERS).map(move |laser| {
                let [lowest, highest] = ELEVATIONS.map(f32::to_radians);
                let elevation = lowest + (highest - lowest) * laser as f32 / (LASERS - 1) as f32;
                Ray::new(start + way * time, turn * Vec3::new(elevation.cos(), elevation.sin(), 0.0))
            })
        };
        let rays: Vec<Ray> = (0..SHOTS).flat_map(shot).collect();
        tracer.closest_hits(&rays, &mut hits)?;
        for (ray, hit) in rays.iter().zip(&hits).filter(|(_, hit)| !hit.is_miss()) {
            let normal = Vec3::from(mesh.normal(hit.primitive as usize));
            // A matt surface returns the more light the more it faces the laser.
            let intensity = normal.dot(ray.direction.into()).abs();
            if intensity < LEAST_INTENSITY {
                lost += 1;
                continue;
            }
            points.push((mesh.position(hit), intensity));
        }
    }

    let mut file = BufWriter::new(File::create(OUTPUT)?);
    writeln!(file, "ply\nformat ascii 1.0\nelement vertex {}", points.len())?;
    for property in ["x", "y", "z", "intensity"] {
        writeln!(file, "property float {property}")?;
    }
    writeln!(file, "end_header")?;
    for ([x, y, z], intensity) in &points {
        writeln!(file, "{x} {y} {z} {intensity}")?;
    }
    file.flush()?;
    let shots = REVOLUTIONS * SHOTS * LASERS;
    println!("{shots} laser pulses: {} points in {OUTPUT}, {lost} too faint", points.len());
    Ok(())
}
