//! Bakes ambient occlusion: a vertex is the brighter the more of its surroundings is open. Writes the mesh with these
//! colours to `ambient_occlusion.ply` in the current folder.
//!
//! `cargo run --release --example ambient_occlusion -- mesh.ply`

mod mesh;

use core::error::Error;
use core::f64::consts::TAU;
use std::fs::File;
use std::io::{BufWriter, Write};

use glam::{DVec3, DVec4, Vec2, Vec3};
use leafwalk::{Builder, CpuTracer, Hit, Ray, Tracer};

const OUTPUT: &str = "ambient_occlusion.ply";
const RAYS_PER_TRIANGLE: usize = 64;
/// How many triangles send their rays at a time.
const BATCH: usize = 4096;
/// What is farther away than this share of the octree's edge takes no light away.
const REACH: f64 = 0.2;
/// Multiples of these, without their whole parts, fill a cube of four dimensions evenly.
const STRIDES: DVec4 = DVec4::new(0.856_674_883_9, 0.733_891_856_6, 0.628_706_721_0, 0.538_597_257_2);

fn main() -> Result<(), Box<dyn Error>> {
    let mesh = mesh::from_arguments()?;
    let octree = Builder::new().build(&mesh)?;
    let frame = octree.frame();
    let tracer = CpuTracer::new(octree);

    // One ray of many, from somewhere on the front of a triangle.
    let ray = |k: usize| {
        let primitive = k / RAYS_PER_TRIANGLE;
        let normal = Vec3::from(mesh.normal(primitive)).as_dvec3();
        let [u, v, height, turn] = (STRIDES * k as f64).fract().to_array();
        // Half of the square of all (u, v) is the triangle; the other half is turned onto it.
        let [u, v] = if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] }.map(|weight| weight as f32);
        let point = Hit { t: 0.0, u, v, primitive: primitive as u32 };
        // To a point of the sphere that touches the triangle: many rays go straight up, few along the triangle.
        let (radius, angle) = (2.0 * (height - height * height).sqrt(), TAU * turn);
        let around = DVec3::new(radius * angle.cos(), radius * angle.sin(), 1.0 - 2.0 * height);
        let direction = (normal + around).normalize_or_zero().as_vec3();
        Ray {
            t_max: (REACH * frame.scale()) as f32,
            ..point.spawn(&frame, &mesh.corners(primitive), direction.to_array())
        }
    };

    // For each vertex, how many rays its triangles sent, and how many of them were free.
    let mut light = vec![Vec2::ZERO; mesh.positions.len()];
    let mut occluded = vec![false; BATCH * RAYS_PER_TRIANGLE];
    for (batch, triangles) in mesh.triangles.chunks(BATCH).enumerate() {
        let first = batch * BATCH * RAYS_PER_TRIANGLE;
        let rays: Vec<Ray> = (first..first + triangles.len() * RAYS_PER_TRIANGLE).map(ray).collect();
        tracer.occlusions(&rays, &mut occluded[..rays.len()])?;
        for (vertices, occluded) in triangles.iter().zip(occluded.chunks(RAYS_PER_TRIANGLE)) {
            let free = occluded.iter().filter(|is_occluded| !**is_occluded).count();
            for vertex in vertices {
                light[*vertex as usize] += Vec2::new(RAYS_PER_TRIANGLE as f32, free as f32);
            }
        }
    }

    let mut file = BufWriter::new(File::create(OUTPUT)?);
    writeln!(file, "ply\nformat ascii 1.0\nelement vertex {}", mesh.positions.len())?;
    writeln!(file, "property float x\nproperty float y\nproperty float z")?;
    writeln!(file, "property uchar red\nproperty uchar green\nproperty uchar blue")?;
    writeln!(file, "element face {}\nproperty list uchar int vertex_indices\nend_header", mesh.triangles.len())?;
    for ([x, y, z], light) in mesh.positions.iter().zip(light) {
        let grey = (255.0 * light.y / light.x.max(1.0)) as u8;
        writeln!(file, "{x} {y} {z} {grey} {grey} {grey}")?;
    }
    for [a, b, c] in &mesh.triangles {
        writeln!(file, "3 {a} {b} {c}")?;
    }
    file.flush()?;
    println!("{OUTPUT}: {} vertices with colours, {RAYS_PER_TRIANGLE} rays a triangle", mesh.positions.len());
    Ok(())
}
