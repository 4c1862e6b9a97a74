//! Ours: anything that is a `Tracer` over an octree.

use core::hash::{Hash, Hasher};
use core::time::Duration;
use std::hash::DefaultHasher;

use leafwalk::{Builder, CpuTracer, Hit, LengthMismatch, Mesh, Octree, Ray, Tracer, Way, hit_hash};

use super::{Answer, Prepared, Rival, timed};

/// What a user gets who asks for nothing special.
pub const DEFAULT: &str = "leafwalk";
/// One ray a call, one number at a time.
const SCALAR: &str = "leafwalk scalar";
/// One ray a call.
pub const SINGLE: &str = "leafwalk single";
/// From leaf to leaf, in eight lanes.
const WALK: &str = "leafwalk walk";
/// Over a compact octree.
const COMPACT: &str = "leafwalk compact";
/// Over a compact octree, one ray a call.
const COMPACT_SINGLE: &str = "leafwalk compact single";
/// As tables list them.
pub const NAMES: [&str; 6] = [DEFAULT, SCALAR, SINGLE, WALK, COMPACT, COMPACT_SINGLE];

/// What most users get.
pub fn default(octree: &Octree<Vec<u32>>) -> Box<dyn Rival + '_> {
    ours(DEFAULT, octree, CpuTracer::new(octree.view()))
}

/// All tracers of ours, over an octree and the compact one of the same mesh. A further one takes a line here, and its name
/// above.
pub fn all<'a>(octree: &'a Octree<Vec<u32>>, compact: &'a Octree<Vec<u32>>) -> Vec<Box<dyn Rival + 'a>> {
    vec![
        default(octree),
        ours(SCALAR, octree, octree),
        ours(SINGLE, octree, Single(CpuTracer::new(octree.view()))),
        ours(WALK, octree, CpuTracer::new(octree.view()).with_way(Way::Walk)),
        ours(COMPACT, compact, CpuTracer::new(compact.view())),
        ours(COMPACT_SINGLE, compact, Single(CpuTracer::new(compact.view()))),
    ]
}

/// Any tracer with its own hits.
pub fn any(name: &'static str, tracer: impl Tracer + 'static, bytes: usize) -> Box<dyn Rival> {
    Box::new(Ours { name, tracer, bytes })
}

fn ours<'a>(name: &'static str, octree: &Octree<Vec<u32>>, tracer: impl Tracer + 'a) -> Box<dyn Rival + 'a> {
    Box::new(Ours { name, tracer, bytes: size_of_val(octree.as_words()) })
}

struct Ours<T> {
    name: &'static str,
    tracer: T,
    bytes: usize,
}

impl<T: Tracer> Rival for Ours<T> {
    fn name(&self) -> &str {
        self.name
    }
    fn is_ours(&self) -> bool {
        true
    }
    fn bytes(&self) -> Option<usize> {
        Some(self.bytes)
    }
    fn rebuild(&self, mesh: &Mesh) -> Option<Duration> {
        let builder = match self.name {
            DEFAULT => Builder::new(),
            COMPACT => Builder::new().compact(),
            _ => return None,
        };
        Some(timed(|| builder.build(mesh).is_ok()).1)
    }
    fn closest<'a>(&'a self, rays: &'a [Ray]) -> Box<dyn Prepared<Answer> + 'a> {
        Box::new(Batch { tracer: &self.tracer, rays, answers: vec![Hit::MISS; rays.len()] })
    }
    fn occluded<'a>(&'a self, rays: &'a [Ray]) -> Box<dyn Prepared<bool> + 'a> {
        Box::new(Batch { tracer: &self.tracer, rays, answers: vec![false; rays.len()] })
    }
}

struct Batch<'a, T, A> {
    tracer: &'a T,
    rays: &'a [Ray],
    answers: Vec<A>,
}

impl<T: Tracer> Prepared<Answer> for Batch<'_, T, Hit> {
    fn trace(&mut self) {
        self.tracer.closest_hits(self.rays, &mut self.answers).expect("equal lengths");
    }
    fn answers(&self) -> Vec<Answer> {
        self.answers.iter().map(|hit| Answer { t: hit.t, primitive: hit.primitive }).collect()
    }
    fn hash(&self) -> Option<u64> {
        Some(hit_hash(&self.answers))
    }
}

impl<T: Tracer> Prepared<bool> for Batch<'_, T, bool> {
    fn trace(&mut self) {
        self.tracer.occlusions(self.rays, &mut self.answers).expect("equal lengths");
    }
    fn answers(&self) -> Vec<bool> {
        self.answers.clone()
    }
    fn hash(&self) -> Option<u64> {
        let mut hasher = DefaultHasher::new();
        self.answers.hash(&mut hasher);
        Some(hasher.finish())
    }
}

/// The tracer as it is when it is called with one ray at a time.
struct Single<'a>(CpuTracer<&'a [u32]>);

impl Tracer for Single<'_> {
    type Error = LengthMismatch;

    fn closest_hits(&self, rays: &[Ray], hits: &mut [Hit]) -> Result<(), LengthMismatch> {
        leafwalk::one_by_one(rays, hits, |ray| Hit::from(self.0.closest_hit(ray)))
    }
    fn occlusions(&self, rays: &[Ray], occluded: &mut [bool]) -> Result<(), LengthMismatch> {
        leafwalk::one_by_one(rays, occluded, |ray| self.0.occluded(ray))
    }
}
