//! The tracers that we compare with, each behind the same two questions.
//!
//! Rays are put into a tracer's own form, and its answers into ours, outside of what is timed. Timed is that a tracer
//! reads the rays as its user would hold them, and writes the answers as it gives them.

use core::time::Duration;
use std::time::Instant;

use cpu_time::ProcessTime;
use leafwalk::{Mesh, Ray};

pub mod bvh;
#[cfg(feature = "embree")]
#[allow(unsafe_code, reason = "a binding to C")]
pub mod embree;
pub mod obvhs;
pub mod ours;
pub mod parry;
mod quantile;
#[cfg(feature = "tinybvh")]
#[allow(unsafe_code, reason = "a binding to C++")]
pub mod tinybvh;
pub mod triangle;

pub use quantile::quantile;

/// All tracers but ours that this build knows.
pub fn all(mesh: &Mesh) -> Vec<Box<dyn Rival>> {
    let mut rivals: Vec<Box<dyn Rival>> = vec![
        Box::new(obvhs::Cwbvh::new(mesh).0),
        Box::new(obvhs::Binary::new(mesh).0),
        Box::new(parry::Parry::new(mesh).0),
        Box::new(bvh::Plain::new(mesh).0),
    ];
    rivals.extend(for_any_extent(mesh));
    #[cfg(feature = "tinybvh")]
    match tinybvh::Bvh8::new(mesh) {
        Some((bvh, _)) => rivals.push(Box::new(bvh)),
        None => println!("skipped: tinybvh: this CPU has no AVX2 and FMA"),
    }
    rivals
}

/// The rivals that take meshes of any extent. The others panic where a mesh has very large or very small numbers.
pub fn for_any_extent(mesh: &Mesh) -> Vec<Box<dyn Rival>> {
    #[cfg(feature = "embree")]
    return embree::all(mesh, &embree::SETTINGS);
    #[cfg(not(feature = "embree"))]
    {
        let _ = mesh;
        Vec::new()
    }
}

/// The closest hit of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// In multiples of the ray's direction; infinity for a miss.
    pub t: f32,
    /// The triangle; any number for a miss.
    pub primitive: u32,
}

impl Answer {
    /// The answer of a ray that hits nothing.
    pub const MISS: Self = Self { t: f32::INFINITY, primitive: u32::MAX };
}

/// A tracer under measurement.
pub trait Rival {
    /// As tables print it.
    fn name(&self) -> &str;
    /// Whether it is ours, whatever its name.
    fn is_ours(&self) -> bool {
        false
    }
    /// What it holds in memory to trace with, the caller's mesh not counted; `None` where it can't be told.
    fn bytes(&self) -> Option<usize>;
    /// Builds its structure once more, for the time that takes; `None` where another tracer stands for the same one.
    fn rebuild(&self, mesh: &Mesh) -> Option<Duration>;
    /// Ready to find the closest hit of each ray.
    fn closest<'a>(&'a self, rays: &'a [Ray]) -> Box<dyn Prepared<Answer> + 'a>;
    /// Ready to say of each ray whether it hits anything.
    fn occluded<'a>(&'a self, rays: &'a [Ray]) -> Box<dyn Prepared<bool> + 'a>;
}

/// Rays in a tracer's own form, and room for their answers.
pub trait Prepared<A> {
    /// Undoes what tracing did to the rays. Not timed.
    fn reset(&mut self) {}
    /// Traces all rays: this is timed.
    fn trace(&mut self);
    /// What the last trace answered, ray by ray. Not timed.
    fn answers(&self) -> Vec<A>;
    /// A hash of all bits of the answers, from tracers that promise the same bits.
    fn hash(&self) -> Option<u64> {
        None
    }
}

/// [`Prepared`] for tracers that are called with one ray at a time.
struct OneByOne<R, H, T, C> {
    rays: Vec<R>,
    hits: Vec<H>,
    trace: T,
    convert: C,
}

impl<R, H: Clone, T: Fn(&R) -> H, C> OneByOne<R, H, T, C> {
    fn new(rays: &[Ray], form: impl Fn(&Ray) -> R, miss: H, trace: T, convert: C) -> Self {
        Self { hits: vec![miss; rays.len()], rays: rays.iter().map(form).collect(), trace, convert }
    }
}

impl<R, H, A, T: Fn(&R) -> H, C: Fn(&R, &H) -> A> Prepared<A> for OneByOne<R, H, T, C> {
    fn trace(&mut self) {
        for (ray, hit) in self.rays.iter().zip(&mut self.hits) {
            *hit = (self.trace)(ray);
        }
    }
    fn answers(&self) -> Vec<A> {
        self.rays.iter().zip(&self.hits).map(|(ray, hit)| (self.convert)(ray, hit)).collect()
    }
}

/// Runs something and says how much time all threads of this process spent on it together. Others who use the same
/// cores hardly disturb it.
pub fn timed<T>(run: impl FnOnce() -> T) -> (T, Duration) {
    let start = ProcessTime::now();
    let result = run();
    (result, start.elapsed())
}

/// Runs something and says how long it took by the clock on the wall.
pub fn timed_by_wall<T>(run: impl FnOnce() -> T) -> (T, Duration) {
    let start = Instant::now();
    let result = run();
    (result, start.elapsed())
}
