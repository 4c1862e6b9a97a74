//! `Traced`: a structure and a triangle test make a tracer.

use core::ops::Range;

use leafwalk_core::{CanonicalRay, Clock, Frame, Hit, LengthMismatch, Nearest, Ray, Tracer, one_by_one};

use super::input::Input;
use super::line::Line;
use super::refit_error::RefitError;
use super::structure::{Refit, Search, Structure};
use super::triangles::{InCallersUnits, Meeting, TriangleTest};
use crate::{BuildError, MeshRef};

/// A clock for rays whose numbers are the caller's.
const CALLERS: Clock = Clock { entry: 0.0, unit: 1.0 };

/// A structure over a mesh, with the test that decides what is hit.
#[derive(Clone, Debug)]
pub struct Traced<S, T: TriangleTest> {
    structure: S,
    /// Rays are brought into it first, if the handling is conservative.
    frame: Option<Frame>,
    /// The triangles as tests want them, and their primitives: in the order in which they are listed if the structure
    /// copies them, else in that of the scene.
    triangles: Vec<T::Triangle>,
    primitives: Vec<u32>,
}

impl<S: Structure, T: TriangleTest> Traced<S, T> {
    /// On the lattice, with margins for all rounding.
    ///
    /// # Errors
    /// For the meshes that [`crate::Builder`] refuses.
    pub fn conservative<'a>(mesh: impl Into<MeshRef<'a>>, settings: &S::Settings) -> Result<Self, BuildError> {
        let input = Input::conservative(mesh.into())?;
        Ok(Self::over(S::build(&input.scene, settings), &input))
    }

    fn over(structure: S, input: &Input) -> Self {
        let mut traced = Self { structure, frame: None, triangles: Vec::new(), primitives: Vec::new() };
        traced.take(input);
        traced
    }

    fn take(&mut self, input: &Input) {
        let triangle = |i: &u32| T::triangle(&input.corners[*i as usize]);
        self.frame = input.frame;
        (self.triangles, self.primitives) = match S::COPIES {
            true => (
                self.structure.listed().iter().map(triangle).collect(),
                self.structure.listed().iter().map(|i| input.primitives[*i as usize]).collect(),
            ),
            false => (input.corners.iter().map(T::triangle).collect(), input.primitives.clone()),
        };
    }

    /// The structure.
    pub fn structure(&self) -> &S {
        &self.structure
    }

    /// The bytes that the structure and its triangles take.
    pub fn bytes(&self) -> usize {
        self.structure.bytes() + size_of_val(&self.triangles[..]) + size_of_val(&self.primitives[..])
    }

    /// The closest hit of one ray.
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let ray = self.prepared(ray)?;
        self.search::<false>(&ray).hit(&ray.clock).ok()
    }

    /// Whether anything is hit.
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.prepared(ray).is_some_and(|ray| self.search::<true>(&ray).is_hit())
    }

    /// The ray in the coordinates of the scene, unless it is invalid or passes the scene by.
    fn prepared(&self, ray: &Ray) -> Option<CanonicalRay> {
        let Ray { origin, t_min, direction, t_max } = *ray;
        match &self.frame {
            Some(frame) => frame.canonical(ray),
            None => ray.is_valid().then_some(CanonicalRay {
                origin,
                within: origin,
                t_min,
                direction,
                t_max,
                clock: CALLERS,
            }),
        }
    }

    fn search<const ANY: bool>(&self, ray: &CanonicalRay) -> Nearest {
        let line = Line::new(ray.within, ray.direction, ray.t_min, ray.t_max);
        let mut search = Finding::<S, T, ANY> { traced: self, ray: T::ray(ray), nearest: Nearest::new(ray) };
        self.structure.visit(&line, &mut search);
        search.nearest
    }
}

impl<S: Structure, T: InCallersUnits> Traced<S, T> {
    /// In the caller's numbers, without margins. The numbers of a mesh of f64 are rounded to f32.
    ///
    /// # Errors
    /// For the meshes that [`crate::Builder`] refuses.
    pub fn as_published<'a>(mesh: impl Into<MeshRef<'a>>, settings: &S::Settings) -> Result<Self, BuildError> {
        let input = Input::as_published(mesh.into())?;
        Ok(Self::over(S::build(&input.scene, settings), &input))
    }
}

impl<S: Refit, T: TriangleTest> Traced<S, T> {
    /// Follows vertices that moved, in the way of handling that it was made for.
    ///
    /// # Errors
    /// If the mesh can't be built, or has other triangles than the one that this was made over; nothing is changed then.
    pub fn refit<'a>(&mut self, mesh: impl Into<MeshRef<'a>>) -> Result<(), RefitError> {
        let mesh = mesh.into();
        let input = match self.frame {
            Some(_) => Input::conservative(mesh),
            None => Input::as_published(mesh),
        };
        let input = input.map_err(RefitError::Build)?;
        let [found, expected] = [input.primitives.len(), self.primitives.len()];
        if found != expected {
            return Err(RefitError::OtherTriangles { found, expected });
        }
        self.structure.refit(&input.scene);
        self.take(&input);
        Ok(())
    }
}

/// The search for a ray's nearest hit, or for any.
struct Finding<'a, S, T: TriangleTest, const ANY: bool> {
    traced: &'a Traced<S, T>,
    ray: T::Ray,
    nearest: Nearest,
}

impl<S: Structure, T: TriangleTest, const ANY: bool> Search for Finding<'_, S, T, ANY> {
    #[inline]
    fn test(&mut self, listed: Range<usize>) {
        for place in listed {
            let place = if S::COPIES { place } else { self.traced.structure.listed()[place] as usize };
            if let Some(Meeting { t, u, v }) = T::meet(&self.ray, &self.traced.triangles[place]) {
                self.nearest.offer(true, t, u, v, self.traced.primitives[place]);
            }
        }
        if ANY {
            self.nearest.finish();
        }
    }

    #[inline]
    fn end(&self) -> f32 {
        self.nearest.t
    }
}

impl<S: Structure, T: TriangleTest> Tracer for Traced<S, T> {
    type Error = LengthMismatch;

    fn closest_hits(&self, rays: &[Ray], hits: &mut [Hit]) -> Result<(), LengthMismatch> {
        one_by_one(rays, hits, |ray| Hit::from(self.closest_hit(ray)))
    }

    fn occlusions(&self, rays: &[Ray], occluded: &mut [bool]) -> Result<(), LengthMismatch> {
        one_by_one(rays, occluded, |ray| self.occluded(ray))
    }
}
