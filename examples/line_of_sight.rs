//! Finds which points of a mesh's box see each other, and prints that as a matrix.
//!
//! `cargo run --release --example line_of_sight -- mesh.ply`

mod mesh;

use core::error::Error;

use glam::{DVec3, Vec3};
use leafwalk::{Builder, CpuTracer, Ray, Tracer};

/// Points along the x axis and along the z axis; all are at half the height.
const GRID: [usize; 2] = [6, 4];

fn main() -> Result<(), Box<dyn Error>> {
    let mesh = mesh::from_arguments()?;
    let octree = Builder::new().build(&mesh)?;
    let bounds = octree.bounds();
    let tracer = CpuTracer::new(octree);

    let [lower, upper] = [bounds.lower, bounds.upper].map(|corner| DVec3::from(corner).as_vec3());
    let at = |k: usize| {
        let [x, z] = [k % GRID[0], k / GRID[0]].map(|place| place as f32 + 0.5);
        lower + (upper - lower) * Vec3::new(x / GRID[0] as f32, 0.5, z / GRID[1] as f32)
    };
    let points: Vec<Vec3> = (0..GRID[0] * GRID[1]).map(at).collect();

    // With the way to the other point as its direction, a ray is there at t = 1. What lies behind does not matter.
    let pairs: Vec<[usize; 2]> = (0..points.len()).flat_map(|a| (0..a).map(move |b| [a, b])).collect();
    let between = |&[a, b]: &[usize; 2]| Ray::between(points[a], points[b] - points[a], 0.0, 1.0);
    let rays: Vec<Ray> = pairs.iter().map(between).collect();
    let mut occluded = vec![false; rays.len()];
    tracer.occlusions(&rays, &mut occluded)?;

    let mut sees = vec![vec![true; points.len()]; points.len()];
    for ([a, b], occluded) in pairs.iter().zip(&occluded) {
        (sees[*a][*b], sees[*b][*a]) = (!occluded, !occluded);
    }
    for (row, point) in sees.iter().zip(&points) {
        let row: String = row.iter().map(|sees| if *sees { " *" } else { " ." }).collect();
        println!("{row}   from {point:8.3}");
    }
    let blocked = occluded.iter().filter(|occluded| **occluded).count();
    println!("of {} pairs, {} see each other and {blocked} do not", pairs.len(), pairs.len() - blocked);
    Ok(())
}
