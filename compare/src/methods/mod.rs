//! `Method`: the ways to trace rays that are compared, by name.

mod ours;
mod structures;

use core::fmt;

use leafwalk_core::{LengthMismatch, Tracer};
use leafwalk_cpu::{BuildError, MeshRef};

/// How a method handles rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Handling {
    /// As this library does.
    Ours,
    /// On the lattice, with margins: no answer differs from what testing every triangle gives.
    Conservative,
    /// In the caller's numbers, without margins, as published.
    AsPublished,
}

impl fmt::Display for Handling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Ours => "ours",
            Self::Conservative => "conservative",
            Self::AsPublished => "as published",
        })
    }
}

/// A structure, a triangle test and a way to handle rounding.
#[derive(Clone, Copy, Debug)]
pub struct Method {
    /// How tables and charts call it; no two have the same.
    pub name: &'static str,
    /// The family that charts draw alike: octree, grid, kd-tree, ...
    pub family: &'static str,
    /// The triangle test.
    pub test: &'static str,
    /// How rounding is handled.
    pub handling: Handling,
    /// Author, title and year; of ours, the module.
    pub source: &'static str,
    build: fn(MeshRef<'_>) -> Result<Built, BuildError>,
}

impl Method {
    /// Builds it over a mesh.
    ///
    /// # Errors
    /// For the meshes that [`leafwalk_cpu::Builder`] refuses.
    pub fn build<'a>(&self, mesh: impl Into<MeshRef<'a>>) -> Result<Built, BuildError> {
        (self.build)(mesh.into())
    }
}

/// A method over a mesh.
pub struct Built {
    /// Traces rays.
    pub tracer: Box<dyn Tracer<Error = LengthMismatch> + Send + Sync>,
    /// The bytes that it traces with, triangles included.
    pub bytes: usize,
}

/// All methods: ours first, then family by family.
pub fn all() -> Vec<Method> {
    [ours::METHODS, structures::METHODS].concat()
}

/// The methods that have a text in their names.
pub fn named(part: &str) -> Vec<Method> {
    all().into_iter().filter(|method| method.name.contains(part)).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use leafwalk_core::{Hit, Ray};
    use leafwalk_cpu::{BruteForce, Mesh};
    use leafwalk_testing::{meshes, random::Random, rays};

    use super::*;

    /// How many of some hard rays at a mesh get other bits than by testing every triangle, and how many a hit for a miss or a
    /// miss for a hit.
    fn differing(method: &Method, mesh: &Mesh) -> [usize; 2] {
        let (centre, size) = rays::extent(mesh);
        let rays: Vec<Ray> = (0..2000).map(|i| rays::hard(mesh, centre, size, &mut Random::new(301, i))).collect();
        let mut hits = vec![Hit::MISS; rays.len()];
        let built = method.build(mesh).expect("a mesh that builds");
        assert!(built.bytes > 0, "{}", method.name);
        built.tracer.closest_hits(&rays, &mut hits).expect("equal lengths");
        let oracle = BruteForce::new(mesh).expect("a mesh that builds");
        let answers: Vec<_> =
            rays.iter().map(|ray| oracle.closest_hit(ray)).zip(hits.into_iter().map(|hit| hit.ok())).collect();
        [
            answers.iter().filter(|(expected, found)| expected != found).count(),
            answers.iter().filter(|(expected, found)| expected.is_some() != found.is_some()).count(),
        ]
    }

    #[test]
    fn names_are_told_apart() {
        let names: BTreeSet<_> = all().iter().map(|method| method.name).collect();
        assert_eq!(names.len(), all().len());
    }

    #[test]
    fn methods_with_margins_answer_alike_and_all_answer() {
        let meshes = [meshes::bumpy_sphere(3, 302), meshes::walls(40, 303)];
        for method in all() {
            for mesh in &meshes {
                let [bits, misses] = differing(&method, mesh);
                println!("{}: {bits} differ, {misses} of them in whether anything is hit", method.name);
                match method.handling {
                    Handling::AsPublished => assert!(misses < 500, "{}", method.name),
                    _ => assert_eq!(bits, 0, "{}", method.name),
                }
            }
        }
    }

    #[test]
    fn what_cannot_be_built_is_refused_by_all() {
        let mesh = Mesh::new(vec![[0.0; 3], [f32::NAN, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]);
        for method in all() {
            assert!(method.build(&mesh).is_err(), "{}", method.name);
        }
    }
}
