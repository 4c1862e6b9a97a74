//! A mesh in lattice coordinates.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

use leafwalk_core::Frame;
use leafwalk_core::contract::SMALLEST;
use leafwalk_core::layout::{LATTICE, Triangle};
use leafwalk_core::testing::frame_touching;
use rayon::prelude::*;

use super::error::BuildError;
use super::focus::focus;
use crate::mesh::{MeshRef, Positions};

/// Bytes that the normalised mesh takes, and what it is made from.
pub(crate) fn bytes_needed(mesh: MeshRef<'_>) -> u64 {
    let triangle = size_of::<Triangle>();
    let sorted = match mesh.positions {
        Positions::F32(_) => 0,
        Positions::F64(_) => size_of::<f64>(),
    };
    let vertex = size_of::<[f32; 3]>() + size_of::<AtomicBool>() + sorted;
    mesh.triangles.len() as u64 * triangle as u64 + mesh.positions.len() as u64 * vertex as u64
}

/// What is left of a mesh for an octree to list.
#[derive(Clone, Debug)]
pub(crate) struct Normalised {
    pub(crate) frame: Frame,
    /// The triangles by ascending primitive.
    pub(crate) triangles: Vec<Triangle>,
    /// Left out: two corners are equal on the lattice, or one is not finite (lenient builds).
    pub(crate) dropped: u32,
    /// Dropped triangles that had three different corners before.
    pub(crate) collapsed: u32,
    /// The largest move of a coordinate by rounding, in lattice steps.
    pub(crate) rounding: f32,
}

/// Which triangles a build refuses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NonFinite {
    Refused,
    Dropped,
}

pub(crate) fn normalise(mesh: MeshRef<'_>) -> Result<Normalised, BuildError> {
    normalise_with(mesh, NonFinite::Refused)
}

/// [`normalise`] with vertices on the root's faces, which the contract forbids.
pub(crate) fn normalise_touching(mesh: MeshRef<'_>) -> Result<Normalised, BuildError> {
    normalise_into(mesh, NonFinite::Refused, frame_touching)
}

pub(crate) fn normalise_with(mesh: MeshRef<'_>, non_finite: NonFinite) -> Result<Normalised, BuildError> {
    normalise_into(mesh, non_finite, Frame::focused)
}

fn normalise_into(
    mesh: MeshRef<'_>,
    non_finite: NonFinite,
    frame: impl Fn([[f64; 3]; 2], [[f64; 3]; 2]) -> Frame,
) -> Result<Normalised, BuildError> {
    match mesh.positions {
        Positions::F32(positions) => normalise_positions(mesh, positions, non_finite, frame),
        Positions::F64(positions) => normalise_positions(mesh, positions, non_finite, frame),
    }
}

/// [`normalise`] of the mesh's positions in their own precision.
fn normalise_positions<S: Copy + Sync + Into<f64>>(
    mesh: MeshRef<'_>,
    positions: &[[S; 3]],
    non_finite: NonFinite,
    make_frame: impl Fn([[f64; 3]; 2], [[f64; 3]; 2]) -> Frame,
) -> Result<Normalised, BuildError> {
    check_counts(mesh)?;
    let used = used_vertices(mesh, positions, non_finite)?;
    let in_use = positions.par_iter().zip(&used).filter(|(_, used)| used.load(Relaxed));
    let empty = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    let bounds = in_use.fold(|| empty, |bounds, (position, _)| join(bounds, [wide(position); 2]));
    let bounds = bounds.reduce(|| empty, join);
    let bounds = if bounds[0][0] <= bounds[1][0] { bounds } else { [[0.0; 3]; 2] };
    let mut vertices = vec![LEFT_OUT; positions.len()];
    let mut place = |frame: Frame| (frame, place(positions, &used, &frame, &mut vertices));
    let (mut frame, mut rounding) = place(make_frame(bounds, bounds));
    // Numbers under the smallest become the anchor, which rounds no vertex of f32.
    if rounding >= SMALLEST {
        let in_use = positions.iter().zip(&used).filter(|(_, used)| used.load(Relaxed));
        (frame, rounding) = place(make_frame(bounds, focus(in_use.map(|(position, _)| wide(position)))));
    }

    let (dropped, collapsed) = (AtomicU32::new(0), AtomicU32::new(0));
    let triangle = |(primitive, indices): (usize, &[u32; 3])| {
        let corners = indices.map(|index| vertices[index as usize]);
        if !is_listed(&corners) {
            dropped.fetch_add(1, Relaxed);
            let is_whole = !corners.contains(&LEFT_OUT) && !has_equal_corners(&mesh.corners(primitive));
            collapsed.fetch_add(u32::from(is_whole), Relaxed);
        }
        Triangle { primitive: primitive as u32, corners }
    };
    let mut triangles: Vec<_> = mesh.triangles.par_iter().enumerate().map(triangle).collect();
    let (dropped, collapsed) = (dropped.into_inner(), collapsed.into_inner());
    if dropped > 0 {
        triangles.retain(|triangle| is_listed(&triangle.corners));
    }
    Ok(Normalised { frame, triangles, dropped, collapsed, rounding })
}

