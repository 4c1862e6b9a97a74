//! `Traced`: a structure and a triangle test make a tracer.

use core::ops::Range;

use glam::Vec3;
use leafwalk_core::contract::BOX_MARGIN;
use leafwalk_core::{CanonicalRay, Clock, Frame, Hit, LengthMismatch, Nearest, Ray, Tracer, one_by_one};

use super::line::Line;
use super::scene::Scene;
use super::structure::{Search, Structure};
use super::triangles::{InCallersUnits, Meeting, TriangleTest};
use crate::{BruteForce, BuildError, MeshRef, testing};

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
        let oracle = BruteForce::new(mesh)?;
        let (frame, triangles) = (*testing::frame(&oracle), testing::triangles(&oracle));
        let corners = triangles.iter().map(|triangle| triangle.corners).collect::<Vec<_>>();
        let within = corners.iter().map(|corners| corners.map(|corner| frame.to_root(corner).into())).collect();
        let primitives = triangles.iter().map(|triangle| triangle.primitive).collect();
        let scene = Scene { corners: within, margin: BOX_MARGIN };
        Ok(Self::new(&scene, settings, Some(frame), &corners, primitives))
    }

    fn new(
        scene: &Scene,
        settings: &S::Settings,
        frame: Option<Frame>,
        corners: &[[[f32; 3]; 3]],
        primitives: Vec<u32>,
    ) -> Self {
        let structure = S::build(scene, settings);
        let triangles =
            |order: &mut dyn Iterator<Item = u32>| order.map(|i| T::triangle(&corners[i as usize])).collect();
        match S::COPIES {
            true => Self {
                triangles: triangles(&mut structure.listed().iter().copied()),
                primitives: structure.listed().iter().map(|i| primitives[*i as usize]).collect(),
                structure,
                frame,
            },
            false => Self { triangles: triangles(&mut (0..corners.len() as u32)), primitives, structure, frame },
        }
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
        let mesh = mesh.into();
        let oracle = BruteForce::new(mesh)?;
        let primitives: Vec<u32> = testing::triangles(&oracle).iter().map(|triangle| triangle.primitive).collect();
        let corners_of = |primitive: &u32| mesh.corners(*primitive as usize).map(|corner| corner.map(|c| c as f32));
        let corners: Vec<[[f32; 3]; 3]> = primitives.iter().map(corners_of).collect();
        let scene = Scene { corners: corners.iter().map(|corners| corners.map(Vec3::from)).collect(), margin: 0.0 };
        Ok(Self::new(&scene, settings, None, &corners, primitives))
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
