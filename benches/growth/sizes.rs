//! One mesh in many sizes: coarser by merging the vertices of a grid's cells, finer by splitting triangles in four.

use core::iter::successors;
use std::collections::{HashMap, HashSet};

use leafwalk::Mesh;
use leafwalk_testing::random::Random;
use leafwalk_testing::rays::extent;

/// Cells of the coarsest grid, along the mesh's longest side; the dragon is left with about a thousand triangles.
const COARSEST: f32 = 15.0;
/// Splits in four: the dragon of 871,414 triangles becomes one of 13,942,624.
const SPLITS: u64 = 2;
/// How far a new vertex is moved off the middle of its edge, in lengths of the edge: so finer meshes have new shapes.
const DISPLACEMENT: f32 = 0.05;

/// From coarse to fine, each of about four times as many triangles as the one before.
pub(crate) fn all(mesh: &Mesh) -> impl Iterator<Item = Mesh> {
    let coarse = successors(Some(COARSEST), |cells| Some(2.0 * cells)).map(|cells| coarser(mesh, cells));
    let coarse = coarse.take_while(|coarse| 2 * coarse.triangles.len() < mesh.triangles.len());
    let fine = successors(Some((0, mesh.clone())), |(split, mesh)| {
        (*split < SPLITS).then(|| (split + 1, finer(mesh, *split)))
    });
    coarse.chain(fine.map(|(_, mesh)| mesh))
}

/// All vertices of a cell become the first of them; triangles that this leaves without extent, or twice, go.
fn coarser(mesh: &Mesh, cells: f32) -> Mesh {
    let (_, size) = extent(mesh);
    let cell = |p: [f32; 3]| p.map(|c| (c / size * cells).floor() as i32);
    let mut firsts = HashMap::new();
    let mut positions = Vec::new();
    let vertices: Vec<u32> = (mesh.positions.iter())
        .map(|p| {
            *firsts.entry(cell(*p)).or_insert_with(|| {
                positions.push(*p);
                positions.len() as u32 - 1
            })
        })
        .collect();
    let mut seen = HashSet::new();
    let mut is_new = |triangle: &[u32; 3]| {
        let mut corners = *triangle;
        corners.sort_unstable();
        corners[0] < corners[1] && corners[1] < corners[2] && seen.insert(corners)
    };
    let merged = mesh.triangles.iter().map(|triangle| triangle.map(|vertex| vertices[vertex as usize]));
    Mesh::new(positions, merged.filter(|triangle| is_new(triangle)).collect())
}

/// Each triangle split in four; neighbours share the vertices in between.
fn finer(mesh: &Mesh, seed: u64) -> Mesh {
    let mut positions = mesh.positions.clone();
    let mut middles = HashMap::new();
    let mut triangles = Vec::with_capacity(4 * mesh.triangles.len());
    for &[a, b, c] in &mesh.triangles {
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(a, b)| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let (p, q) = (positions[a as usize], positions[b as usize]);
                let length = (0..3).map(|k| (q[k] - p[k]).powi(2)).sum::<f32>().sqrt();
                let aside = Random::new(seed, positions.len() as u64).vector();
                let moved = |k| 0.5 * (p[k] + q[k]) + DISPLACEMENT * length * aside[k];
                positions.push(core::array::from_fn(moved));
                positions.len() as u32 - 1
            })
        });
        triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    Mesh::new(positions, triangles)
}
