//! What f64 says about rays, on the caller's own mesh.
//!
//! Candidates are the triangles in the leaves that our walk visits, and the walk goes on past what it takes for a hit
//! until f64 agrees: so a false hit of ours hides nothing.

use std::collections::HashMap;

use glam::DVec3;
use leafwalk::{Mesh, Octree, Parts, Ray};
use leafwalk_core::Walk;
use leafwalk_core::contract::ROUNDOFF;
use leafwalk_rivals::Answer;

/// How far beside a ray the rays pass that must agree with it, in roundoffs of how far away things are: twice the eight
/// or so products of that length that a triangle test in f32 rounds, so that what counts as wrong is lost, not rounded.
/// Four times as much gives the same counts on all scenes, but for hits that lie as close as that to a ray's start.
const BESIDE: f64 = 16.0;

/// How far, in sizes of the scene, a hit may lie from where it should: three orders of magnitude above what f32 rounds
/// hits by, and one or more below the thickness of things.
const DISTANCE: f64 = 1e-4;

/// Rays beside a ray, in a ring: enough that no edge which the ray grazes passes between them.
const RING: usize = 8;

/// Where rays of one workload hit.
pub(crate) struct Truth<'a> {
    parts: Parts<'a>,
    mesh: &'a Mesh,
    centre: DVec3,
    size: f64,
    rays: &'a [Ray],
    /// Distance to the closest hit, in units of length.
    closest: Vec<Option<f64>>,
    /// The rays that some tracer disagrees on.
    verdicts: HashMap<usize, Verdict>,
}

/// What must be answered.
#[derive(Clone, Copy)]
enum Verdict {
    Miss,
    /// A hit between two distances.
    Hit(f64, f64),
    /// Both a hit and a miss may be right, or hits far from each other.
    Open,
}

/// A line in f64; distances along it count from the origin in units of length.
#[derive(Clone, Copy)]
struct Line {
    origin: DVec3,
    along: DVec3,
    from: f64,
    to: f64,
}

impl Line {
    fn new(ray: &Ray) -> Self {
        let along = point(ray.direction);
        let length = along.length();
        let limit = |t: f32| f64::from(t) * length;
        Self { origin: point(ray.origin), along: along / length, from: limit(ray.t_min), to: limit(ray.t_max) }
    }

    /// Where the line passes through a triangle. Neighbours that share an edge leave no gap: its two sides are
    /// computed alike.
    fn meets(&self, [a, b, c]: [DVec3; 3]) -> Option<f64> {
        let [a, b, c] = [a, b, c].map(|corner| corner - self.origin);
        let sides = [(b, c), (c, a), (a, b)].map(|(p, q)| self.along.dot(p.cross(q)));
        let total: f64 = sides.iter().sum();
        let is_inside = sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0);
        let distance = || (sides[0] * a + sides[1] * b + sides[2] * c).dot(self.along) / total;
        (is_inside && total != 0.0).then(distance).filter(|distance| self.from < *distance && *distance < self.to)
    }
}

fn point(p: [f32; 3]) -> DVec3 {
    DVec3::from_array(p.map(f64::from))
}

impl<'a> Truth<'a> {
    /// Finds the closest hits.
    pub(crate) fn new(octree: &'a Octree<Vec<u32>>, mesh: &'a Mesh, rays: &'a [Ray]) -> Self {
        let bounds = octree.bounds();
        let (lower, upper) = (DVec3::from_array(bounds.lower), DVec3::from_array(bounds.upper));
        let (centre, size) = (0.5 * (lower + upper), (upper - lower).max_element());
        let verdicts = HashMap::new();
        let mut truth = Self { parts: octree.parts(), mesh, centre, size, rays, closest: Vec::new(), verdicts };
        let mut listed = Vec::new();
        let closest = |ray: &Ray| {
            let line = Line::new(ray);
            listed.clear();
            truth.list(ray, &line, &mut listed);
            truth.first(&line, &listed)
        };
        truth.closest = rays.iter().map(closest).collect();
        truth
    }

    /// Whether an answer is wrong beyond all doubt.
    pub(crate) fn is_wrong_hit(&mut self, ray: usize, answer: Answer) -> bool {
        let distance = f64::from(answer.t) * point(self.rays[ray].direction).length();
        let slack = DISTANCE * self.size;
        if distance == f64::INFINITY {
            return self.closest[ray].is_some() && matches!(self.verdict(ray), Verdict::Hit(..));
        }
        let is_near = |low: f64, high: f64| low - slack <= distance && distance <= high + slack;
        if self.closest[ray].is_none_or(|closest| !is_near(closest, closest)) {
            match self.verdict(ray) {
                Verdict::Miss => return true,
                Verdict::Hit(low, high) if high - low <= slack => return !is_near(low, high),
                _ => {}
            }
        }
        !self.is_on(answer.primitive, &Line::new(&self.rays[ray]), distance)
    }

