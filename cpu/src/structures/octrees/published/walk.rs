//! The two loops.

use glam::Vec3;
use leafwalk_core::tables::{EXIT_FACE, SUB_FACE, UNREACHABLE, exit_corner};

use super::super::branches::Branches;
use super::super::course::{Course, inverse, octant};
use super::Published;
use super::cube_map::CubeMap;
use super::records::Cube;
use crate::structures::{Line, Search};

impl Published {
    /// [`super::Mode::Corrected`].
    pub(super) fn walk(&self, branches: &Branches, line: &Line, search: &mut impl Search) {
        let course = Course::new(&self.cells, line);
        let mut cell = self.cells.root();
        let Some(mut t) = course.start(line, cell, self.margin) else { return };
        let mut leaf = branches.locate(&mut cell, &course, t);
        let (mirror, origin, inverse) = (course.mirror as usize, line.origin.to_array(), inverse(line).to_array());
        // 1 where the line runs up, and leaves cells at the larger coordinate.
        let ahead: [f32; 3] = core::array::from_fn(|k| (1 - (mirror >> k & 1)) as f32);
        // A step always leads forward in the order of octants along the line, so that there are no more.
        for _ in 0..self.records.len() {
            search.step();
            search.test(self.records.triangles(leaf));
            let Cube { lower, size } = self.records.cube(leaf);
            let lower = lower.to_array();
            let crossing = |k: usize, plane: f32| (plane - origin[k]) * inverse[k];
            let exits: [f32; 3] = core::array::from_fn(|k| crossing(k, lower[k] + size * ahead[k]));
            t = exits[0].min(exits[1].min(exits[2]));
            if search.end() < t - self.margin {
                return;
            }
            let axis = if exits[0] == t { 0 } else { 2 - usize::from(exits[1] == t) };
            // Bit k: the line is in the upper half along axis k at t. The bits of the other two axes make the sub-face.
            let crossed =
                (0..3).fold(0, |crossed, k| crossed | usize::from(crossing(k, lower[k] + 0.5 * size) <= t) << k);
            let (upper, below) = (crossed ^ mirror, (1 << axis) - 1);
            let sub_face = upper & below | upper >> 1 & !below;
            match self.records.neighbour(leaf, 2 * axis + (!mirror >> axis & 1), sub_face) {
                Some(next) => leaf = next,
                None => return,
            }
        }
    }

    /// [`super::Mode::Printed`].
    pub(super) fn walk_as_printed(&self, map: &CubeMap, line: &Line, search: &mut impl Search) {
        let Some(mut leaf) = self.entered(map, line) else { return };
        let row = (0..3).fold(0, |row, k| row | sign(line.direction[k]) << k);
        let coordinates = Plucker::of(line);
        // The limit serves numbers that are none.
        for _ in 0..self.records.len() {
            search.step();
            for triangle in self.records.triangles(leaf) {
                let end = search.end();
                search.test(triangle..triangle + 1);
                if search.end() != end {
                    return;
                }
            }
            let Cube { lower, size } = self.records.cube(leaf);
            let upper = exit_corner(row as u32);
            let corner = lower + size * Vec3::from_array(core::array::from_fn(|k| (upper >> k & 1) as f32));
            let face = EXIT_FACE[row][coordinates.signs(corner)];
            if face == UNREACHABLE {
                return;
            }
            let face = usize::from(face);
            let mut centre = lower + 0.5 * size;
            centre[face / 2] = corner[face / 2];
            let sub_face = SUB_FACE[face][coordinates.signs(centre)];
            match self.records.neighbour(leaf, face, sub_face.into()) {
                Some(next) => leaf = next,
                None => return,
            }
        }
    }

    /// The leaf of the cube map where a line enters the root, if it does.
    fn entered(&self, map: &CubeMap, line: &Line) -> Option<u32> {
        let root = self.cells.bounds(self.cells.root());
        let (first, last) = root.clip(line, f32::NEG_INFINITY, f32::INFINITY);
        if !(first <= last && last >= line.t_min && first <= line.t_max) {
            return None;
        }
        let place = (line.at(first) - root.lower) / root.extent();
        // The face is the one that is nearest to the place, of those that the line goes into.
        let mirror = octant(line);
        let depth = |k: usize| if mirror >> k & 1 == 0 { place[k] } else { 1.0 - place[k] };
        let crossed = (0..3).filter(|k| line.direction[*k] != 0.0);
        let axis = crossed.min_by(|a, b| depth(*a).abs().total_cmp(&depth(*b).abs()))?;
        Some(map.leaf(axis, mirror >> axis & 1 == 1, place))
    }
}

/// The sign bit of a number.
fn sign(x: f32) -> usize {
    (x.to_bits() >> 31) as usize
}

/// A line's Plücker coordinates, equation 1: its direction and moment. The paper has them of two points of the line;
/// here the second is not computed, as a direction that is short beside the origin would be lost in it.
struct Plucker([f32; 6]);

impl Plucker {
    fn of(line: &Line) -> Self {
        let (d, moment) = (line.direction, line.origin.cross(line.direction));
        Self([-moment.z, moment.y, d.x, -moment.x, d.z, -d.y])
    }

    /// The sign bits of the products with the lines through a point along the axes, equations 4 and 5.
    fn signs(&self, point: Vec3) -> usize {
        let Self(pi) = self;
        let x = pi[4] * point.y + pi[5] * point.z + pi[3];
        let y = pi[2] * point.z - pi[1] - pi[4] * point.x;
        let z = pi[0] - pi[2] * point.y - pi[5] * point.x;
        sign(x) | sign(y) << 1 | sign(z) << 2
    }
}
