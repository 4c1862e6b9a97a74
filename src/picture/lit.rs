//! The shade `lit`: a mesh in its materials' colours, under a key light with traced shadows and a fill light that has
//! none.

use glam::{DVec3, Vec3};
use leafwalk::{Ray, Tracer};
use rayon::prelude::*;

use super::drawing::Drawing;
use super::primary::PrimaryRays;
use super::sampling::{Draws, SAMPLES, spread};
use super::surface::Surface;
use super::vector::{mix, unit};
use super::{Image, PictureError, to_display};
use crate::camera::{Camera, Size};
use crate::scene::Material;

/// Where the key light stands, along the camera's right, up and back.
const KEY_FROM: DVec3 = DVec3::new(-0.7, 0.8, 0.5);
/// Radius of the key light as a disc one unit away: it softens the shadows a little.
const KEY_RADIUS: f64 = 0.012;
/// What a white surface reflects of the key light if it faces it.
const KEY: DVec3 = DVec3::new(1.00, 0.96, 0.88);
/// What a white surface reflects of the fill light from above, and from below.
const SKY: DVec3 = DVec3::new(0.24, 0.27, 0.32);
const GROUND: DVec3 = DVec3::new(0.08, 0.07, 0.06);
/// What a white surface reflects of the fill light from the camera if it faces it.
const CAMERA_LIGHT: f64 = 0.2;
/// The colours behind the mesh, at the lower and at the upper end of the picture.
const BACKDROP: [DVec3; 2] = [DVec3::new(0.46, 0.48, 0.51), DVec3::new(0.14, 0.16, 0.20)];

/// A hit, and where the key light is seen from it.
struct Lit {
    surface: Surface,
    /// The ray to a place on the key light, and what share of the light is reflected if nothing is in between. `None`
    /// where the surface faces away from the light.
    shadow: Option<(Ray, f64)>,
}

impl<T: Tracer> Drawing<'_, '_, T> {
    /// Draws the mesh in its materials' colours, flat-shaded.
    pub(crate) fn lit(self) -> Result<Image, PictureError<T::Error>> {
        let size = self.camera.size();
        let mut image = Image::with_capacity(size)?;
        let studio = Studio::new(self.camera);
        let primary = PrimaryRays::jittered(self.camera);
        for pixels in primary.batches() {
            if (self.progress)(pixels.start).is_break() {
                return Err(PictureError::Cancelled);
            }
            let pixel_of = |sample: usize| pixels.start + sample / SAMPLES;
            let rays = primary.through(&pixels);
            let hits = self.meter.primary_hits(&rays).map_err(PictureError::Tracer)?;

            let lit: Vec<Option<Lit>> = (&rays, &hits)
                .into_par_iter()
                .enumerate()
                .map(|(sample, (ray, hit))| {
                    let surface = self.surfaces.at(hit, ray.direction)?;
                    let place = spread(Draws::new(pixel_of(sample), 1).point(), sample % SAMPLES);
                    Some(Lit { surface, shadow: studio.shadow_ray(&surface, place) })
                })
                .collect();
            let shadows: Vec<Ray> = lit.iter().flatten().filter_map(|lit| Some(lit.shadow?.0)).collect();
            let mut occluded = self.meter.occlusions(&shadows).map_err(PictureError::Tracer)?.into_iter();
            let mut sums = vec![DVec3::ZERO; pixels.len()];
            for (sample, (lit, ray)) in lit.iter().zip(&rays).enumerate() {
                let colour = match lit {
                    None => studio.backdrop(size, pixel_of(sample)),
                    Some(Lit { surface, shadow }) => {
                        let unshadowed = shadow.filter(|_| occluded.next() == Some(false));
                        studio.reflected(surface, unshadowed.map_or(0.0, |(_, key)| key), ray)
                    }
                };
                sums[sample / SAMPLES] += colour;
            }
            image.pixels.par_extend(sums.par_iter().map(|sum| to_display(*sum * (1.0 / SAMPLES as f64))));
        }
        Ok(image)
    }
}

/// The lights, which move with the camera.
struct Studio {
    up: DVec3,
    key: DVec3,
}

impl Studio {
    fn new(camera: &Camera) -> Self {
        let [right, up, back] = camera.basis();
        let key = right * KEY_FROM.x + (up * KEY_FROM.y + back * KEY_FROM.z);
        Self { up, key: unit(key).unwrap_or(up) }
    }

    /// The ray to a place on the key light, and how much the surface faces that place; `None` where it faces away.
    fn shadow_ray(&self, surface: &Surface, [turn, area]: [f64; 2]) -> Option<(Ray, f64)> {
        let (sine, cosine) = (core::f64::consts::TAU * turn).sin_cos();
        let (u, v) = self.key.any_orthonormal_pair();
        let radius = KEY_RADIUS * area.sqrt();
        let direction = self.key + (u * radius * cosine + v * radius * sine);
        let faces = surface.normal.dot(direction);
        let ray = Ray::new(surface.lifted.as_vec3(), direction.as_vec3());
        (faces > 0.0).then_some((ray, faces))
    }

    /// The light that a surface emits and reflects back along a ray; `key` is the share of the key light that arrives.
    fn reflected(&self, surface: &Surface, key: f64, ray: &Ray) -> DVec3 {
        let Material { diffuse, emission } = surface.material;
        let fill = mix(GROUND, SKY, 0.5 + 0.5 * surface.normal.dot(self.up));
        let facing = -surface.normal.dot(Vec3::from(ray.direction).as_dvec3());
        let light = KEY * key + (fill + DVec3::splat(CAMERA_LIGHT * facing));
        emission.as_dvec3() + diffuse.as_dvec3() * light
    }

    /// The colour behind the mesh at a pixel.
    fn backdrop(&self, size: Size, pixel: usize) -> DVec3 {
        let row = pixel / size.width as usize;
        mix(BACKDROP[1], BACKDROP[0], row as f64 / f64::from(size.height))
    }
}
