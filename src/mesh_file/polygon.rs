//! Polygons, which become fans of triangles, and the check that a polygon is such a fan: flat, convex and wound once.

use std::path::Path;

use glam::DVec3;

use super::MeshError;

/// How far a corner may lie from the polygon's mean plane, as a share of its reach (the largest distance of a corner
/// from the first).
///
/// A square folded by an angle a along a diagonal of length d has its corners d sin(a) / 8 from the mean plane, so
/// this is a fold of 30 degrees. Its two fans enclose a volume: below, the quads of smooth models and the walls of the
/// Cornell box (1/570) pass; above, the file does not say which surface is meant.
const WARP: f64 = 1.0 / 16.0;

/// What the rounding of written coordinates may do to a corner's distance from a line or plane through others, as a
/// share of the largest coordinate.
///
/// Six significant digits are off by at most 5e-6 of the value, in each of three coordinates: a point moves by at most
/// 8.7e-6. The corner and the line move, which makes 1.8e-5; the next power of two is 2^-15.
const ROUNDING: f64 = 1.0 / 32768.0;

/// The triangles of a mesh, made of its polygons in order.
#[derive(Default)]
pub(super) struct Fans {
    triangles: Vec<[u32; 3]>,
    polygons: Vec<Polygon>,
    faces: u64,
    skipped: usize,
}

/// A face of more than three corners, and the triangles that it became.
struct Polygon {
    face: u64,
    first: usize,
    triangles: usize,
}

impl Fans {
    /// Adds the next face, and returns how many triangles it makes: two fewer than corners.
    pub(super) fn push(&mut self, path: &Path, corners: &[u32]) -> Result<usize, MeshError> {
        self.faces += 1;
        let &[apex, ref rim @ ..] = corners else {
            self.skipped += 1;
            return Ok(0);
        };
        let triangles = rim.len().saturating_sub(1);
        let first = self.triangles.len();
        let count = (first + triangles) as u64;
        if count > u64::from(u32::MAX) {
            return Err(MeshError::TooLarge { path: path.to_owned(), what: "triangles", count });
        }
        match triangles {
            0 => self.skipped += 1,
            1 => {}
            _ => self.polygons.push(Polygon { face: self.faces, first, triangles }),
        }
        self.triangles.extend(rim.windows(2).map(|edge| [apex, edge[0], edge[1]]));
        Ok(triangles)
    }

    /// Checks every polygon against the position of each corner. Returns the triangles and how many faces made none.
    pub(super) fn finish(
        self,
        path: &Path,
        position: impl Fn(usize) -> [f64; 3],
    ) -> Result<(Vec<[u32; 3]>, usize), MeshError> {
        let mut outline = Vec::new();
        for polygon in &self.polygons {
            let fan = &self.triangles[polygon.first..][..polygon.triangles];
            outline.clear();
            let indices = fan[0][..2].iter().chain(fan.iter().map(|triangle| &triangle[2]));
            outline.extend(indices.map(|&index| DVec3::from(position(index as usize))));
            let Some(fault) = fault(&outline) else { continue };
            let (path, face, corners) = (path.to_owned(), polygon.face, outline.len());
            return Err(match fault {
                Fault::Concave { corner } => MeshError::ConcaveFace { path, face, corners, corner: corner + 1 },
                Fault::NonPlanar { distance, allowed } => {
                    MeshError::NonPlanarFace { path, face, corners, distance, allowed }
                }
            });
        }
        Ok((self.triangles, self.skipped))
    }
}

/// Why a polygon is not a fan of triangles; corners count from 0.
#[derive(Debug, PartialEq)]
enum Fault {
    Concave { corner: usize },
    NonPlanar { distance: f64, allowed: f64 },
}

