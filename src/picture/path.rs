//! A scene lit by its light: direct light with traced shadows, and light from other surfaces over a few bounces.

use core::ops::{ControlFlow, Range};

use glam::DVec3;
use leafwalk::{Hit, Ray, Tracer};
use rayon::prelude::*;

use super::meter::Meter;
use super::primary::PrimaryRays;
use super::sampling::{Draws, SAMPLES, spread};
use super::smooth::{Film, Pixel};
use super::surface::{Surface, Surfaces, lift};
use super::{Image, PictureError, to_display};
use crate::camera::Camera;
use crate::scene::{Light, Scene};

/// Waves of bounce rays after the primary rays, from the first sample of each pixel alone: what they bring is smoothed.
const BOUNCES: u32 = 2;

/// A path from the camera, in progress.
struct Path {
    /// Its sample, counted from the first of the batch.
    sample: usize,
    ray: Ray,
    /// What share of the light it meets reaches the first hit's surface, and leaves it if that were white.
    weight: DVec3,
}

/// What became of a path at a hit.
struct Bounce {
    surface: Surface,
    /// What a white surface would reflect of the light if nothing were in between; of primary hits.
    unshadowed: DVec3,
    /// The ray to the light, and what comes along it if nothing is in between.
    shadow: Option<(Ray, DVec3)>,
    next: Path,
}

/// Renders a scene; `progress` hears of finished pixels and may stop the work.
pub(crate) fn render<T: Tracer>(
    meter: &mut Meter<'_, T>,
    scene: &Scene,
    surfaces: &Surfaces,
    camera: &Camera,
    progress: &dyn Fn(usize) -> ControlFlow<()>,
) -> Result<Image, PictureError<T::Error>> {
    let mut image = Image::with_capacity(camera.size())?;
    let mut film = Film::with_capacity(camera.size())?;
    let primary = PrimaryRays::jittered(camera);
    let renderer = Renderer { light: scene.light, surfaces, primary };
    for pixels in primary.batches() {
        if progress(pixels.start).is_break() {
            return Err(PictureError::Cancelled);
        }
        film.pixels.extend(renderer.batch(meter, pixels).map_err(PictureError::Tracer)?);
    }
    film.smooth();
    image.pixels.par_extend(film.pixels.par_iter().map(|pixel| to_display(tone(pixel.radiance()))));
    Ok(image)
}

struct Renderer<'a> {
    light: Light,
    surfaces: &'a Surfaces,
    primary: PrimaryRays<'a>,
}

impl Renderer<'_> {
    fn batch<T: Tracer>(&self, meter: &mut Meter<'_, T>, pixels: Range<usize>) -> Result<Vec<Pixel>, T::Error> {
        let mut result = vec![Pixel::default(); pixels.len()];
        let primary = self.primary.through(&pixels).into_iter().enumerate();
        let mut paths: Vec<Path> = primary.map(|(sample, ray)| Path { sample, ray, weight: DVec3::ONE }).collect();
        for wave in 0..=BOUNCES {
            let rays: Vec<Ray> = paths.iter().map(|path| path.ray).collect();
            let hits = if wave == 0 { meter.primary_hits(&rays) } else { meter.closest_hits(&rays) }?;
            let bounces: Vec<Option<Bounce>> = (&paths, &hits)
                .into_par_iter()
                .map(|(path, hit)| {
                    let pixel = pixels.start + path.sample / SAMPLES;
                    self.bounce(wave, path, hit, Draws::new(pixel, wave + 1))
                })
                .collect();
            let shadows: Vec<Ray> = bounces.iter().flatten().filter_map(|bounce| Some(bounce.shadow?.0)).collect();
            let mut occluded = meter.occlusions(&shadows)?.into_iter();
            for bounce in bounces.iter().flatten() {
                let possible = bounce.shadow.map_or(DVec3::ZERO, |(_, light)| light);
                let is_lit = bounce.shadow.is_some() && occluded.next() == Some(false);
                let found = if is_lit { possible } else { DVec3::ZERO };
                let pixel = &mut result[bounce.next.sample / SAMPLES];
                if wave == 0 {
                    pixel.add(&bounce.surface, bounce.unshadowed, [found.y, possible.y]);
                } else {
                    pixel.bounced += found;
                }
            }
            let bounced = bounces.into_iter().flatten().map(|bounce| bounce.next);
            paths = bounced.filter(|path| path.sample.is_multiple_of(SAMPLES)).collect();
        }
        Ok(result)
    }

    /// What a path does at its next hit; `None` where it ends.
    fn bounce(&self, wave: u32, path: &Path, hit: &Hit, mut draws: Draws) -> Option<Bounce> {
        let surface = self.surfaces.at(hit, path.ray.direction)?;
        // The first surface counts as white here: its pixel applies the colour, after smoothing.
        let colour = if wave == 0 { DVec3::ONE } else { surface.material.diffuse.as_dvec3() };
        let weight = path.weight * colour;
        let place = spread(draws.point(), path.sample % SAMPLES);
        let shadow = self.shadow_ray(&surface, place);
        let shadow = shadow.map(|(ray, share)| (ray, weight * self.light.radiance * share));
        // Directions are distributed as their cosine, by a disc that is projected up, so that all weigh the same.
        let [turn, area] = draws.point();
        let (sine, cosine) = (core::f64::consts::TAU * turn).sin_cos();
        let (u, v) = surface.normal.any_orthonormal_pair();
        let (radius, height) = (area.sqrt(), (1.0 - area).sqrt());
        let direction = u * radius * cosine + v * radius * sine + surface.normal * height;
        let ray = Ray::new(surface.lifted.as_vec3(), direction.as_vec3());
        let form_factor = if wave == 0 { self.light.form_factor(surface.lifted, surface.normal) } else { 0.0 };
        let unshadowed = self.light.radiance * form_factor;
        Some(Bounce { surface, unshadowed, shadow, next: Path { sample: path.sample, ray, weight } })
    }

    /// The ray to a place on the light, and what share of the light's radiance a white surface reflects of it.
    fn shadow_ray(&self, surface: &Surface, place: [f64; 2]) -> Option<(Ray, f64)> {
        // Both ends are lifted off their surfaces, so that the ray between them meets neither.
        let normal = self.light.normal();
        let to_light = lift(self.light.point(place), normal, self.surfaces.root_edge()) - surface.lifted;
        let distance = to_light.length();
        let (leaving, arriving) = (surface.normal.dot(to_light), -normal.dot(to_light));
        let is_lit = leaving > 0.0 && arriving > 0.0;
        let share = leaving * arriving * self.light.area() / (core::f64::consts::PI * distance.powi(4));
        let (origin, direction) = (surface.lifted.as_vec3(), to_light.as_vec3());
        is_lit.then(|| (Ray::between(origin, direction, 0.0, 1.0), share))
    }
}

