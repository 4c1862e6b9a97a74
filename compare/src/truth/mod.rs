//! The truth about a ray: its closest hit on the caller's own mesh, decided exactly, and what it says of an answer.
//!
//! ```text
//! truth(ray): for every triangle that the hierarchy shows
//!     sides of the three edges: signs of volumes in f64, or of integers where a volume is within its error
//!     t: a quotient of volumes in f64, or of integers where it is uncertain
//!     keep the smallest t, and all triangles that have just that t
//! ```
//! An edge belongs to both of its triangles. All that is judged is what the caller gave: rays and vertices as they are,
//! before any tracer rounds them.

mod counts;
mod exact;
mod hierarchy;
mod line;
mod passing;
#[cfg(test)]
mod second;

use core::cmp::Ordering;

use glam::DVec3;
use leafwalk_core::RayF64;
use leafwalk_cpu::MeshRef;
use rayon::prelude::*;

pub use counts::{Counts, per_million};
pub use passing::{Distance, Excess, LATERAL_ERROR, Slack};

use hierarchy::Hierarchy;
use line::{Crossing, Line};

/// A t that is off by more than this share of itself is not the truth: four orders of magnitude above what f32 can hold, and
/// below the distance of surfaces that one would tell apart.
const SAME: f64 = 1e-4;

/// Knows the truth about rays.
pub struct Oracle {
    triangles: Vec<[DVec3; 3]>,
    hierarchy: Hierarchy,
}

/// What a ray hits first.
#[derive(Clone, Debug, PartialEq)]
pub struct Hit {
    /// Off by less than 2^-40 of itself.
    pub t: f64,
    /// A triangle with this t.
    pub primitive: u32,
    /// The other triangles with just the same t: those that share the edge or the vertex that the ray passes through, or lie
    /// upon each other.
    pub others: Vec<u32>,
}

/// What is to be said of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It is the truth.
    Right,
    /// Another triangle at the same t: beside an edge, either triangle is as good.
    Neighbour,
    /// The right triangle at a t that is off: where hits are close, and their triangles are large.
    Off,
    /// A hit on another surface.
    Wrong,
    /// There is a hit, and it says that there is none.
    Missed,
    /// There is no hit, and it says that there is one.
    False,
}

impl Verdict {
    /// On the answer whether a ray hits anything.
    pub fn on_occlusion(truth: Option<&Hit>, occluded: bool) -> Self {
        match (truth.is_some(), occluded) {
            (true, false) => Self::Missed,
            (false, true) => Self::False,
            _ => Self::Right,
        }
    }
}

