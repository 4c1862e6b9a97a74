//! A drawing: what every way of drawing an octree needs. The ways are methods in `lit` and `false_colour`.

use core::ops::ControlFlow;

use super::meter::Meter;
use super::surface::Surfaces;
use crate::camera::Camera;

/// A picture of an octree that is about to be drawn.
pub(crate) struct Drawing<'a, 'm, T> {
    pub(crate) meter: &'a mut Meter<'m, T>,
    pub(crate) surfaces: &'a Surfaces,
    pub(crate) camera: &'a Camera,
    /// Is told how many pixels are finished, and may stop the work.
    pub(crate) progress: &'a dyn Fn(usize) -> ControlFlow<()>,
}

#[cfg(test)]
mod tests {
    use core::sync::atomic::{AtomicU64, Ordering::Relaxed};

    use leafwalk::{Builder, CpuTracer, Hit, Ray, Tracer};

    use super::*;
    use crate::camera::Size;
    use crate::scene::{Detail, Scene};

    const SIZE: Size = Size { width: 32, height: 24 };

    /// A tracer, and how many rays it was asked for their closest hits.
    struct Asked<T>(T, AtomicU64);

    impl<T: Tracer> Tracer for Asked<T> {
        type Error = T::Error;

        fn closest_hits(&self, rays: &[Ray], hits: &mut [Hit]) -> Result<(), T::Error> {
            self.1.fetch_add(rays.len() as u64, Relaxed);
            self.0.closest_hits(rays, hits)
        }

        fn occlusions(&self, rays: &[Ray], occluded: &mut [bool]) -> Result<(), T::Error> {
            self.0.occlusions(rays, occluded)
        }
    }

    type Traced<'a> = Asked<CpuTracer<&'a [u32]>>;

    #[test]
    fn the_tracer_answers_primary_rays_unless_their_work_is_asked_for() {
        let scene = Scene::room(Detail { bumpy: 0, smooth: 0, knot: [12, 4] });
        let octree = Builder::new().build(&scene.mesh).expect("a finite mesh");
        let surfaces = Surfaces::new(&octree, scene.materials.clone());
        let camera = Camera::new(&scene.view, SIZE).expect("a camera");
        let pixels = SIZE.pixels() as u64;
        // How many rays the tracer answered, how many were primary, and how many were walked.
        let count = |draw: &dyn Fn(Drawing<'_, '_, Traced<'_>>)| {
            let tracer = Asked(CpuTracer::new(octree.view()), AtomicU64::new(0));
            let mut meter = Meter::new(&tracer);
            let progress = |_| ControlFlow::Continue(());
            draw(Drawing { meter: &mut meter, surfaces: &surfaces, camera: &camera, progress: &progress });
            assert_eq!(meter.primary.rays, meter.primary.hits, "the room is closed");
            (tracer.1.load(Relaxed), meter.primary.rays, meter.walked.rays)
        };
        assert_eq!(count(&|drawing| drop(drawing.lit().expect("a picture"))), (4 * pixels, 4 * pixels, 0));
        assert_eq!(count(&|drawing| drop(drawing.normals().expect("a picture"))), (pixels, pixels, 0));
        assert_eq!(count(&|drawing| drop(drawing.depths().expect("a picture"))), (pixels, pixels, 0));
        assert_eq!(count(&|drawing| drop(drawing.primitives().expect("a picture"))), (pixels, pixels, 0));
        assert_eq!(count(&|drawing| drop(drawing.cells(&octree).expect("a picture"))), (0, pixels, pixels));
    }
}
