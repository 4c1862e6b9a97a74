//! A mesh in lattice units: the one place where vertices are rounded.

use leafwalk_core::Frame;
use rayon::prelude::*;

use super::BuildError;
use crate::mesh::Mesh;

/// A triangle in lattice units takes 40 bytes, and some more until it is known which are dropped.
pub(crate) const BYTES_PER_TRIANGLE: u64 = 100;

/// What is left of a mesh for an octree to list.
#[derive(Clone, Debug)]
pub(crate) struct Normalised {
    pub(crate) frame: Frame,
    /// Primitive and corners in lattice units, by ascending primitive.
    pub(crate) triangles: Vec<(u32, [[f32; 3]; 3])>,
    /// Left out: two corners are equal after rounding, or one is not finite (lenient builds).
    pub(crate) dropped: u32,
    /// Of those, how many had three different corners before rounding.
    pub(crate) collapsed: u32,
    /// The largest move of a coordinate by rounding, in lattice units.
    pub(crate) rounding: f32,
}

/// Which triangles a build refuses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NonFinite {
    Refused,
    Dropped,
}

pub(crate) fn normalise(mesh: &Mesh) -> Result<Normalised, BuildError> {
    normalise_with(mesh, NonFinite::Refused)
}

/// With vertices on the root's faces, which the contract forbids.
pub(crate) fn normalise_touching(mesh: &Mesh) -> Result<Normalised, BuildError> {
    normalise_into(mesh, NonFinite::Refused, Frame::touching)
}

pub(crate) fn normalise_with(mesh: &Mesh, non_finite: NonFinite) -> Result<Normalised, BuildError> {
    normalise_into(mesh, non_finite, Frame::around)
}

fn normalise_into(
    mesh: &Mesh,
    non_finite: NonFinite,
    frame: impl Fn([f32; 3], [f32; 3]) -> Frame,
) -> Result<Normalised, BuildError> {
    check(mesh, non_finite)?;
    let finite = |corners: &[[f32; 3]; 3]| corners.as_flattened().iter().all(|c| c.is_finite());
    let empty = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    let (lower, upper) = (0..mesh.triangles.len())
        .into_par_iter()
        .map(|i| mesh.corners(i))
        .filter(finite)
        .fold(|| empty, |bounds, corners| corners.into_iter().fold(bounds, |(a, b), c| join((a, b), (c, c))))
        .reduce(|| empty, join);
    let frame = if lower[0] <= upper[0] { frame(lower, upper) } else { frame([0.0; 3], [0.0; 3]) };

    let scale = frame.scale();
    let exact = |c: f32, k: usize| (f64::from(c) - frame.origin[k]) / scale;
    let listed: Vec<_> = (0..mesh.triangles.len())
        .into_par_iter()
        .map(|i| {
            let corners = mesh.corners(i);
            if !finite(&corners) {
                return (None, false, 0.0);
            }
            let rounded = corners.map(|corner| frame.to_lattice(corner));
            let moved = |c: usize, k: usize| (f64::from(rounded[c][k]) - exact(corners[c][k], k)).abs() as f32;
            let rounding = (0..9).map(|i| moved(i / 3, i % 3)).fold(0.0, f32::max);
            let is_degenerate = has_equal_corners(&rounded);
            let collapsed = is_degenerate && !has_equal_corners(&corners);
            ((!is_degenerate).then_some((i as u32, rounded)), collapsed, rounding)
        })
        .collect();
    let rounding = listed.iter().map(|(_, _, rounding)| *rounding).fold(0.0, f32::max);
    let collapsed = listed.iter().filter(|(_, collapsed, _)| *collapsed).count() as u32;
    let triangles: Vec<_> = listed.into_iter().filter_map(|(triangle, _, _)| triangle).collect();
    let dropped = (mesh.triangles.len() - triangles.len()) as u32;
    Ok(Normalised { frame, triangles, dropped, collapsed, rounding })
}

fn check(mesh: &Mesh, non_finite: NonFinite) -> Result<(), BuildError> {
    let too_large =
        |what, count: usize| BuildError::TooLarge { what, count: count as u64, limit: u64::from(u32::MAX) - 1 };
    if mesh.triangles.len() >= u32::MAX as usize {
        return Err(too_large("triangles", mesh.triangles.len()));
    }
    if !mesh.material_ids.is_empty() && mesh.material_ids.len() != mesh.triangles.len() {
        return Err(BuildError::MaterialCount { materials: mesh.material_ids.len(), triangles: mesh.triangles.len() });
    }
    let vertices = mesh.positions.len();
    let fault = mesh.triangles.par_iter().enumerate().find_map_first(|(triangle, indices)| {
        indices.iter().find_map(|&index| match mesh.positions.get(index as usize) {
            None => Some(BuildError::IndexOutOfRange { triangle, index, vertices }),
            Some(position) if non_finite == NonFinite::Refused && !position.iter().all(|c| c.is_finite()) => {
                Some(BuildError::NonFiniteVertex { vertex: index, position: *position })
            }
            Some(_) => None,
        })
    });
    fault.map_or(Ok(()), Err)
}

fn has_equal_corners([a, b, c]: &[[f32; 3]; 3]) -> bool {
    a == b || b == c || c == a
}

fn join(a: ([f32; 3], [f32; 3]), b: ([f32; 3], [f32; 3])) -> ([f32; 3], [f32; 3]) {
    (core::array::from_fn(|k| a.0[k].min(b.0[k])), core::array::from_fn(|k| a.1[k].max(b.1[k])))
}

/// Whether three corners lie on a line, in exact arithmetic but for needles that f64 cannot tell from one.
pub(crate) fn is_collinear(corners: &[[f32; 3]; 3]) -> bool {
    let [a, b, c] = corners.map(|c| glam::DVec3::from_array(c.map(f64::from)));
    (b - a).cross(c - a) == glam::DVec3::ZERO
}