    /// Whether an answer to a question of occlusion is wrong beyond all doubt.
    pub(crate) fn is_wrong_occlusion(&mut self, ray: usize, occluded: bool) -> bool {
        occluded != self.closest[ray].is_some()
            && match self.verdict(ray) {
                Verdict::Miss => occluded,
                Verdict::Hit(..) => !occluded,
                Verdict::Open => false,
            }
    }

    /// Whether a point of a line lies at a triangle: in its box.
    fn is_on(&self, primitive: u32, line: &Line, distance: f64) -> bool {
        let Some(triangle) = self.mesh.triangles.get(primitive as usize) else { return false };
        let [a, b, c] = triangle.map(|index| point(self.mesh.positions[index as usize]));
        let (at, slack) = (line.origin + distance * line.along, DVec3::splat(DISTANCE * self.size));
        let (lower, upper) = (a.min(b).min(c) - slack, a.max(b).max(c) + slack);
        at.clamp(lower, upper) == at
    }

    fn verdict(&mut self, ray: usize) -> Verdict {
        if let Some(verdict) = self.verdicts.get(&ray) {
            return *verdict;
        }
        let verdict = self.judge(&self.rays[ray]);
        self.verdicts.insert(ray, verdict);
        verdict
    }

    /// Asks the rays around a ray, with limits a little wider and a little narrower.
    fn judge(&self, ray: &Ray) -> Verdict {
        let line = Line::new(ray);
        let reach = self.size.max(line.origin.distance(self.centre));
        let radius = BESIDE * f64::from(ROUNDOFF) * reach;
        let (u, v) = line.along.any_orthonormal_pair();
        let offset = |i: usize| match i {
            0 => DVec3::ZERO,
            _ => {
                let (sin, cos) = (i as f64 * core::f64::consts::TAU / RING as f64).sin_cos();
                radius * (cos * u + sin * v)
            }
        };
        let wide = Line { from: line.from - radius, to: line.to + radius, ..line };
        let length = point(ray.direction).length();
        let mut listed = Vec::new();
        for offset in (0..=RING).map(offset) {
            let line = Line { origin: wide.origin + offset, ..wide };
            let origin = line.origin.to_array().map(|c| c as f32);
            let (t_min, t_max) = ((line.from / length) as f32, (line.to / length) as f32);
            self.list(&Ray { origin, t_min, t_max, ..*ray }, &line, &mut listed);
        }
        listed.sort_unstable();
        listed.dedup();
        let margins = [radius, -radius];
        let lines = (0..=RING).map(offset).flat_map(|offset| {
            let origin = line.origin + offset;
            margins.map(|margin| Line { origin, from: line.from - margin, to: line.to + margin, ..line })
        });
        let mut verdict = None;
        for line in lines {
            verdict = match (verdict, self.first(&line, &listed)) {
                (None, None) | (Some(Verdict::Miss), None) => Some(Verdict::Miss),
                (None, Some(at)) => Some(Verdict::Hit(at, at)),
                (Some(Verdict::Hit(low, high)), Some(at)) => Some(Verdict::Hit(low.min(at), high.max(at))),
                _ => return Verdict::Open,
            };
        }
        verdict.unwrap_or(Verdict::Open)
    }

    /// The first hit of a line among some triangles.
    fn first(&self, line: &Line, listed: &[u32]) -> Option<f64> {
        let corners = |primitive: &u32| self.mesh.corners(*primitive as usize).map(point);
        let distances = listed.iter().filter_map(|primitive| line.meets(corners(primitive)));
        distances.min_by(f64::total_cmp)
    }

    /// Adds the triangles that may be a ray's closest hit.
    fn list(&self, ray: &Ray, line: &Line, listed: &mut Vec<u32>) {
        let walk = Walk::new(&self.parts);
        let mut ray = *ray;
        let start = listed.len();
        loop {
            walk.visit(&ray, |record, _| {
                let leaf = &self.parts.records[record as usize];
                listed.extend(self.parts.triangles_of(leaf).map(|triangle| triangle.primitive));
            });
            let Some(hit) = walk.closest_hit(&ray) else { return };
            // It stopped there: right if f64 has a hit no later.
            let stop = f64::from(hit.t) * point(ray.direction).length() + DISTANCE * self.size;
            if self.first(line, &listed[start..]).is_some_and(|first| first <= stop) {
                return;
            }
            ray.t_min = ray.t_min.max(hit.t).next_up();
        }
    }
}
