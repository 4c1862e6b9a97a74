//! A mesh as it would look on a photographer's table: a key light with traced shadows, and fill.

use core::ops::ControlFlow;

use leafwalk::{CpuTracer, LengthMismatch, Ray};
use rayon::prelude::*;

use super::meter::Meter;
use super::surface::{Surface, Surfaces};
use super::vector::{Vector, add, dot, mix, mul, scale, tangents, unit};
use super::{Draws, Image, PictureError, SAMPLES, batches, in_cell, primary_ray, spread, to_display};
use crate::camera::Camera;

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

/// Renders a mesh, flat-shaded; `progress` hears of finished pixels and may stop the work.
pub(crate) fn render<W: AsRef<[u32]> + Sync>(
    meter: &mut Meter<'_, CpuTracer<W>>,
    surfaces: &Surfaces,
    camera: &Camera,
    progress: &dyn Fn(usize) -> ControlFlow<()>,
) -> Result<Image, PictureError<LengthMismatch>> {
    let mut image = Image::with_capacity(camera.size())?;
    let studio = Studio::new(camera);
    for pixels in batches(camera.size(), SAMPLES) {
        if progress(pixels.start).is_break() {
            return Err(PictureError::Cancelled);
        }
        let sampled = |sample: usize| (pixels.start + sample / SAMPLES, sample % SAMPLES);
        let samples = (0..pixels.len() * SAMPLES).into_par_iter();
        let rays: Vec<Ray> = samples
            .map(|sample| {
                let (pixel, sample) = sampled(sample);
                primary_ray(camera, pixel, in_cell(Draws::new(pixel, 0).point(), sample))
            })
            .collect();
        let answers = meter.primary_hits(&rays).map_err(PictureError::Tracer)?;
        let hits: Vec<Option<(Surface, Ray)>> = (&rays, &answers)
            .into_par_iter()
            .enumerate()
            .map(|(index, (ray, (hit, _)))| {
                let (pixel, sample) = sampled(index);
                let surface = surfaces.at(hit, ray.direction)?;
                let shadow = studio.shadow_ray(&surface, spread(Draws::new(pixel, 1).point(), sample));
                Some((surface, shadow))
            })
            .collect();

        let is_lit = |(surface, shadow): &&(Surface, Ray)| studio.faces(surface, shadow) > 0.0;
        let shadows: Vec<Ray> = hits.iter().flatten().filter(is_lit).map(|(_, shadow)| *shadow).collect();
        let mut occluded = meter.occlusions(&shadows).map_err(PictureError::Tracer)?.into_iter();
        let mut sums = vec![[0.0; 3]; pixels.len()];
        for (sample, (hit, ray)) in hits.iter().zip(&rays).enumerate() {
            let colour = match hit {
                None => studio.backdrop(camera, pixels.start + sample / SAMPLES),
                Some(hit) => {
                    let is_lit = is_lit(&hit) && occluded.next() == Some(false);
                    let key = if is_lit { studio.faces(&hit.0, &hit.1) } else { 0.0 };
                    studio.reflected(&hit.0, key, ray)
                }
            };
            sums[sample / SAMPLES] = add(sums[sample / SAMPLES], colour);
        }
        image.pixels.par_extend(sums.par_iter().map(|sum| to_display(scale(*sum, 1.0 / SAMPLES as f64))));
    }
    Ok(image)
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

    /// The ray to a place on the key light.
    fn shadow_ray(&self, surface: &Surface, [turn, area]: [f64; 2]) -> Ray {
        let (sine, cosine) = (core::f64::consts::TAU * turn).sin_cos();
        let [u, v] = tangents(self.key).map(|tangent| scale(tangent, KEY_RADIUS * area.sqrt()));
        let direction = add(self.key, add(scale(u, cosine), scale(v, sine)));
        Ray::new(surface.lifted.map(|c| c as f32), direction.map(|c| c as f32))
    }

    /// How much a surface faces the light that a shadow ray leads to; negative when it turns away.
    fn faces(&self, surface: &Surface, shadow: &Ray) -> f64 {
        dot(surface.normal, shadow.direction.map(f64::from))
    }

    fn reflected(&self, surface: &Surface, key: f64, ray: &Ray) -> Vector {
        let [diffuse, emission] = [surface.material.diffuse, surface.material.emission].map(|c| c.map(f64::from));
        let fill = mix(GROUND, SKY, 0.5 + 0.5 * dot(surface.normal, self.up));
        let facing = -dot(surface.normal, ray.direction.map(f64::from));
        let light = add(scale(KEY, key), add(fill, [CAMERA_LIGHT * facing; 3]));
        add(emission, mul(diffuse, light))
    }

    fn backdrop(&self, camera: &Camera, pixel: usize) -> Vector {
        let row = pixel / camera.size().width as usize;
        mix(BACKDROP[1], BACKDROP[0], row as f64 / f64::from(camera.size().height))
    }
}
