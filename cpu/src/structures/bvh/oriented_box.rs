//! Boxes along axes of their own as bounding volumes.

use glam::{DMat3, DVec3, Mat3, Vec3};

use super::volume::Volume;
use crate::structures::bounds::Bounds;
use crate::structures::line::Line;

/// A box along the principal axes of its points, or along those of space, whichever has the smaller surface: S. Gottschalk,
/// M. C. Lin and D. Manocha, "OBBTree", SIGGRAPH 1996, with corners for the samples of the hull.
#[derive(Clone, Copy, Debug)]
pub struct OrientedBox {
    centre: Vec3,
    /// From space into the box. Its rows need not be quite perpendicular: the box is what lies between their planes.
    into: Mat3,
    bounds: Bounds,
}

impl OrientedBox {
    fn along(axes: Mat3, centre: Vec3, points: &[Vec3]) -> Self {
        let bounds = points.iter().fold(Bounds::EMPTY, |bounds, point| {
            let inside = axes * (*point - centre);
            bounds.join(Bounds { lower: inside, upper: inside })
        });
        Self { centre, into: axes, bounds }
    }
}

impl Volume for OrientedBox {
    const EMPTY: Self = Self { centre: Vec3::ZERO, into: Mat3::IDENTITY, bounds: Bounds::EMPTY };
    /// A coordinate in the box is a sum of three products with a row of length 1 and is off by 4 roundoffs of the distance
    /// from the centre: 8 of the root's edge for a corner, 14 for an origin at 3.5 root edges, and 14 for a point so far along
    /// the direction. A margin more, of 120, covers these and the slab test.
    const MARGINS: f32 = 2.0;
    type Probe = Line;

    fn around(points: &[Vec3], margin: f32) -> Self {
        let centre = Bounds::around(points).centre();
        let along_space = Self::along(Mat3::IDENTITY, centre, points);
        let tilted = Self::along(principal_axes(points), centre, points);
        let best = if tilted.bounds.area() < along_space.bounds.area() { tilted } else { along_space };
        Self { bounds: best.bounds.dilated(margin), ..best }
    }

    fn join(&self, _: &Self) -> Option<Self> {
        None
    }

    fn probe(line: &Line) -> Line {
        *line
    }

    #[inline]
    fn entry(&self, line: &Line, first: f32, last: f32) -> Option<f32> {
        let direction = self.into * line.direction;
        let inside =
            Line { origin: self.into * (line.origin - self.centre), direction, inverse: direction.recip(), ..*line };
        let (entry, exit) = self.bounds.clip(&inside, first, last);
        (entry <= exit).then_some(entry)
    }
}

/// Turns of Jacobi's method. Each at least halves what is off the diagonal, and from the third sweep or so squares it.
const TURNS: usize = 24;

/// The axes along which points spread independently, as rows: the eigenvectors of their covariance, by Jacobi's method.
fn principal_axes(points: &[Vec3]) -> Mat3 {
    let mean = points.iter().map(|point| point.as_dvec3()).sum::<DVec3>() / points.len() as f64;
    let mut covariance = points.iter().fold(DMat3::ZERO, |sum, point| {
        let d = point.as_dvec3() - mean;
        sum + DMat3::from_cols(d * d.x, d * d.y, d * d.z)
    });
    let mut axes = DMat3::IDENTITY;
    for turn in 0..TURNS {
        let [p, q] = [[0, 1], [0, 2], [1, 2]][turn % 3];
        let off = covariance.col(q)[p];
        if off == 0.0 {
            continue;
        }
        let ratio = (covariance.col(q)[q] - covariance.col(p)[p]) / (2.0 * off);
        let tangent = ratio.signum() / (ratio.abs() + ratio.hypot(1.0));
        let cosine = 1.0 / tangent.hypot(1.0);
        let sine = tangent * cosine;
        let mut rotation = DMat3::IDENTITY;
        rotation.col_mut(p)[p] = cosine;
        rotation.col_mut(q)[q] = cosine;
        rotation.col_mut(q)[p] = sine;
        rotation.col_mut(p)[q] = -sine;
        covariance = rotation.transpose() * covariance * rotation;
        axes *= rotation;
    }
    let rows = axes.transpose().as_mat3();
    if rows.is_finite() { rows } else { Mat3::IDENTITY }
}
