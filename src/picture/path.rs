//! The path tracer of the default scene: direct light with traced shadows, and light from other surfaces over two
//! bounces.
//!
//! Paths are traced in waves, so that each wave is a batch of rays:
//! 1. trace the primary rays;
//! 2. for each hit, make a ray to a place on the light and a ray in a random direction (the bounce);
//! 3. trace the rays to the light; those that are not occluded add light to their pixels;
//! 4. trace the bounces, and go on with 2 for as many waves as there are bounces;
//! 5. smooth what the bounces and the rays to the light brought (`smooth`), and apply the surfaces' colours.

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

/// How many waves of bounces follow the primary rays. Only the first sample of each pixel bounces, since what bounces
/// bring is smoothed.
const BOUNCES: u32 = 2;

/// A path from the camera that has not ended yet.
struct Path {
    /// The sample that it began at, counted from the first of the batch.
    sample: usize,
    ray: Ray,
    /// The share of the light met by the path that leaves the surface of the first hit towards the camera, as if that
    /// surface were white.
    weight: DVec3,
}

/// What a path does at a hit.
struct Bounce {
    surface: Surface,
    /// What a white surface would reflect of the light if nothing were in between; zero unless this is the first hit.
    unshadowed: DVec3,
    /// The ray to a place on the light, and the light that comes along it if nothing is in between. `None` where the
    /// surface and that place do not face each other.
    shadow: Option<(Ray, DVec3)>,
    next: Path,
}

/// Renders a scene; `progress` is told how many pixels are finished, and may stop the work.
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

    /// What a path does at its next hit, or `None` where the path ends because it missed.
    fn bounce(&self, wave: u32, path: &Path, hit: &Hit, mut draws: Draws) -> Option<Bounce> {
        let surface = self.surfaces.at(hit, path.ray.direction)?;
        // The first surface counts as white here: its pixel applies the colour, after smoothing.
        let colour = if wave == 0 { DVec3::ONE } else { surface.material.diffuse.as_dvec3() };
        let weight = path.weight * colour;
        let place = spread(draws.point(), path.sample % SAMPLES);
        let shadow = self.shadow_ray(&surface, place);
        let shadow = shadow.map(|(ray, share)| (ray, weight * self.light.radiance * share));
        // A point of the unit disc, projected up to the hemisphere: directions come as often as their cosine says, so
        // that all of them weigh the same (Malley's method).
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

    /// The ray to a place on the light, and what share of the light's radiance a white surface reflects of it; `None`
    /// where they do not face each other.
    fn shadow_ray(&self, surface: &Surface, place: [f64; 2]) -> Option<(Ray, f64)> {
        // Both ends are lifted off their surfaces, so that the ray between them meets neither.
        let normal = self.light.normal();
        let on_light = lift(self.light.point(place), normal, &self.light.triangle(), self.surfaces.frame());
        let to_light = on_light - surface.lifted;
        let distance = to_light.length();
        let (leaving, arriving) = (surface.normal.dot(to_light), -normal.dot(to_light));
        let is_lit = leaving > 0.0 && arriving > 0.0;
        let share = leaving * arriving * self.light.area() / (core::f64::consts::PI * distance.powi(4));
        let (origin, direction) = (surface.lifted.as_vec3(), to_light.as_vec3());
        is_lit.then(|| (Ray::between(origin, direction, 0.0, 1.0), share))
    }
}

/// Applies the exposure and a filmic curve, by which brights roll off to white and darks keep their contrast.
fn tone(radiance: DVec3) -> DVec3 {
    radiance.map(|c| {
        let c = EXPOSURE * c;
        // A fit to the ACES reference curve (K. Narkowicz, ACES Filmic Tone Mapping Curve, 2016,
        // https://knarkowicz.wordpress.com/2016/01/06/aces-filmic-tone-mapping-curve/).
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

    /// A scene drawn in small: its pixels, and how many rays they took.
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
        // A pixel has four primary rays and two bounces; each of these six has at most one ray to the light.
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
