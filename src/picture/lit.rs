//! A mesh as it would look on a photographer's table: a key light with traced shadows, and fill.

use leafwalk::{Ray, Tracer};
use rayon::prelude::*;

use super::drawing::Drawing;
use super::primary::PrimaryRays;
use super::sampling::{Draws, SAMPLES, spread};
use super::surface::Surface;
use super::vector::{Vector, add, dot, mix, mul, scale, tangents, unit};
use super::{Image, PictureError, to_display};
use crate::camera::{Camera, Size};

/// Where the key light stands, along the camera's right, up and back.
const KEY_FROM: Vector = [-0.7, 0.8, 0.5];
/// Radius of the key light as a disc one unit away: it softens the shadows a little.
const KEY_RADIUS: f64 = 0.012;
/// What white surfaces reflect of the lights that they face.
const KEY: Vector = [1.00, 0.96, 0.88];
const SKY: Vector = [0.24, 0.27, 0.32];
const GROUND: Vector = [0.08, 0.07, 0.06];
const CAMERA_LIGHT: f64 = 0.2;
/// Behind the mesh, at the picture's lower and upper end.
const BACKDROP: [Vector; 2] = [[0.46, 0.48, 0.51], [0.14, 0.16, 0.20]];

/// A hit, the ray to a place on the key light, and how much of that light it reflects if nothing is in between.
struct Lit {
    surface: Surface,
    shadow: Option<(Ray, f64)>,
}

impl<T: Tracer> Drawing<'_, '_, T> {
    /// The mesh flat-shaded in its materials' colours.
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
            let mut sums = vec![[0.0; 3]; pixels.len()];
            for (sample, (lit, ray)) in lit.iter().zip(&rays).enumerate() {
                let colour = match lit {
                    None => studio.backdrop(size, pixel_of(sample)),
                    Some(Lit { surface, shadow }) => {
                        let unshadowed = shadow.filter(|_| occluded.next() == Some(false));
                        studio.reflected(surface, unshadowed.map_or(0.0, |(_, key)| key), ray)
                    }
                };
                sums[sample / SAMPLES] = add(sums[sample / SAMPLES], colour);
            }
            image.pixels.par_extend(sums.par_iter().map(|sum| to_display(scale(*sum, 1.0 / SAMPLES as f64))));
        }
        Ok(image)
    }
}

/// The lights, which move with the camera.
struct Studio {
    up: Vector,
    key: Vector,
}

impl Studio {
    fn new(camera: &Camera) -> Self {
        let [right, up, back] = camera.basis();
        let key = add(scale(right, KEY_FROM[0]), add(scale(up, KEY_FROM[1]), scale(back, KEY_FROM[2])));
        Self { up, key: unit(key).unwrap_or(up) }
    }

    /// The ray to a place on the key light, and how much the surface faces it; `None` where it turns away.
    fn shadow_ray(&self, surface: &Surface, [turn, area]: [f64; 2]) -> Option<(Ray, f64)> {
        let (sine, cosine) = (core::f64::consts::TAU * turn).sin_cos();
        let [u, v] = tangents(self.key).map(|tangent| scale(tangent, KEY_RADIUS * area.sqrt()));
        let direction = add(self.key, add(scale(u, cosine), scale(v, sine)));
        let faces = dot(surface.normal, direction);
        let ray = Ray::new(surface.lifted.map(|c| c as f32), direction.map(|c| c as f32));
        (faces > 0.0).then_some((ray, faces))
    }

    fn reflected(&self, surface: &Surface, key: f64, ray: &Ray) -> Vector {
        let [diffuse, emission] = [surface.material.diffuse, surface.material.emission].map(|c| c.map(f64::from));
        let fill = mix(GROUND, SKY, 0.5 + 0.5 * dot(surface.normal, self.up));
        let facing = -dot(surface.normal, ray.direction.map(f64::from));
        let light = add(scale(KEY, key), add(fill, [CAMERA_LIGHT * facing; 3]));
        add(emission, mul(diffuse, light))
    }

    fn backdrop(&self, size: Size, pixel: usize) -> Vector {
        let row = pixel / size.width as usize;
        mix(BACKDROP[1], BACKDROP[0], row as f64 / f64::from(size.height))
    }
}