/// Exposure and a filmic curve: brights roll off to white, darks keep their contrast.
fn tone(radiance: DVec3) -> DVec3 {
    radiance.map(|c| {
        let c = EXPOSURE * c;
        // The fit of Narkowicz (2016) to the ACES reference curve.
        (c * (2.51 * c + 0.03)) / (c * (2.43 * c + 0.59) + 0.14)
    })
}
const EXPOSURE: f64 = 0.8;

#[cfg(test)]
mod tests {
    use leafwalk::{BruteForce, Builder, CpuTracer};

    use super::*;
    use crate::camera::Size;
    use crate::scene::Detail;

    const SIZE: Size = Size { width: 61, height: 47 };

    /// The default scene in small, its pixels and the rays that they took.
    fn draw<T: Tracer + Sync>(scene: &Scene, tracer: &T, threads: usize) -> (Vec<[u8; 3]>, u64)
    where
        T::Error: Send,
    {
        let octree = Builder::new().build(&scene.mesh).expect("a finite mesh");
        let surfaces = Surfaces::new(&octree, scene.materials.clone());
        let camera = Camera::new(&scene.view, SIZE).expect("a camera");
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let mut meter = Meter::new(tracer);
            let image = render(&mut meter, scene, &surfaces, &camera, &|_| ControlFlow::Continue(()));
            (image.unwrap_or_else(|error| panic!("{error:?}")).pixels, meter.traced.rays)
        })
    }

    #[test]
    fn pictures_depend_neither_on_threads_nor_on_the_tracer() {
        let scene = Scene::room(Detail { bumpy: 3, smooth: 2, knot: [60, 8] });
        let tracer = CpuTracer::new(Builder::new().build(&scene.mesh).expect("a finite mesh"));
        let expected = draw(&scene, &tracer, 1);
        assert_eq!(expected.0.len(), SIZE.pixels());
        // Primary rays, at most a shadow ray for each, and two bounces of a pixel with one each.
        let pixels = SIZE.pixels() as u64;
        assert!((8 * pixels..=12 * pixels).contains(&expected.1), "{} rays for {pixels} pixels", expected.1);
        assert!(draw(&scene, &tracer, 3) == expected, "three threads draw another picture");
        let brute_force = BruteForce::new(&scene.mesh).expect("a finite mesh");
        assert!(draw(&scene, &brute_force, 2) == expected, "testing every triangle draws another picture");
    }

    #[test]
    fn a_stopped_picture_is_none() {
        let scene = Scene::room(Detail { bumpy: 0, smooth: 0, knot: [12, 4] });
        let octree = Builder::new().build(&scene.mesh).expect("a finite mesh");
        let surfaces = Surfaces::new(&octree, scene.materials.clone());
        let camera = Camera::new(&scene.view, SIZE).expect("a camera");
        let mut meter = Meter::new(&octree);
        let result = render(&mut meter, &scene, &surfaces, &camera, &|_| ControlFlow::Break(()));
        assert!(matches!(result, Err(PictureError::Cancelled)));
        assert_eq!(meter.traced.rays, 0);
    }
}
