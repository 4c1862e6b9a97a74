//! Simple shapes as closed triangle meshes, whose corners stand counter-clockwise as seen from outside.

use std::collections::HashMap;

use glam::DVec3;

use crate::picture::vector::unit;

/// A triangle mesh in f64: positions, and triangles that index them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shape {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

impl Shape {
    /// A parallelogram of two edges from a corner, seen from the side that the cross product `first x second` points
    /// to.
    pub(crate) fn quad(corner: DVec3, first: DVec3, second: DVec3) -> Self {
        let opposite = corner + first + second;
        Self {
            positions: vec![corner, corner + first, opposite, corner + second],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        }
    }

    /// A box around the origin, given by its largest corner.
    pub(crate) fn block(half: DVec3) -> Self {
        let positions = (0..8)
            .map(|corner| DVec3::from_array([0, 1, 2].map(|k| if corner >> k & 1 == 1 { half[k] } else { -half[k] })));
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        Self { positions: positions.collect(), triangles: triangles.collect() }
    }

    /// A unit sphere: an icosahedron whose triangles are cut into four `divisions` times.
    pub(crate) fn icosphere(divisions: u32) -> Self {
        let golden = 0.5 * (1.0 + 5f64.sqrt());
        let rectangle = [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)];
        let corners = (0..3).flat_map(|turn| {
            rectangle.map(|(short, long)| {
                let mut corner = [short, long, 0.0];
                corner.rotate_right(turn);
                DVec3::from(corner)
            })
        });
        #[rustfmt::skip]
        let mut triangles = vec![
            [0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6],
            [7, 1, 8], [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5], [2, 4, 11], [6, 2, 10],
            [8, 6, 7], [9, 8, 1],
        ];
        let mut positions: Vec<DVec3> = corners.filter_map(unit).collect();
        for _ in 0..divisions {
            let mut middles = HashMap::new();
            let mut middle = |a: u32, b: u32| {
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    let sum = positions[a as usize] + positions[b as usize];
                    positions.push(unit(sum).unwrap_or(sum));
                    positions.len() as u32 - 1
                })
            };
            let quarters = triangles.iter().flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            });
            triangles = quarters.collect();
        }
        Self { positions, triangles }
    }

    /// A tube along a knot on a torus of radii 2 and 1 about the z axis: `through` times through its hole while it
    /// winds `around` times about the axis.
    pub(crate) fn torus_knot(around: u32, through: u32, radius: f64, segments: u32, sides: u32) -> Self {
        let point = |turn: f64| {
            let (winding, angle) = (turn * f64::from(around), turn * f64::from(through));
            let from_axis = 2.0 + angle.cos();
            DVec3::new(from_axis * winding.cos(), from_axis * winding.sin(), angle.sin())
        };
        let angle = |step: u32, steps: u32| core::f64::consts::TAU * f64::from(step) / f64::from(steps);
        let positions = (0..segments).flat_map(|segment| {
            let turn = angle(segment, segments);
            let centre = point(turn);
            let along = unit(point(turn + STEP) - point(turn - STEP)).unwrap_or_default();
            // The torus' own normal turns with the knot, so that the tube closes.
            let winding = turn * f64::from(around);
            let outward = centre - DVec3::new(2.0 * winding.cos(), 2.0 * winding.sin(), 0.0);
            let side = outward.cross(along);
            (0..sides).map(move |k| {
                let (sine, cosine) = angle(k, sides).sin_cos();
                centre + (outward * cosine + side * sine) * radius
            })
        });
        let index = |segment: u32, side: u32| segment % segments * sides + side % sides;
        let triangles = (0..segments).flat_map(|s| {
            (0..sides).flat_map(move |k| {
                let [a, b, c, d] = [index(s, k), index(s + 1, k), index(s + 1, k + 1), index(s, k + 1)];
                [[a, b, d], [b, c, d]]
            })
        });
        Self { positions: positions.collect(), triangles: triangles.collect() }
    }

    /// Moves every position, which must not turn the shape inside out.
    pub(crate) fn map(mut self, place: impl Fn(DVec3) -> DVec3) -> Self {
        self.positions.iter_mut().for_each(|position| *position = place(*position));
        self
    }

    /// The shape turned about the y axis, counter-clockwise as seen from above.
    pub(crate) fn turned(self, degrees: f64) -> Self {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        self.map(|DVec3 { x, y, z }| DVec3::new(cosine * x + sine * z, y, cosine * z - sine * x))
    }

    /// The shape scaled about its origin.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        self.map(|position| position * factor)
    }

    /// The shape moved so that its own origin stands over `[x, z]` and its lowest point at the height `floor`.
    pub(crate) fn standing(self, [x, z]: [f64; 2], floor: f64) -> Self {
        let lowest = self.positions.iter().fold(f64::INFINITY, |lowest, position| lowest.min(position.y));
        self.map(|position| position + DVec3::new(x, floor - lowest, z))
    }
}

