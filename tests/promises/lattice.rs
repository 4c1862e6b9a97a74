//! Walks in exact arithmetic: rays between points of the lattice, in small integer directions, pass through the edges
//! and corners of cells and along their faces, where a step has to break ties.

use leafwalk::{Builder, Mesh, Octree, Parts, Ray};
use leafwalk_core::lanes::{Bits, Lanes};
use leafwalk_core::layout::{Key, LATTICE};
use leafwalk_core::step::{self, Cell, Exit, Pluecker, Slab, Step};
use leafwalk_core::testing::{self, Standard};
use leafwalk_testing::rays::hex;
use leafwalk_testing::tally::{Tally, tally};

/// Edge of the root in the caller's units: that of the smallest cell is 1.
const EDGE: i32 = 16;

/// A speck at every point and at its mirror image, where the tree splits to the last level; the frame is 0..16.
fn specks(points: &[[f32; 3]]) -> Octree<Vec<u32>> {
    let corners = |p: &[f32; 3]| {
        let at = |dx, dy, dz| [p[0] + dx, p[1] + dy, p[2] + dz];
        [at(0.0, 0.0, 0.0), at(1.0 / 256.0, 0.0, 1.0 / 512.0), at(0.0, 1.0 / 256.0, 1.0 / 128.0)]
    };
    let mirrored = |triangle: [[f32; 3]; 3]| triangle.map(|corner| corner.map(|c| EDGE as f32 - c));
    let positions: Vec<_> = points.iter().flat_map(|p| [corners(p), mirrored(corners(p))]).flatten().collect();
    let triangles = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let octree = Builder::new().step_cost(0.5).max_level(EDGE.ilog2()).build(&Mesh::new(positions, triangles));
    let octree = octree.expect("a mesh that builds");
    let frame = octree.parts().frame;
    assert_eq!(
        (frame.to_caller(frame.corner), frame.scale()),
        ([0.0; 3], f64::from(EDGE)),
        "lattice points must be exact"
    );
    let sizes = octree.stats().leaves_at_level.iter().filter(|leaves| **leaves > 0).count();
    assert!(sizes >= 3, "leaves of {sizes} sizes");
    octree
}

/// Off every ray of the test: no small multiples of these coordinates sum to an integer.
const CORNER: [f32; 3] = [371.0 / 1024.0, 629.0 / 1024.0, 233.0 / 1024.0];
/// In the first lattice step: a mesh that has points as near to each face fills the root, so that all rays are walked
/// from the root's entry to its exit.
const RIM: f32 = 0.75 * EDGE as f32 / LATTICE as f32;
/// Points in the cell of the corner, near its three faces that are faces of the root.
const CORNERS: [[f32; 3]; 3] = [[RIM, CORNER[1], CORNER[2]], [CORNER[0], RIM, CORNER[2]], [CORNER[0], CORNER[1], RIM]];
const CENTRE: [f32; 3] = [7.0 + CORNER[1], 7.0 + CORNER[2], 7.0 + CORNER[0]];
const ASIDE: [f32; 3] = [2.0 + CORNER[2], 11.0 + CORNER[0], 5.0 + CORNER[1]];

fn trees() -> [Octree<Vec<u32>>; 2] {
    let [a, b, c] = CORNERS;
    [specks(&[a, b, c]), specks(&[a, b, c, CENTRE, ASIDE])]
}

/// A ray in integers.
#[derive(Clone, Copy, Debug)]
struct Line {
    origin: [i32; 3],
    direction: [i32; 3],
}

/// A span of twice the ray's parameter: planes are met at integers, since a direction is at most 2.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Span {
    from: i32,
    to: i32,
}

impl Line {
    /// Where the line is in a closed cube, behind the origin too.
    fn inside(self, lower: [i32; 3], edge: i32) -> Option<Span> {
        let mut span = Span { from: i32::MIN, to: i32::MAX };
        for (k, low) in lower.into_iter().enumerate() {
            let (o, d) = (self.origin[k], self.direction[k]);
            let (near, far) = (low - o, low + edge - o);
            match d {
                0 if near > 0 || far < 0 => return None,
                0 => {}
                _ => {
                    let (a, b) = (2 * near / d, 2 * far / d);
                    span = Span { from: span.from.max(a.min(b)), to: span.to.min(a.max(b)) };
                }
            }
        }
        (span.from <= span.to).then_some(span)
    }

    /// A cell as (lower corner, edge) must hold the point reached so far; from there the ray covers it to its end.
    fn advance(self, reached: i32, (lower, edge): ([i32; 3], i32)) -> Result<i32, String> {
        match self.inside(lower, edge) {
            Some(span) if span.from <= reached && reached <= span.to => Ok(span.to),
            other => Err(format!("the cell {lower:?} + {edge} covers {other:?} where the ray has come to {reached}")),
        }
    }
}

/// The face by which the second cell follows the first along a ray: they share an area, and the ray moves that way.
fn are_chained(line: Line, (a, a_edge): ([i32; 3], i32), (b, b_edge): ([i32; 3], i32)) -> bool {
    let overlaps = |k: usize| a[k].max(b[k]) < (a[k] + a_edge).min(b[k] + b_edge);
    let crossed = |k: usize| match line.direction[k].signum() {
        1 => a[k] + a_edge == b[k],
        -1 => b[k] + b_edge == a[k],
        _ => false,
    };
    (0..3).any(|k| crossed(k) && (0..3).all(|other| other == k || overlaps(other)))
}

