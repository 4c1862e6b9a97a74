//! Every leaf leads to every triangle that meets its dilated cell, by an oracle of its own: the triangle is clipped to the
//! cell in f64.

use std::collections::HashSet;

use leafwalk::{Builder, Mesh};
use leafwalk_core::contract::{PADDING, ROUNDOFF};
use leafwalk_core::layout::{Key, LATTICE, Triangle};
use leafwalk_testing::listing::triangles_of;
use leafwalk_testing::meshes;
use leafwalk_testing::random::Random;
use rayon::prelude::*;

/// The builder sees corners from the root's corner, which may move them by half a roundoff of the root's edge. A part that
/// is left of the cell shrunk by this really meets the cell.
const CERTAIN: f64 = (ROUNDOFF * LATTICE as f32) as f64;
/// Binning is conservative by that, too, and for needles by more; a triangle further away than this from the dilated cell
/// has no business in the leaf.
const GENEROUS: f64 = 2.0 * CERTAIN;

/// Whether a part of the triangle is left inside the cell dilated by `reach` (Sutherland & Hodgman 1974).
fn meets(corners: &[[f64; 3]; 3], key: Key, reach: f64) -> bool {
    let (lower, upper) = key.bounds();
    let mut polygon = corners.to_vec();
    for (k, sign) in (0..6).map(|i| (i / 2, if i % 2 == 0 { 1.0 } else { -1.0 })) {
        let plane = if sign > 0.0 { f64::from(lower[k]) - reach } else { f64::from(upper[k]) + reach };
        let inside = |p: &[f64; 3]| sign * (p[k] - plane);
        let mut kept = Vec::new();
        for (i, a) in polygon.iter().enumerate() {
            let b = &polygon[(i + 1) % polygon.len()];
            let (da, db) = (inside(a), inside(b));
            if da >= 0.0 {
                kept.push(*a);
            }
            if (da >= 0.0) != (db >= 0.0) {
                let w = da / (da - db);
                kept.push(core::array::from_fn(|j| if j == k { plane } else { a[j] + w * (b[j] - a[j]) }));
            }
        }
        polygon = kept;
    }
    !polygon.is_empty()
}

fn check(name: &str, mesh: &Mesh, builder: &Builder) {
    let octree = builder.build(mesh).expect("a mesh that builds");
    let parts = octree.parts();
    let frame = parts.frame;
    let corners: Vec<[[f32; 3]; 3]> = (0..mesh.triangles.len())
        .map(|i| mesh.corners(i).map(|corner| frame.to_lattice(corner.map(f64::from))))
        .collect();
    let is_listed = |c: &[[f32; 3]; 3]| c[0] != c[1] && c[1] != c[2] && c[2] != c[0];
    let in_root = |corner: [f32; 3]| core::array::from_fn(|k| f64::from(corner[k]) - f64::from(frame.corner[k]));
    let leaves: Vec<_> = parts.leaves().collect();
    leaves.par_iter().for_each(|(number, leaf)| {
        let key = parts.key(*number);
        let listed = triangles_of(&parts, leaf);
        let set: HashSet<u32> = listed.iter().map(|triangle| triangle.primitive).collect();
        assert_eq!(set.len(), listed.len(), "{name}: leaf {number} leads to a triangle twice");
        let mut meets_any = false;
        for (primitive, corners) in (0..).zip(&corners).filter(|(_, corners)| is_listed(corners)) {
            let seen = corners.map(in_root);
            if meets(&seen, key, f64::from(PADDING) - CERTAIN) {
                assert!(set.contains(&primitive), "{name}: leaf {number} ({key:?}) lacks {primitive} {corners:?}");
            }
            meets_any |= set.contains(&primitive) && meets(&seen, key, f64::from(PADDING) + GENEROUS);
        }
        assert!(meets_any || set.is_empty(), "{name}: leaf {number} ({key:?}) lists what is far from it");
        for Triangle { primitive, corners: stored } in listed {
            assert_eq!(stored, corners[primitive as usize], "{name}: corners of {primitive}");
        }
    });
    let all: HashSet<u32> = parts.triangles().map(|triangle| triangle.primitive).collect();
    assert_eq!(all.len(), parts.triangles().count(), "{name}: each triangle stands in one lane");
    println!("{name}: {} leaves", leaves.len());
}

#[test]
fn no_reference_is_missing() {
    let fine = Builder::new().step_cost(0.5).reference_budget(64.0);
    check("soup", &meshes::soup(500, 71), &fine.clone().max_level(6));
    check("lattice soup", &lattice_soup(300), &fine.clone().max_level(5));
    check("needle box", &meshes::needle_box(25), &fine.clone().max_level(5));
    check("walls", &meshes::walls(40, 72), &fine.clone().max_level(5));
    check("sphere", &meshes::icosphere(3), &fine.clone().max_level(6));
    check("clump", &meshes::placed(&meshes::soup(150, 73), 1e-3, 1.0), &fine);
}

/// Small triangles whose corners lie on planes of cells, or one ULP off.
pub(crate) fn lattice_soup(count: u32) -> Mesh {
    // Around 0, so that planes of cells are multiples of powers of two.
    let reach = 1.0 - 1.0 / 64.0;
    let mut positions = vec![[-reach; 3], [reach; 3]];
    for i in 0..count {
        let mut random = Random::new(74, u64::from(i));
        let step = [0.0, 1.0 / 16.0, 1.0 / 8.0];
        let first = random.vector().map(|c| (c * 6.0).round() / 8.0);
        for _ in 0..3 {
            let corner = first.map(|c| c + step[random.below(3)]);
            positions.push(corner.map(|c| random.nudge(c)));
        }
    }
    let mut triangles: Vec<[u32; 3]> = (0..count).map(|i| [3 * i + 2, 3 * i + 3, 3 * i + 4]).collect();
    triangles.push([0, 1, 2]);
    Mesh::new(positions, triangles)
}