/// Puts the vertices that are in use on the lattice. Returns the largest move of a coordinate by rounding, in steps.
fn place<S: Copy + Sync + Into<f64>>(
    positions: &[[S; 3]],
    used: &[AtomicBool],
    frame: &Frame,
    vertices: &mut [[f32; 3]],
) -> f32 {
    let step = frame.scale() / f64::from(LATTICE);
    let place = |((vertex, position), used): ((&mut [f32; 3], &[S; 3]), &AtomicBool)| {
        if !used.load(Relaxed) {
            return 0.0;
        }
        let exact = wide(position);
        *vertex = frame.to_lattice(exact);
        let moved = |k: usize| (f64::from(vertex[k]) - (exact[k] - frame.anchor[k]) / step).abs() as f32;
        (0..3).map(moved).fold(0.0, f32::max)
    };
    vertices.par_iter_mut().zip(positions).zip(used).map(place).reduce(|| 0.0, f32::max)
}

/// Stands for vertices of no triangle, or of left-out triangles alone: nothing inside the root.
const LEFT_OUT: [f32; 3] = [f32::INFINITY; 3];

fn is_listed(corners: &[[f32; 3]; 3]) -> bool {
    !has_equal_corners(corners) && !corners.contains(&LEFT_OUT)
}

/// A position in f64.
fn wide<S: Copy + Into<f64>>(position: &[S; 3]) -> [f64; 3] {
    position.map(Into::into)
}

/// Whether a build can take a vertex: its coordinates are numbers, and f32 reaches as far.
fn is_sound<S: Copy + Into<f64>>(position: &[S; 3]) -> bool {
    wide(position).iter().all(|c| c.abs() <= f64::from(f32::MAX))
}

/// Marks the vertices of all triangles that are not left out.
fn used_vertices<S: Copy + Sync + Into<f64>>(
    mesh: MeshRef<'_>,
    positions: &[[S; 3]],
    non_finite: NonFinite,
) -> Result<Vec<AtomicBool>, BuildError> {
    let used: Vec<AtomicBool> = positions.iter().map(|_| AtomicBool::new(false)).collect();
    let mark = |indices: &[u32; 3]| {
        let are_sound = indices.iter().all(|&index| positions.get(index as usize).is_some_and(is_sound));
        if are_sound {
            indices.iter().for_each(|&index| used[index as usize].store(true, Relaxed));
        }
        are_sound
    };
    // All triangles are looked at, whatever the first few give.
    let are_sound = mesh.triangles.par_iter().map(mark).reduce(|| true, |a, b| a & b);
    if !are_sound {
        check_vertices(mesh, positions, non_finite)?;
    }
    Ok(used)
}

fn check_counts(mesh: MeshRef<'_>) -> Result<(), BuildError> {
    let too_large =
        |what, count: usize| BuildError::TooLarge { what, count: count as u64, limit: u64::from(u32::MAX) - 1 };
    if mesh.triangles.len() >= u32::MAX as usize {
        return Err(too_large("triangles", mesh.triangles.len()));
    }
    if !mesh.material_ids.is_empty() && mesh.material_ids.len() != mesh.triangles.len() {
        return Err(BuildError::MaterialCount { materials: mesh.material_ids.len(), triangles: mesh.triangles.len() });
    }
    Ok(())
}

/// Finds the first triangle that no build takes.
fn check_vertices<S: Copy + Sync + Into<f64>>(
    mesh: MeshRef<'_>,
    positions: &[[S; 3]],
    non_finite: NonFinite,
) -> Result<(), BuildError> {
    let vertices = positions.len();
    let fault = mesh.triangles.par_iter().enumerate().find_map_first(|(triangle, indices)| {
        indices.iter().find_map(|&index| match positions.get(index as usize) {
            None => Some(BuildError::IndexOutOfRange { triangle, index, vertices }),
            Some(position) if non_finite == NonFinite::Refused && !is_sound(position) => {
                Some(BuildError::NonFiniteVertex { vertex: index, position: wide(position) })
            }
            Some(_) => None,
        })
    });
    fault.map_or(Ok(()), Err)
}

fn has_equal_corners<S: PartialEq>([a, b, c]: &[[S; 3]; 3]) -> bool {
    a == b || b == c || c == a
}

fn join(a: [[f64; 3]; 2], b: [[f64; 3]; 2]) -> [[f64; 3]; 2] {
    [core::array::from_fn(|k| a[0][k].min(b[0][k])), core::array::from_fn(|k| a[1][k].max(b[1][k]))]
}

/// Whether three corners lie on a line, in exact arithmetic but for needles that f64 cannot tell from one.
pub(crate) fn is_collinear(corners: &[[f32; 3]; 3]) -> bool {
    let [a, b, c] = corners.map(|c| glam::DVec3::from_array(c.map(f64::from)));
    (b - a).cross(c - a) == glam::DVec3::ZERO
}
