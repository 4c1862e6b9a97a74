//! `leafwalk render`: a mesh or an octree into a picture.

use core::ops::ControlFlow;
use core::time::Duration;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use glam::DVec3;
use leafwalk::Octree;

use super::backend::{Backend, BackendArgs, BackendError};
use super::context::Context;
use super::error::CommandError;
use super::input::{self, Input};
use super::report::Report;
use crate::camera::{Camera, Size, View};
use crate::picture::drawing::Drawing;
use crate::picture::false_colour::Scale;
use crate::picture::meter::{Meter, Primary, Traced};
use crate::picture::primary::PrimaryRays;
use crate::picture::surface::Surfaces;
use crate::picture::walk::Walked;
use crate::picture::{Image, PictureError};
use crate::scene::Material;

/// Draw a mesh or an octree as a PNG.
///
/// Without a camera the whole mesh is in the picture, seen from the right, the front and above. Coordinates are the
/// mesh's own.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct RenderArgs {
    /// The octree's file, or a mesh: .obj, .ply or .stl, each also with .gz.
    #[arg(value_name = "MESH|FILE.lwk")]
    input: PathBuf,

    /// The picture to write.
    #[arg(long, short, value_name = "OUT.png")]
    output: PathBuf,

    /// Pixels across and down.
    #[arg(long, value_name = "WxH", default_value = "960x720", value_parser = size)]
    size: Size,

    /// Where the camera stands.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = point)]
    eye: Option<Point>,

    /// What it looks at; by default the middle of the mesh.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = point)]
    at: Option<Point>,

    /// What is up in the picture; by default 0,1,0.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = point)]
    up: Option<Point>,

    /// Angle of view from the lower to the upper edge, in degrees; by default 35.
    #[arg(long, value_name = "DEG", allow_hyphen_values = true, value_parser = field_of_view)]
    fov: Option<f64>,

    /// What the colours show.
    #[arg(long, value_enum, default_value_t = Shade::Lit)]
    shade: Shade,

    #[command(flatten)]
    backend: BackendArgs,
}

const EXAMPLES: &str = "\
Examples:
  leafwalk render bunny.ply -o bunny.png
  leafwalk render room.lwk -o room.png --eye 0,1.6,4 --at 0,1.5,0 --fov 60 --size 1920x1080
  leafwalk render bunny.lwk -o cells.png --shade cells";

/// A point or a vector on the command line.
#[derive(Clone, Copy, Debug)]
struct Point(DVec3);

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Shade {
    /// The materials' colours under a key light with traced shadows; grey where there is no material.
    Lit,
    /// The direction of the surface, x y z as red green blue.
    Normal,
    /// The distance from the camera, near bright and far dark.
    Depth,
    /// A colour for each primitive.
    Primitive,
    /// How many cells each ray visits, none black and the most light yellow. Whatever the backend, they are counted by
    /// a walk on the CPU, which is slower.
    Cells,
}

fn size(argument: &str) -> Result<Size, String> {
    let sides = argument.split_once(['x', 'X']).and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    let (width, height) = sides.ok_or("two whole numbers are needed, such as 960x720")?;
    Size::new(width, height).map_err(|error| error.to_string())
}

fn point(argument: &str) -> Result<Point, String> {
    let numbers: Result<Vec<f64>, _> = argument.split(',').map(|number| number.trim().parse()).collect();
    match numbers.as_deref() {
        Ok(&[x, y, z]) if DVec3::new(x, y, z).as_vec3().is_finite() => Ok(Point(DVec3::new(x, y, z))),
        _ => Err("three numbers within the range of f32 are needed, such as 0,1.5,-2".to_owned()),
    }
}

fn field_of_view(argument: &str) -> Result<f64, String> {
    let degrees = argument.parse().map_err(|_| "a number of degrees is needed")?;
    View::check_fov(degrees).map_err(|error| error.to_string())?;
    Ok(degrees)
}

