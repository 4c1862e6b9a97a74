//! How a [`Bsp`] is built.

use glam::{DVec3, Vec3};

use super::cell::{Cell, Halves};
use super::plane::{Plane, Side, thickness_and_reach};
use super::{Bsp, DEPTH, Node, Places, Scene, Settings};

/// What going past a plane costs, in triangle tests.
const STEP: f32 = 1.0;

pub(super) fn build(scene: &Scene, settings: &Settings) -> Bsp {
    let bounds = scene.bounds();
    let (thickness, reach) = thickness_and_reach(&bounds, scene.margin);
    let bsp = Bsp { nodes: Vec::new(), listed: Vec::new(), bounds: bounds.dilated(scene.margin), reach };
    let mut builder = Builder { scene, settings, thickness, bsp };
    let cell = Cell::around(&builder.bsp.bounds);
    builder.node((0..scene.len() as u32).collect(), &cell, 0, settings.copies.saturating_mul(scene.len()));
    builder.bsp
}

struct Builder<'a> {
    scene: &'a Scene,
    settings: &'a Settings,
    thickness: f32,
    bsp: Bsp,
}

/// How many triangles a plane leaves on each side of it, and in it; what is on both sides counts for both.
#[derive(Clone, Copy, Default)]
struct Division {
    behind: usize,
    before: usize,
    within: usize,
}

impl Division {
    /// How many triangles are on both sides.
    fn cut(&self, all: usize) -> usize {
        self.behind + self.before + self.within - all
    }

    /// What a line costs that comes to a cell of some surface, if both sides are leaves. As likely as their surfaces say it
    /// comes to them, and through what they share, which has two faces.
    fn cost(&self, surface: f64, halves: &Halves) -> f32 {
        let tests = |count: usize, area: f64| {
            let share = area / surface;
            count as f32 * if share.is_finite() { share as f32 } else { 1.0 }
        };
        STEP + tests(self.behind, halves.behind.area())
            + tests(self.before, halves.before.area())
            + tests(self.within, 2.0 * halves.shared)
    }

    /// Whether either side has fewer triangles.
    fn divides(&self, all: usize) -> bool {
        self.behind.max(self.before) < all
    }
}

impl Builder<'_> {
    /// Adds a node and what is below it: at most `DEPTH` levels in all, of which `depth` are above, and with at most `copies`
    /// places listed beyond one for each triangle.
    fn node(&mut self, triangles: Vec<u32>, cell: &Cell, depth: usize, copies: usize) -> u32 {
        let place = self.bsp.nodes.len();
        self.bsp.nodes.push(Node::Leaf([0, 0]));
        let chosen =
            (depth < DEPTH && triangles.len() > self.settings.leaf).then(|| self.choose(&triangles, cell, copies));
        self.bsp.nodes[place] = match chosen.flatten() {
            None => Node::Leaf(self.list(&triangles)),
            Some((plane, division)) => {
                let left = copies - division.cut(triangles.len());
                let [behind, before, within] = self.divide(&plane, &triangles);
                drop(triangles);
                let share =
                    |part: usize| (left as u128 * part as u128 / (behind.len() + before.len()).max(1) as u128) as usize;
                let [for_behind, for_before] = [share(behind.len()), share(before.len())];
                let within = self.list(&within);
                let halves = cell.cut(&plane);
                let children = [
                    self.node(behind, &halves.behind, depth + 1, for_behind),
                    self.node(before, &halves.before, depth + 1, for_before),
                ];
                Node::Split { plane, within, children }
            }
        };
        place as u32
    }

    fn list(&mut self, triangles: &[u32]) -> Places {
        let first = self.bsp.listed.len() as u32;
        self.bsp.listed.extend(triangles);
        [first, self.bsp.listed.len() as u32]
    }

    fn side_of(&self, plane: &Plane, triangle: u32) -> Side {
        plane.side_of(&self.scene.corners[triangle as usize], self.thickness)
    }

    /// The triangles behind a plane, before it, and in it.
    fn divide(&self, plane: &Plane, triangles: &[u32]) -> [Vec<u32>; 3] {
        let mut parts = [const { Vec::new() }; 3];
        for triangle in triangles {
            match self.side_of(plane, *triangle) {
                Side::Behind => parts[0].push(*triangle),
                Side::Before => parts[1].push(*triangle),
                Side::Within => parts[2].push(*triangle),
                Side::Both => parts[..2].iter_mut().for_each(|part| part.push(*triangle)),
            }
        }
        parts
    }

    /// The plane that costs least, the first of equals, if one costs less than to test all triangles.
    fn choose(&self, triangles: &[u32], cell: &Cell, copies: usize) -> Option<(Plane, Division)> {
        let all = triangles.len();
        let surface = cell.area();
        let tried = self.settings.candidates.clamp(1, all);
        let mut best = None;
        let mut least = all as f32;
        // The middles of as many equal runs: lists are in the order of the mesh, where neighbours are often neighbours.
        for candidate in (0..tried).map(|i| triangles[(2 * i + 1) * all / (2 * tried)]) {
            for plane in self.planes_of(&self.scene.corners[candidate as usize]) {
                let division = self.division(&plane, triangles);
                if division.divides(all) && division.cut(all) <= copies {
                    let cost = division.cost(surface, &cell.cut(&plane));
                    if cost < least {
                        (best, least) = (Some((plane, division)), cost);
                    }
                }
            }
        }
        best
    }

    fn division(&self, plane: &Plane, triangles: &[u32]) -> Division {
        triangles.iter().fold(Division::default(), |mut division, triangle| {
            let side = self.side_of(plane, *triangle);
            division.behind += usize::from(matches!(side, Side::Behind | Side::Both));
            division.before += usize::from(matches!(side, Side::Before | Side::Both));
            division.within += usize::from(side == Side::Within);
            division
        })
    }

    /// The plane of a triangle, and those erected on its edges.
    fn planes_of(&self, corners: &[Vec3; 3]) -> impl Iterator<Item = Plane> + use<> {
        let [a, b, c] = *corners;
        let [p, q, r]: [DVec3; 3] = corners.map(|corner| corner.as_dvec3());
        let normal = (q - p).cross(r - p);
        // Of length 1, or the products below would leave the range of numbers.
        let upright = normal.normalize_or_zero();
        let erected = [(a, q - p), (b, r - q), (c, p - r)].map(|(corner, edge)| (corner, edge.cross(upright)));
        let used = if self.settings.erects { 3 } else { 0 };
        let planes = [(a, normal)].into_iter().chain(erected.into_iter().take(used));
        planes.filter_map(|(point, normal)| Plane::through(point, normal))
    }
}