impl Oracle {
    /// Of the triangles of a mesh.
    pub fn new<'a>(mesh: impl Into<MeshRef<'a>>) -> Self {
        let mesh = mesh.into();
        let corners = |primitive| mesh.corners(primitive).map(DVec3::from_array);
        let triangles: Vec<_> = (0..mesh.triangles().len()).map(corners).collect();
        Self { hierarchy: Hierarchy::new(&triangles), triangles }
    }

    /// The closest hit of a ray.
    pub fn closest<R: Copy + Into<RayF64>>(&self, ray: &R) -> Option<Hit> {
        let line = Line::of(&(*ray).into())?;
        let mut closest: Option<(Crossing, Hit)> = None;
        self.hierarchy.visit(&line, |corners, primitive, to| {
            let Some(crossing) = line.crossing(corners) else { return };
            let first = |crossing: Crossing| (crossing, Hit { t: crossing.t, primitive, others: Vec::new() });
            let Some((best, hit)) = &mut closest else {
                *to = crossing.t + crossing.error;
                closest = Some(first(crossing));
                return;
            };
            let beside = &self.triangles[hit.primitive as usize];
            match line.order([(corners, crossing), (beside, *best)]) {
                Ordering::Less => {
                    *to = crossing.t + crossing.error;
                    closest = Some(first(crossing));
                }
                Ordering::Equal => hit.others.push(primitive),
                Ordering::Greater => {}
            }
        });
        closest.map(|(_, hit)| hit)
    }

    /// The closest hits of many rays, on every core.
    pub fn closest_hits<R: Copy + Into<RayF64> + Sync>(&self, rays: &[R]) -> Vec<Option<Hit>> {
        rays.par_iter().map(|ray| self.closest(ray)).collect()
    }

    /// Judges the answer that a ray has its closest hit at `t` on a triangle; infinity for a miss.
    pub fn judge<R>(&self, ray: &R, truth: Option<&Hit>, t: impl Into<f64>, primitive: u32) -> Verdict
    where
        R: Copy + Into<RayF64>,
    {
        let t = t.into();
        match truth {
            None if t == f64::INFINITY => Verdict::Right,
            None => Verdict::False,
            Some(_) if t == f64::INFINITY => Verdict::Missed,
            Some(hit) => {
                let is_same = hit.primitive == primitive || hit.others.contains(&primitive);
                let is_off = (t - hit.t).abs() > SAME * hit.t.abs();
                match (is_same, is_off) {
                    (true, false) => Verdict::Right,
                    (true, true) => Verdict::Off,
                    (false, false) if self.is_near(primitive, &(*ray).into(), hit.t) => Verdict::Neighbour,
                    (false, _) => Verdict::Wrong,
                }
            }
        }
    }

    /// Whether a point of a ray lies at a triangle: in its box, but for as much of the distance as hits may be off.
    fn is_near(&self, primitive: u32, ray: &RayF64, t: f64) -> bool {
        let Some([a, b, c]) = self.triangles.get(primitive as usize) else { return false };
        let travelled = t * DVec3::from_array(ray.direction);
        let (at, slack) = (DVec3::from_array(ray.origin) + travelled, DVec3::splat(SAME * travelled.length()));
        let (lower, upper) = (a.min(*b).min(*c) - slack, a.max(*b).max(*c) + slack);
        at.clamp(lower, upper) == at
    }
}

#[cfg(test)]
mod tests {
    use leafwalk_core::Ray;
    use leafwalk_cpu::Mesh;

    use super::*;
    // Rays and numbers of the instance of this package that makes the scenes.
    use leafwalk_testing::random::Random;
    use leafwalk_testing::{meshes, rays, wide};

    /// The closest hit by integers alone, among all triangles.
    fn by_integers(oracle: &Oracle, ray: &Ray) -> Option<(f64, Vec<u32>)> {
        let line = Line::of(&(*ray).into())?;
        let mut closest: Option<(exact::Ratio, Vec<u32>)> = None;
        for (primitive, corners) in (0..).zip(&oracle.triangles) {
            let exact = line.exact(corners);
            let signs = exact.sides();
            if signs.contains(&Ordering::Less) == signs.contains(&Ordering::Greater) {
                continue;
            }
            let t = exact.distance();
            let is_before_end = line.to == f64::INFINITY || t.order_to(line.to).is_lt();
            if t.order_to(line.from).is_le() || !is_before_end {
                continue;
            }
            match closest.as_mut().map(|(best, primitives)| (t.order(best), primitives)) {
                Some((Ordering::Greater, _)) => {}
                Some((Ordering::Equal, primitives)) => primitives.push(primitive),
                _ => closest = Some((t, vec![primitive])),
            }
        }
        closest.map(|(t, primitives)| (t.to_f64(), primitives))
    }

    fn check(oracle: &Oracle, rays: &[Ray]) {
        let mut hits = 0;
        for ray in rays {
            let expected = by_integers(oracle, ray);
            let found = oracle.closest(ray).map(|hit| {
                let mut primitives = [vec![hit.primitive], hit.others].concat();
                primitives.sort_unstable();
                (hit.t, primitives)
            });
            match (&found, &expected) {
                (Some((t, primitives)), Some((exact_t, exact))) => {
                    hits += 1;
                    assert_eq!(primitives, exact, "{}", rays::hex(ray));
                    assert!((t - exact_t).abs() <= 2f64.powi(-39) * exact_t.abs(), "{t} {exact_t} {}", rays::hex(ray));
                }
                _ => assert_eq!(found, expected, "{}", rays::hex(ray)),
            }
        }
        assert!(20 * hits > rays.len(), "{hits} hits in {} rays test too little", rays.len());
    }

