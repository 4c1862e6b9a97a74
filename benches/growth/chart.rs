//! The measurements as a picture.

use core::error::Error;
use std::path::Path;

use plotters::prelude::*;

use crate::{MEASURES, Point};

const SIZE: (u32, u32) = (960, 560);
/// The size of the line that says whose curve is which.
const HEAD: u32 = 28;
const OURS: (&str, RGBColor) = ("leafwalk", RGBColor(0, 100, 200));
const EMBREE: (&str, RGBColor) = ("Embree, the fastest way to call it", RGBColor(200, 90, 0));

/// Draws a panel a measure, over the number of triangles.
pub(crate) fn draw(points: &[Point], path: &Path) -> Result<(), Box<dyn Error>> {
    let picture = SVGBackend::new(path, SIZE).into_drawing_area();
    picture.fill(&WHITE)?;
    let (head, body) = picture.split_vertically(HEAD);
    for ((name, colour), x) in [(OURS, 16), (EMBREE, 100)] {
        head.draw(&Text::new(name, (x, 8), ("sans-serif", 16).into_font().color(&colour)))?;
    }
    let panels = body.split_evenly((2, 3));
    for ((measure, unit), panel) in MEASURES.into_iter().zip(&panels) {
        let points: Vec<&Point> = points.iter().filter(|point| point.measure == measure).collect();
        let ours: Vec<(f64, f64)> = points.iter().map(|point| (point.triangles as f64, point.ours)).collect();
        let embree = points.iter().filter_map(|point| Some((point.triangles as f64, point.embree.as_ref()?.0)));
        let embree: Vec<(f64, f64)> = embree.collect();
        let (Some(first), Some(last)) = (ours.first(), ours.last()) else { continue };
        let most = ours.iter().chain(&embree).map(|(_, value)| *value).fold(0.0, f64::max);
        let mut chart = ChartBuilder::on(panel)
            .caption(format!("{measure}, {unit}"), ("sans-serif", 16))
            .margin(8)
            .x_label_area_size(24)
            .y_label_area_size(40)
            .build_cartesian_2d((first.0 / 1.3..last.0 * 1.3).log_scale(), 0.0..1.1 * most)?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .x_labels(6)
            .x_label_formatter(&|triangles| power(*triangles))
            .y_label_formatter(&|value| value.to_string())
            .draw()?;
        for ((_, colour), series) in [(OURS, ours), (EMBREE, embree)] {
            chart.draw_series(series.iter().map(|point| Circle::new(*point, 3, colour.filled())))?;
            chart.draw_series(LineSeries::new(series, colour.stroke_width(2)))?;
        }
    }
    picture.present()?;
    Ok(())
}

/// A number of triangles in short.
fn power(triangles: f64) -> String {
    match triangles {
        large if large >= 1e6 => format!("{} M", large / 1e6),
        large if large >= 1e3 => format!("{} k", large / 1e3),
        small => small.to_string(),
    }
}