pub(crate) fn run(args: &RenderArgs, context: &Context) -> Result<(), CommandError> {
    let builder = args.backend.builder()?;
    context.check_output(&args.output, &[&args.input])?;
    let Input { octree, built } = input::open(&args.input, &builder, context)?;
    let view = args.view(&View::framing(&octree.bounds(), args.fov.unwrap_or(View::FOV), args.size.aspect()));
    let camera = Camera::new(&view, args.size)?;
    let materials = built.iter().flat_map(|built| &built.mesh.materials);
    let materials = materials.map(|from| Material { diffuse: from.diffuse.into(), emission: from.emission.into() });
    let surfaces = Surfaces::new(&octree, materials.collect());

    let tracer = args.backend.open(octree)?;
    let mut meter = Meter::new(&tracer);
    let (image, scale) = args.draw(&mut meter, tracer.octree(), &surfaces, &camera, context)?;
    save(&image, &args.output, context)?;
    let (speed, walked) = match args.shade {
        Shade::Cells => ("speed of the walk", meter.walked),
        Shade::Lit => ("speed", Walked::sample(tracer.octree(), &PrimaryRays::jittered(&camera))),
        Shade::Normal | Shade::Depth | Shade::Primitive => {
            ("speed", Walked::sample(tracer.octree(), &PrimaryRays::through_middles(&camera)))
        }
    };

    let mut report = Report::new();
    report.add_octree(tracer.octree());
    if let Some(built) = built {
        add_seconds(&mut report, "build_seconds", "build time", built.time);
    }
    add_rays(&mut report, speed, &meter.traced);
    add_primary(&mut report, &meter.primary);
    add_walked(&mut report, &walked);
    if let Some(scale) = scale {
        report.add_as("scale_lowest", "scale, lowest", scale.lowest, scale.lowest.to_string());
        report.add_as("scale_highest", "scale, highest", scale.highest, scale.highest.to_string());
    }
    tracer.describe(&mut report);
    add_picture(&mut report, &args.output);
    context.report(&report)
}

impl RenderArgs {
    /// The view that frames the mesh, but for what the arguments say.
    fn view(&self, framing: &View) -> View {
        View {
            eye: self.eye.map_or(framing.eye, |point| point.0),
            at: self.at.map_or(framing.at, |point| point.0),
            up: self.up.map_or(framing.up, |point| point.0),
            fov: framing.fov,
        }
    }

    /// The picture, and the scale of its colours where they have one.
    fn draw(
        &self,
        meter: &mut Meter<'_, Backend>,
        octree: &Octree<Vec<u32>>,
        surfaces: &Surfaces,
        camera: &Camera,
        context: &Context,
    ) -> Result<(Image, Option<Scale>), PictureError<BackendError>> {
        let drawing = Drawing { meter, surfaces, camera, progress: &progress(camera.size(), context) };
        match self.shade {
            Shade::Lit => Ok((drawing.lit()?, None)),
            Shade::Normal => Ok((drawing.normals()?, None)),
            Shade::Primitive => Ok((drawing.primitives()?, None)),
            Shade::Depth => drawing.depths(),
            Shade::Cells => drawing.cells(octree),
        }
    }
}

/// Moves a bar over the pixels of a picture, and asks to stop after Ctrl-C.
pub(super) fn progress(size: Size, context: &Context) -> impl Fn(usize) -> ControlFlow<()> {
    let bar = context.progress_bar("render");
    bar.set_length(size.pixels() as u64);
    move |pixels| {
        bar.set_position(pixels as u64);
        if context.is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

pub(super) fn save(image: &Image, output: &Path, context: &Context) -> Result<(), CommandError> {
    context.write(output, |writer| image.write_png(writer))
}

pub(super) fn add_seconds(report: &mut Report, name: &'static str, label: &'static str, time: Duration) {
    let seconds = time.as_secs_f64();
    report.add_as(name, label, seconds, format!("{seconds:.3} s"));
}

/// All rays of a picture, and how fast they were traced; `speed` is the label that says by what.
pub(super) fn add_rays(report: &mut Report, speed: &'static str, traced: &Traced) {
    report.add("rays", "rays", traced.rays);
    report.add_speed(speed, traced.rays, traced.seconds);
}

pub(super) fn add_primary(report: &mut Report, primary: &Primary) {
    report.add("primary_rays", "primary rays", primary.rays);
    report.add("primary_hits", "of which hit", primary.hits);
}

/// The work of the counted walk, which is not that of the tracer whose speed is reported.
pub(super) fn add_walked(report: &mut Report, walked: &Walked) {
    let each = |count: u64| count as f64 / walked.rays.max(1) as f64;
    let (cells, blocks) = (each(walked.cells), each(walked.blocks));
    report.add("walked_rays", "walk: primary rays counted", walked.rays);
    report.add_as("cells_per_ray", "walk: cells a ray", cells, format!("{cells:.2}"));
    report.add_as("blocks_per_ray", "walk: block tests a ray", blocks, format!("{blocks:.2}"));
}

pub(super) fn add_picture(report: &mut Report, output: &Path) {
    report.add("picture", "picture", output.display().to_string());
}