    #[test]
    fn truth_is_what_integers_say_of_every_triangle() {
        let scenes = [
            meshes::icosphere(2),
            meshes::needle_box(20),
            meshes::soup(200, 71),
            meshes::shards(200, 1e-3..4.0, 1e6, 72),
            meshes::placed(&meshes::icosphere(2), 1.0, 1e6),
        ];
        for (seed, mesh) in (73..).zip(&scenes) {
            let (centre, size) = rays::extent(mesh);
            let hard = |index| rays::hard(mesh, centre, size, &mut Random::new(seed, index));
            check(&Oracle::new(mesh), &(0..500).map(hard).collect::<Vec<_>>());
        }
    }

    #[test]
    fn truth_of_wide_scenes_is_what_integers_say() {
        for scene in wide::all().iter().filter(|scene| scene.mesh.triangles.len() < 100) {
            let ray = |index| scene.ray(&mut Random::new(78, index));
            check(&Oracle::new(&scene.mesh), &(0..200).map(ray).collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_second_oracle_says_the_same() {
        let scenes = [
            meshes::icosphere(2),
            meshes::needle_box(20),
            meshes::soup(200, 174),
            meshes::placed(&meshes::icosphere(2), 1.0, 1e6),
        ];
        for (seed, mesh) in (175..).zip(&scenes) {
            let (centre, size) = rays::extent(mesh);
            let oracle = Oracle::new(mesh);
            let mut hits = 0;
            for index in 0..200 {
                let ray = rays::hard(mesh, centre, size, &mut Random::new(seed, index));
                let (found, expected) = (oracle.closest(&ray), second::closest(&oracle, &ray.into()));
                assert!(
                    second::agrees(found.as_ref(), expected.as_ref()),
                    "{found:?}, {expected:?}, {}",
                    rays::hex(&ray)
                );
                hits += u32::from(found.is_some());
                // It would notice a hit that is another.
                let other = found.map(|hit| Hit { primitive: hit.primitive + 1, ..hit });
                assert!(other.is_none() || !second::agrees(other.as_ref(), expected.as_ref()), "{}", rays::hex(&ray));
            }
            assert!(hits > 20, "{hits} hits test too little");
        }
    }

    #[test]
    fn an_edge_is_both_of_its_triangles() {
        let mesh = Mesh::new(
            vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
            vec![[0, 1, 2], [0, 2, 3]],
        );
        let oracle = Oracle::new(&mesh);
        let ray = Ray::new([0.3, 0.3, 1.0], [0.0, 0.0, -3.0]);
        let truth = oracle.closest(&ray).expect("a hit");
        let judge = |t, primitive| oracle.judge(&ray, Some(&truth), t, primitive);
        let third = 1.0 / 3.0;
        assert_eq!((judge(third, 0), judge(third, 1)), (Verdict::Right, Verdict::Right));
        assert_eq!((judge(f32::INFINITY, 0), judge(third, 2)), (Verdict::Missed, Verdict::Wrong));
        assert_eq!((judge(third * 1.001, 0), judge(third * 1.001, 2)), (Verdict::Off, Verdict::Wrong));
        let beside = Ray { origin: [0.3, 0.3f32.next_up(), 1.0], ..ray };
        let truth = oracle.closest(&beside).expect("a hit");
        assert_eq!((truth.primitive, truth.others.len()), (1, 0));
        assert_eq!(oracle.judge(&beside, Some(&truth), third, 0), Verdict::Neighbour);
        assert_eq!(oracle.judge(&ray, None, third, 0), Verdict::False);
    }
}
