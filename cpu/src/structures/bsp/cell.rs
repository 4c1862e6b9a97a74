//! `Cell`: the convex body that the planes above a node leave.

use glam::DVec3;

use super::plane::Plane;
use crate::structures::bounds::Bounds;

/// A convex body, by its faces, each anticlockwise as seen from outside.
///
/// It only says how likely lines come to a node, by its surface. What the rounding of its corners does to that changes which
/// planes are chosen, and no answer.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    faces: Vec<Vec<DVec3>>,
}

/// What a plane makes of a cell.
pub(super) struct Halves {
    pub(super) behind: Cell,
    pub(super) before: Cell,
    /// The surface that the two have in common.
    pub(super) shared: f64,
}

impl Cell {
    /// A box.
    pub(super) fn around(bounds: &Bounds) -> Self {
        let sides = [bounds.lower.as_dvec3(), bounds.upper.as_dvec3()];
        let faces = [0, 1, 2].into_iter().flat_map(|k| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            [0, 1].map(|end| {
                let mut round = [[0, 0], [1, 0], [1, 1], [0, 1]];
                if end == 0 {
                    round.reverse();
                }
                round.map(|[at_i, at_j]| {
                    let mut corner = sides[end];
                    (corner[i], corner[j]) = (sides[at_i][i], sides[at_j][j]);
                    corner
                })
            })
        });
        Self { faces: faces.map(Vec::from).collect() }
    }

    /// Its surface.
    pub(super) fn area(&self) -> f64 {
        self.faces.iter().map(|face| area(face)).sum()
    }

    /// Cuts it in two, either of which may be nothing.
    pub(super) fn cut(&self, plane: &Plane) -> Halves {
        let (mut behind, mut before, mut cap) = (Vec::new(), Vec::new(), Vec::new());
        for face in &self.faces {
            let (mut lower, mut upper) = (Vec::new(), Vec::new());
            for (i, corner) in face.iter().enumerate() {
                let next = face[(i + 1) % face.len()];
                let [height, to] = [*corner, next].map(|point| plane.height(point));
                match height < 0.0 {
                    true => lower.push(*corner),
                    false => upper.push(*corner),
                }
                if (height < 0.0) != (to < 0.0) {
                    let crossing = *corner + height / (height - to) * (next - *corner);
                    lower.push(crossing);
                    upper.push(crossing);
                    // Each corner of the cap belongs to two faces, and one of them goes down there.
                    if height >= 0.0 {
                        cap.push(crossing);
                    }
                }
            }
            behind.push(lower);
            before.push(upper);
        }
        plane.sort_around(&mut cap);
        let shared = area(&cap);
        before.push(cap.iter().rev().copied().collect());
        behind.push(cap);
        let [behind, before] = [behind, before].map(|mut faces| {
            faces.retain(|face| face.len() > 2);
            Self { faces }
        });
        Halves { behind, before, shared }
    }
}

/// The area of a convex polygon.
fn area(polygon: &[DVec3]) -> f64 {
    let Some((first, others)) = polygon.split_first() else { return 0.0 };
    let crosses = others.windows(2).map(|pair| (pair[0] - *first).cross(pair[1] - *first));
    0.5 * crosses.sum::<DVec3>().length()
}
