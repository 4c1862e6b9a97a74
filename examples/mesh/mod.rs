//! The mesh that an example runs with: the file that the command line names, or a courtyard made in code.

use core::error::Error;
use std::env;

use glam::Vec3;
use leafwalk::{Mesh, load_mesh};

/// Reads the mesh file (OBJ, PLY or STL) that is the first argument, or makes the courtyard where there is none.
pub(crate) fn from_arguments() -> Result<Mesh, Box<dyn Error>> {
    match env::args_os().nth(1) {
        Some(path) => Ok(load_mesh(path)?.mesh.into_f32()),
        None => Ok(courtyard()),
    }
}

/// A floor with nine columns on it and a wall around it: 12 units wide and deep, 3 high, open above. The y axis points
/// up.
fn courtyard() -> Mesh {
    let mut mesh = Mesh::default();
    // A box seen from inside, without its lid.
    let (size, height) = (12.0 * Vec3::ONE, 3.0 * Vec3::Y);
    let (x, z) = (size * Vec3::X, size * Vec3::Z);
    add_rectangle(&mut mesh, Vec3::ZERO, z, x);
    for (corner, along) in [(Vec3::ZERO, x), (z, -z), (x, z), (x + z, -x)] {
        add_rectangle(&mut mesh, corner, along, height);
    }
    // Boxes seen from outside, without their undersides.
    for column in 0..9 {
        let at = Vec3::new(1.5 + 4.0 * (column % 3) as f32, 0.0, 1.5 + 4.0 * (column / 3) as f32);
        let (height, x, z) = ((1.0 + 0.25 * column as f32) * Vec3::Y, Vec3::X, Vec3::Z);
        add_rectangle(&mut mesh, at + height, z, x);
        for (corner, along) in [(Vec3::ZERO, z), (x, -x), (z, x), (x + z, -z)] {
            add_rectangle(&mut mesh, at + corner, along, height);
        }
    }
    mesh
}

/// Adds a rectangle, in squares of a quarter of a unit, to be seen from where `along` turns counter-clockwise to `up`.
fn add_rectangle(mesh: &mut Mesh, corner: Vec3, along: Vec3, up: Vec3) {
    let [columns, rows] = [along, up].map(|edge| (4.0 * edge.length()).round() as u32);
    let first = mesh.positions.len() as u32;
    for row in 0..=rows {
        for column in 0..=columns {
            let position = corner + along * (column as f32 / columns as f32) + up * (row as f32 / rows as f32);
            mesh.positions.push(position.to_array());
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let low = first + row * (columns + 1) + column;
            let high = low + columns + 1;
            mesh.triangles.extend([[low, low + 1, high + 1], [low, high + 1, high]]);
        }
    }
}