/// Half the parameter interval of a central difference. Its error is about the step's square, 2^-32, far below the
/// rounding of positions to f32, 2^-24.
const STEP: f64 = 1.0 / (1 << 16) as f64;

/// A unit sphere with round bumps at the points of a golden spiral.
pub(crate) fn bumpy_sphere(divisions: u32, bumps: u32, height: f64) -> Shape {
    let golden_angle = core::f64::consts::PI * (3.0 - 5f64.sqrt());
    let count = f64::from(bumps);
    let centres: Vec<DVec3> = (0..bumps)
        .map(|bump| {
            let y = 1.0 - (2.0 * f64::from(bump) + 1.0) / count;
            let (sine, cosine) = (golden_angle * f64::from(bump)).sin_cos();
            let from_axis = (1.0 - y * y).sqrt();
            DVec3::new(from_axis * cosine, y, from_axis * sine)
        })
        .collect();
    // Each bump has a share of the sphere of 4 pi / count, and is as wide as a disc of that area.
    let reach = 4.0 / count;
    Shape::icosphere(divisions).map(|direction| {
        let nearest = centres.iter().map(|centre| centre.dot(direction)).fold(-1.0, f64::max);
        let from_centre = 2.0 * (1.0 - nearest) / reach;
        let rise = (1.0 - from_centre).max(0.0);
        direction * (1.0 + height * rise * rise * (3.0 - 2.0 * rise))
    })
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    fn volume(shape: &Shape) -> f64 {
        let corner = |index: u32| shape.positions[index as usize];
        let signed = |[a, b, c]: &[u32; 3]| corner(*a).dot(corner(*b).cross(corner(*c))) / 6.0;
        shape.triangles.iter().map(signed).sum()
    }

    #[track_caller]
    fn assert_closed(shape: &Shape, expected_volume: f64) {
        let edges = shape.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
        let mut seen = HashSet::new();
        assert!(edges.clone().all(|edge| seen.insert(edge)), "an edge with two triangles on the same side");
        assert!(edges.clone().all(|(a, b)| seen.contains(&(b, a))), "an edge with one triangle");
        let volume = volume(shape);
        assert!((volume / expected_volume - 1.0).abs() < 0.02, "volume {volume}, not {expected_volume}");
    }

    #[test]
    fn shapes_are_closed_and_face_outwards() {
        let sphere = core::f64::consts::PI * 4.0 / 3.0;
        assert_closed(&Shape::block(DVec3::new(1.0, 2.0, 3.0)), 48.0);
        assert_closed(&Shape::icosphere(4), sphere);
        assert_closed(&Shape::icosphere(3).scaled(2.0).turned(30.0).standing([1.0, 1.0], 0.0), 8.0 * sphere);
        let bumpy = bumpy_sphere(5, 60, 0.1);
        assert_closed(&bumpy, volume(&bumpy));
        assert!((sphere..1.331 * sphere).contains(&volume(&bumpy)));

        let radius = 0.4;
        let knot = Shape::torus_knot(2, 3, radius, 600, 32);
        let centre = |segment: usize| {
            let ring = &knot.positions[segment % 600 * 32..][..32];
            ring.iter().sum::<DVec3>() / 32.0
        };
        let line: f64 = (0..600).map(|k| centre(k).distance(centre(k + 1))).sum();
        assert_closed(&knot, line * core::f64::consts::PI * radius * radius);
    }

    #[test]
    fn the_knot_does_not_touch_itself() {
        let (segments, sides, radius) = (480, 16, 0.42);
        let knot = Shape::torus_knot(2, 3, radius, segments as u32, sides as u32);
        let centres: Vec<_> =
            knot.positions.chunks(sides).map(|ring| ring.iter().sum::<DVec3>() / sides as f64).collect();
        let along = |a: usize, b: usize| (a.abs_diff(b)).min(segments - a.abs_diff(b));
        for a in 0..segments {
            for b in (0..a).filter(|b| along(a, *b) > segments / 12) {
                let distance = centres[a].distance(centres[b]);
                assert!(distance > 2.0 * radius, "segments {a} and {b} are {distance} apart");
            }
        }
    }

    #[test]
    fn standing_shapes_touch_the_floor() {
        let shape = bumpy_sphere(3, 20, 0.2).standing([5.0, -5.0], 1.5);
        let lowest = shape.positions.iter().map(|position| position.y).fold(f64::INFINITY, f64::min);
        assert!((lowest - 1.5).abs() < 1e-12);
    }
}
