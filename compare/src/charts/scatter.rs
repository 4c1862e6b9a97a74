//! Speed against wrong answers: our headline.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::error::ChartError;
use super::style::{self, Shape};
use crate::truth::{Counts, per_million};

/// A method on one kind of rays.
#[derive(Clone, Debug)]
pub struct Point {
    /// What the mark is called.
    pub name: String,
    /// How it is drawn; see [`crate::methods::Method::family`].
    pub family: String,
    /// Millions of rays a second.
    pub speed: f64,
    /// How many answers are wrong, of how many.
    pub counts: Counts,
}

const PANEL: (u32, u32) = (460, 480);
/// The width of the column that says what the numbers beside marks mean.
const LEGEND: u32 = 270;
const LINE: i32 = 14;
const FONT: (&str, u32) = ("sans-serif", 13);
const SMALL: (&str, u32) = ("sans-serif", 11);
/// Half the width of a mark.
const MARK: i32 = 5;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

impl Point {
    /// Wrong answers per 10^9 rays, and whether that is only what they are below with 95 % confidence.
    fn rate(&self) -> (f64, bool) {
        let [share, _, upper] = per_million(self.counts.faults(), self.counts.rays).map(|rate| 1e3 * rate);
        if self.counts.faults() == 0 { (upper, true) } else { (share, false) }
    }
}

/// Draws panels of (title, points) side by side: millions of rays a second to the right, wrong answers per 10^9 rays upwards,
/// both logarithmic. Where no answer was wrong, the mark stands where 95 % confidence ends, with an arrow downwards. A line
/// joins the methods that none beats in both. Numbers beside marks are those of the legend.
///
/// # Errors
/// When a panel has no point, or the drawing library fails.
pub fn speed_and_faults(panels: &[(&str, Vec<Point>)]) -> Result<String, ChartError> {
    let legend = legend(panels);
    let mut svg = String::new();
    {
        let width = PANEL.0 * panels.len() as u32;
        let size = (width + LEGEND, PANEL.1.max(LINE as u32 * (legend.len() as u32 + 3)));
        let picture = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        picture.fill(&WHITE).map_err(ChartError::new)?;
        let (charts, column) = picture.split_horizontally(width);
        for ((title, points), area) in panels.iter().zip(charts.split_evenly((1, panels.len()))) {
            draw_panel(title, points, &legend, &area)?;
        }
        for (line, (name, family)) in (0..).zip(&legend) {
            let y = 20 + LINE * line;
            let (colour, shape) = style::of(family);
            mark(&column, (14, y), shape, colour)?;
            let text = format!("{} {name}", line + 1);
            column.draw(&Text::new(text, (26, y - 5), SMALL.into_font().color(&colour))).map_err(ChartError::new)?;
        }
        picture.present().map_err(ChartError::new)?;
    }
    Ok(svg)
}

/// All names, once each, with their families: in the order of the points.
fn legend<'a>(panels: &'a [(&str, Vec<Point>)]) -> Vec<(&'a str, &'a str)> {
    let mut legend: Vec<(&str, &str)> = Vec::new();
    for point in panels.iter().flat_map(|(_, points)| points) {
        if legend.iter().all(|(name, _)| *name != point.name) {
            legend.push((&point.name, &point.family));
        }
    }
    legend
}

/// A power of ten below all values, and one above.
fn range(values: impl Iterator<Item = f64> + Clone) -> Option<(f64, f64)> {
    let (least, most) = (values.clone().reduce(f64::min)?, values.reduce(f64::max)?);
    let bounds = (10f64.powf((least / 1.5).log10().floor()), 10f64.powf((1.5 * most).log10().ceil()));
    (bounds.0 > 0.0 && bounds.1.is_finite()).then_some(bounds)
}

fn draw_panel(title: &str, points: &[Point], legend: &[(&str, &str)], area: &Area<'_>) -> Result<(), ChartError> {
    let speeds = range(points.iter().map(|point| point.speed));
    let rates = range(points.iter().map(|point| point.rate().0));
    let (Some(speeds), Some(rates)) = (speeds, rates) else {
        return Err(ChartError::new(format!("{title} has no point with a speed")));
    };
    let mut chart = ChartBuilder::on(area)
        .caption(title, ("sans-serif", 16))
        .margin(10)
        .x_label_area_size(36)
        .y_label_area_size(56)
        .build_cartesian_2d((speeds.0..speeds.1).log_scale(), (rates.0..rates.1).log_scale())
        .map_err(ChartError::new)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .label_style(FONT)
        .x_desc("million rays a second, one thread")
        .y_desc("wrong answers per 10^9 rays")
        .x_label_formatter(&|speed| speed.to_string())
        .y_label_formatter(&|rate| format!("{rate:.0e}"))
        .draw()
        .map_err(ChartError::new)?;
    let front = front(points).into_iter().map(|point| (point.speed, point.rate().0));
    chart.draw_series(LineSeries::new(front, BLACK.mix(0.3).stroke_width(2))).map_err(ChartError::new)?;
    // The chart counts pixels from the picture's corner, what is drawn on the area from the area's.
    let (left, top) = area.get_pixel_range();
    let mut labels = Vec::new();
    for point in points {
        let (rate, is_bound) = point.rate();
        let (x, y) = chart.backend_coord(&(point.speed, rate));
        let place = (x - left.start, y - top.start);
        let (colour, shape) = style::of(&point.family);
        mark(area, place, shape, colour)?;
        if is_bound {
            let tip = (place.0, place.1 + 4 * MARK);
            let shaft = [(place.0, place.1 + MARK), tip];
            let head = [(tip.0 - 3, tip.1 - 5), tip, (tip.0 + 3, tip.1 - 5)];
            area.draw(&PathElement::new(shaft, colour)).map_err(ChartError::new)?;
            area.draw(&PathElement::new(head, colour)).map_err(ChartError::new)?;
        }
        let number = legend.iter().position(|(name, _)| *name == point.name).map_or(0, |at| at + 1);
        labels.push((place, colour, number.to_string()));
    }
    draw_labels(area, labels)
}

