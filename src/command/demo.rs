//! `leafwalk` alone: a picture of the default scene.

use std::path::Path;
use std::time::Instant;

use leafwalk::{Builder, CpuTracer};

use super::context::Context;
use super::error::CommandError;
use super::render::{add_picture, add_primary, add_rays, add_seconds, add_walked, progress, save};
use super::report::Report;
use crate::camera::{Camera, Size};
use crate::picture::meter::Meter;
use crate::picture::path;
use crate::picture::primary::PrimaryRays;
use crate::picture::surface::Surfaces;
use crate::picture::walk::Walked;
use crate::scene::{Detail, Scene};

const OUTPUT: &str = "leafwalk.png";

pub(crate) fn run(context: &Context) -> Result<(), CommandError> {
    let output = Path::new(OUTPUT);
    context.check_output(output, &[])?;
    let scene = Scene::room(Detail::FULL);
    let camera = Camera::new(&scene.view, Size::DEFAULT)?;

    let start = Instant::now();
    let octree = context.build(&Builder::new(), (&scene.mesh).into())?;
    let build_time = start.elapsed();
    let surfaces = Surfaces::new(&octree, scene.materials.clone());

    let tracer = CpuTracer::new(octree);
    let mut meter = Meter::new(&tracer);
    let start = Instant::now();
    let image = path::render(&mut meter, &scene, &surfaces, &camera, &progress(camera.size(), context))?;
    let render_time = start.elapsed();
    save(&image, output, context)?;

    let walked = Walked::sample(tracer.octree(), &PrimaryRays::jittered(&camera));

    let mut report = Report::new();
    report.add_octree(tracer.octree());
    add_seconds(&mut report, "build_seconds", "build time", build_time);
    add_seconds(&mut report, "render_seconds", "render time", render_time);
    add_rays(&mut report, "speed", &meter.traced);
    add_primary(&mut report, &meter.primary);
    add_walked(&mut report, &walked);
    add_picture(&mut report, output);
    context.report(&report)
}