/// What keeps a polygon from being a fan, if anything does. A polygon thinner than the rounding of its corners has
/// nothing to check, and one with a corner that is not finite cannot be checked.
fn fault(corners: &[DVec3]) -> Option<Fault> {
    if !corners.iter().all(|corner| corner.is_finite()) {
        return None;
    }
    let apex = corners[0];
    let from_apex = |corner: &DVec3| (corner - apex).length();
    let farthest = corners.iter().copied().max_by(|a, b| from_apex(a).total_cmp(&from_apex(b)))?;
    let reach = from_apex(&farthest);
    let rounding = ROUNDING * corners.iter().map(|corner| corner.abs().max_element()).fold(0.0, f64::max);
    let off_line = |corner: &DVec3| (farthest - apex).cross(corner - apex).length() > rounding * reach;
    let corner = corners.iter().position(off_line)?;

    // Twice the vector area; a convex polygon has at least that of the triangle of the three corners just found.
    let edges = || corners.iter().zip(corners[1..].iter().chain([&apex]));
    let area: DVec3 = edges().map(|(a, b)| (a - apex).cross(b - apex)).sum();
    let size = area.length();
    if size <= rounding * reach {
        return Some(Fault::Concave { corner });
    }
    let normal = area / size;

    let mean = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let distance = corners.iter().map(|corner| (corner - mean).dot(normal).abs()).fold(0.0, f64::max);
    let allowed = WARP * reach + rounding;
    if distance > allowed {
        return Some(Fault::NonPlanar { distance, allowed });
    }

    // Turning left at each corner is not enough: a star that winds twice does so too, but seen from the apex its
    // corners go back, or behind the first edge.
    let count = corners.len();
    let turns_right = |a: usize, b: usize, c: usize| {
        let [a, b, c] = [a, b, c].map(|i| corners[i % count]);
        let [ab, ac, bc] = [b - a, c - a, c - b];
        ab.cross(ac).dot(normal) < -rounding * ab.length().max(ac.length()).max(bc.length())
    };
    (0..count)
        .find(|&i| turns_right(i + count - 1, i, i + 1) || turns_right(0, i, i + 1) || turns_right(0, 1, i))
        .map(|corner| Fault::Concave { corner })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(corners: &[[f64; 2]]) -> Vec<DVec3> {
        corners.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect()
    }

    fn regular(count: usize, step: usize) -> Vec<DVec3> {
        let angle = |i: usize| (i * step) as f64 * core::f64::consts::TAU / count as f64;
        (0..count).map(|i| DVec3::new(angle(i).cos(), angle(i).sin(), 0.5 * angle(i).cos())).collect()
    }

    /// A unit square, its last corner folded up along the diagonal through the first.
    fn folded(degrees: f64) -> Vec<DVec3> {
        let (half, (sine, cosine)) = (0.5_f64, degrees.to_radians().sin_cos());
        let height = half.sqrt();
        let corner = DVec3::new(half - half * cosine, half + half * cosine, height * sine);
        vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), corner]
    }

    /// The same polygon from every corner, in both directions: the verdict may not depend on either.
    fn variants(corners: &[DVec3]) -> Vec<Vec<DVec3>> {
        let mut all = Vec::new();
        for start in 0..corners.len() {
            let mut turned = corners.to_vec();
            turned.rotate_left(start);
            all.push(turned.clone());
            turned.reverse();
            all.push(turned);
        }
        all
    }

    fn assert_fan(corners: &[DVec3]) {
        for variant in variants(corners) {
            assert_eq!(fault(&variant), None, "{variant:?}");
        }
    }

    fn assert_concave(corners: &[DVec3]) {
        for variant in variants(corners) {
            assert!(matches!(fault(&variant), Some(Fault::Concave { .. })), "{variant:?}");
        }
    }

    #[test]
    fn convex_polygons_are_fans() {
        for count in 4..40 {
            assert_fan(&regular(count, 1));
        }
        assert_fan(&flat(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 2.0], [0.0, 2.0]]));
    }

    #[test]
    fn dents_stars_and_crossings_are_concave() {
        assert_concave(&flat(&[[0.0, 0.0], [4.0, 0.0], [1.0, 1.0], [0.0, 4.0]]));
        assert_concave(&flat(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]));
        assert_concave(&flat(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]));
        assert_concave(&[[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 1e-7], [0.0, 1.0, 0.0]].map(DVec3::from));
        for (count, step) in [(5, 2), (7, 2), (7, 3), (8, 3), (9, 2), (9, 4)] {
            assert_concave(&regular(count, step));
        }
        let mut dented = regular(12, 1);
        dented[5] *= 0.8;
        assert_eq!(fault(&dented), Some(Fault::Concave { corner: 5 }));
    }

    #[test]
    fn a_fold_of_30_degrees_is_the_limit() {
        for degrees in [0.0, 1.0, 10.0, 25.0] {
            assert_fan(&folded(degrees));
        }
        for degrees in [35.0, 60.0, 90.0] {
            for variant in variants(&folded(degrees)) {
                assert!(matches!(fault(&variant), Some(Fault::NonPlanar { .. })), "{degrees} {variant:?}");
            }
        }
    }

    #[test]
    fn six_digits_pass_at_any_size_and_place() {
        for exponent in -6..=3 {
            for place in [0.0, 12.345_678, 4321.0] {
                let written = regular(12, 1)
                    .into_iter()
                    .map(|corner| corner.map(|x| format!("{:.5e}", place + x * 10_f64.powi(exponent)).parse().unwrap()))
                    .collect::<Vec<DVec3>>();
                assert_fan(&written);
            }
        }
    }

    #[test]
    fn thin_and_unchecked_polygons_pass() {
        assert_fan(&[DVec3::new(3.0, 1.0, 2.0); 5]);
        assert_fan(&flat(&[[0.0, 0.0], [1.0, 1.0], [3.0, 3.0], [2.0, 2.0]]));
        assert_fan(&flat(&[[0.0, 0.0], [f64::NAN, 1.0], [1.0, 1.0], [0.5, 0.1]]));
        assert_fan(&flat(&[[0.0, 0.0], [3e38, 0.0], [3e38, 3e38], [0.0, 3e38]]));
    }

    #[test]
    fn faces_become_triangles_in_order() {
        let path = Path::new("a.obj");
        let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let mut fans = Fans::default();
        let made: Vec<usize> = [&[0, 1, 2][..], &[], &[1], &[2, 3], &[3, 0, 1, 2], &[0, 2, 3]]
            .map(|corners| fans.push(path, corners).unwrap())
            .to_vec();
        assert_eq!(made, [1, 0, 0, 0, 2, 1]);
        let (triangles, skipped) = fans.finish(path, |index| positions[index]).unwrap();
        assert_eq!(triangles, [[0, 1, 2], [3, 0, 1], [3, 1, 2], [0, 2, 3]]);
        assert_eq!(skipped, 3);
    }

    #[test]
    fn faults_name_the_face() {
        let path = Path::new("a.obj");
        let positions = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 4.0, 0.0], [0.0, 4.0, 4.0]];
        let finish = |corners: &[u32]| {
            let mut fans = Fans::default();
            fans.push(path, &[0, 1]).unwrap();
            fans.push(path, corners).unwrap();
            fans.finish(path, |index| positions[index]).unwrap_err()
        };
        let concave = finish(&[0, 1, 2, 3]);
        assert!(matches!(concave, MeshError::ConcaveFace { face: 2, corners: 4, corner: 3, .. }), "{concave}");
        let bent = finish(&[0, 1, 3, 4]);
        assert!(matches!(bent, MeshError::NonPlanarFace { face: 2, corners: 4, .. }), "{bent}");
    }
}