/// The points that none beats in both speed and rate, by speed.
fn front(points: &[Point]) -> Vec<&Point> {
    let beats = |a: &Point, b: &Point| {
        a.speed >= b.speed && a.rate().0 <= b.rate().0 && (a.speed > b.speed || a.rate().0 < b.rate().0)
    };
    let mut front: Vec<&Point> = points.iter().filter(|b| !points.iter().any(|a| beats(a, b))).collect();
    front.sort_by(|a, b| a.speed.total_cmp(&b.speed));
    front
}

fn mark(area: &Area<'_>, (x, y): (i32, i32), shape: Shape, colour: RGBColor) -> Result<(), ChartError> {
    let r = MARK;
    let polygon = |corners: &[(i32, i32)]| {
        let corners: Vec<_> = corners.iter().map(|(i, j)| (x + i, y + j)).collect();
        area.draw(&Polygon::new(corners, colour.filled()))
    };
    let drawn = match shape {
        Shape::Circle => area.draw(&Circle::new((x, y), r, colour.filled())),
        Shape::Square => polygon(&[(-r, -r), (r, -r), (r, r), (-r, r)]),
        Shape::Triangle => polygon(&[(0, -r), (r, r), (-r, r)]),
        Shape::Diamond => polygon(&[(0, -r), (r, 0), (0, r), (-r, 0)]),
        Shape::Star => {
            polygon(&[(0, -7), (2, -2), (7, -2), (3, 2), (4, 7), (0, 4), (-4, 7), (-3, 2), (-7, -2), (-2, -2)])
        }
        Shape::Cross => area.draw(&Cross::new((x, y), r, colour.stroke_width(2))),
    };
    drawn.map_err(ChartError::new)
}

/// Numbers beside marks, from the top to the bottom, each moved down where it would lie on another.
fn draw_labels(area: &Area<'_>, mut labels: Vec<((i32, i32), RGBColor, String)>) -> Result<(), ChartError> {
    labels.sort_by_key(|((x, y), ..)| (*y, *x));
    let mut taken: Vec<(i32, i32)> = Vec::new();
    for ((x, y), colour, number) in labels {
        let (left, mut top) = (x + MARK + 2, y - 12);
        while taken.iter().any(|(at, above)| (left - at).abs() < 14 && (top - above).abs() < 10) {
            top += 1;
        }
        taken.push((left, top));
        area.draw(&Text::new(number, (left, top), SMALL.into_font().color(&colour))).map_err(ChartError::new)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(name: &str, speed: f64, wrong: u64) -> Point {
        let counts = Counts { rays: 1_000_000, wrong, ..Counts::default() };
        Point { name: name.into(), family: "BVH".into(), speed, counts }
    }

    #[test]
    fn the_front_is_what_none_beats() {
        let points = [point("slow", 1.0, 0), point("fast", 9.0, 50), point("beaten", 0.5, 60), point("middle", 3.0, 5)];
        assert_eq!(front(&points).iter().map(|point| &point.name[..]).collect::<Vec<_>>(), ["slow", "middle", "fast"]);
    }

    #[test]
    fn a_rate_of_none_is_a_bound() {
        let (rate, is_bound) = point("none", 1.0, 0).rate();
        // The rule of three says 3,000; Wilson's interval is a little wider.
        assert!(is_bound && (3000.0..4000.0).contains(&rate), "{rate}");
        assert_eq!(point("some", 1.0, 7).rate(), (7000.0, false));
    }

    #[test]
    fn every_point_is_named() {
        let points = vec![point("alpha", 2.0, 0), point("beta", 4.0, 7), point("gamma", 4.0, 7)];
        let svg = speed_and_faults(&[("typical", points.clone()), ("hard", points)]).expect("a chart");
        for name in ["alpha", "beta", "gamma"] {
            assert_eq!(svg.matches(name).count(), 1, "{name} in {svg}");
        }
        assert!(speed_and_faults(&[("empty", Vec::new())]).is_err());
    }
}
