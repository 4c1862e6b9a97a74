//! How families look.

use plotters::style::RGBColor;

/// The shape of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    Star,
    Circle,
    Square,
    Triangle,
    Diamond,
    Cross,
}

/// Families as charts draw them; colours of M. Okabe and K. Ito, "Color Universal Design", 2008, which the colour-blind tell
/// apart.
const FAMILIES: [(&str, RGBColor, Shape); 6] = [
    ("leafwalk", RGBColor(0, 114, 178), Shape::Star),
    ("BVH", RGBColor(213, 94, 0), Shape::Circle),
    ("octree", RGBColor(0, 158, 115), Shape::Square),
    ("grid", RGBColor(204, 121, 167), Shape::Triangle),
    ("kd-tree", RGBColor(148, 103, 0), Shape::Diamond),
    ("Embree", RGBColor(0, 0, 0), Shape::Cross),
];
/// All others.
const OTHER: (RGBColor, Shape) = (RGBColor(90, 90, 90), Shape::Cross);

/// The colour and the shape of a family.
pub(super) fn of(family: &str) -> (RGBColor, Shape) {
    let known = FAMILIES.iter().find(|(name, ..)| *name == family);
    known.map_or(OTHER, |(_, colour, shape)| (*colour, *shape))
}