/// Place of a cell in the order in which the ray's octant traverses the tree: the Morton code of its mirrored corner.
fn place(line: Line, (lower, edge): ([i32; 3], i32)) -> i32 {
    let mirrored = |k: usize| if line.direction[k] < 0 { EDGE - lower[k] - edge } else { lower[k] };
    (0..EDGE.ilog2())
        .fold(0, |code, bit| (0..3).fold(code, |code, k| code | (mirrored(k) >> bit & 1) << (3 * bit + k as u32)))
}

/// Follows the visited cells along the ray, from its origin, or its entry, to where it leaves the root.
fn check(line: Line, cells: &[([i32; 3], i32)]) -> Result<(), String> {
    let Some(root) = line.inside([0; 3], EDGE).filter(|root| root.to >= 0) else { return Ok(()) };
    let mut reached = root.from.max(0);
    for (i, &cell) in cells.iter().enumerate() {
        if let Some(previous) = i.checked_sub(1).map(|i| cells[i]) {
            if !are_chained(line, previous, cell) {
                return Err(format!("from {previous:?} to {cell:?}: no step forward through a shared face"));
            }
            if place(line, previous) >= place(line, cell) {
                return Err(format!("from {previous:?} to {cell:?}: back in the order of the ray's octant"));
            }
        }
        reached = line.advance(reached, cell)?;
    }
    if reached == root.to { Ok(()) } else { Err(format!("{} cells end at {reached} of {root:?}", cells.len())) }
}

/// Walks one line, with both signs of its zeros.
fn walk<S: Step>(parts: &Parts<'_>, line: Line, index: u64, tally: &mut Tally) {
    let unit = LATTICE as i32 / EDGE;
    for zero in [0.0, -0.0] {
        let direction = line.direction.map(|d| if d == 0 { zero } else { d as f32 });
        let ray = Ray::new(line.origin.map(|c| c as f32), direction);
        let walk = testing::walk::<S, Standard>(parts);
        assert_eq!(walk.closest_hit(&ray), None, "a hit would end the walk early: {line:?}");
        let mut cells = Vec::new();
        walk.visit(&ray, |_, key: Key| {
            cells.push((key.corner.map(|c| c as i32 / unit), key.size() as i32 / unit));
        });
        tally.hit(!cells.is_empty());
        if let Err(what) = check(line, &cells) {
            tally.fault(index, || format!("{what}\n{line:?}, zeros {zero:?}: {}", hex(&ray)));
        }
        if !line.direction.contains(&0) {
            return;
        }
    }
}

/// Directions of components -2 to 2 without a common divisor.
fn directions() -> Vec<[i32; 3]> {
    let all = (0..125i32).map(|i| [i % 5 - 2, i / 5 % 5 - 2, i / 25 - 2]);
    let found: Vec<_> = all.filter(|d| d.iter().any(|c| c.abs() == 1)).collect();
    assert_eq!(found.len(), 98);
    found
}

/// Takes the quadrant of an exit face that lies opposite to the right one.
#[derive(Clone, Copy)]
struct WrongQuadrant;

impl Step for WrongQuadrant {
    fn exit<L: Lanes>(line: &step::Line<L>, cell: &Cell<L>) -> Exit<L> {
        Slab::exit(line, cell)
    }

    fn upper_halves<L: Lanes>(line: &step::Line<L>, cell: &Cell<L>, exit: &Exit<L>) -> L::Bits {
        Slab::upper_halves(line, cell, exit) ^ L::Bits::splat(0b111)
    }
}

#[test]
fn a_wrong_quadrant_is_noticed() {
    let octree = &trees()[1];
    let parts = octree.parts();
    let walks = tally(1000, |indices, tally| {
        for index in indices {
            let origin = [index as i32 % 10 + 3, index as i32 / 10 % 10 + 3, index as i32 / 100 + 3];
            walk::<WrongQuadrant>(&parts, Line { origin, direction: [2, 1, -1] }, index, tally);
        }
    });
    walks.catches("the opposite quadrant of an exit face");
}

fn check_origins(name: &str, coordinates: &[i32], keep: impl Fn([i32; 3]) -> bool) {
    let n = coordinates.len();
    let origins = (0..n.pow(3)).map(|i| [i % n, i / n % n, i / n / n].map(|i| coordinates[i]));
    let origins: Vec<_> = origins.filter(|origin| keep(*origin)).collect();
    let directions = directions();
    for (number, octree) in trees().iter().enumerate() {
        let parts = octree.parts();
        let tally = tally((origins.len() * directions.len()) as u64, |indices, tally| {
            for index in indices {
                let (origin, direction) = (index as usize / directions.len(), index as usize % directions.len());
                let line = Line { origin: origins[origin], direction: directions[direction] };
                walk::<Slab>(&parts, line, index, tally);
                walk::<Pluecker>(&parts, line, index, tally);
            }
        });
        let leaves = octree.stats().leaves;
        tally.passes(&format!("lattice, {name}, tree {number} of {leaves} leaves"), 0.05);
    }
}

#[test]
fn walks_from_every_lattice_point_cover_their_rays() {
    let coordinates: Vec<i32> = (0..=EDGE).collect();
    check_origins("inside", &coordinates, |_| true);
}

#[test]
fn walks_from_outside_cover_their_rays() {
    // Up to one root edge away rays keep their origin; further off it is moved to the root.
    let coordinates = [-40, -17, -16, -3, 0, 2, 7, 8, 13, 16, 20, 32, 56];
    check_origins("outside", &coordinates, |origin| origin.iter().any(|c| !(0..=EDGE).contains(c)));
}
