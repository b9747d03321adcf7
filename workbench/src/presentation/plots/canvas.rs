//! What all plots share: the SVG they are drawn into, colours, legend.

use plotters::chart::SeriesAnno;
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use crate::error::{Failure, Outcome};

/// Text, and the nominal circle.
pub(super) const INK: RGBColor = RGBColor(40, 40, 40);
/// What must not disturb.
pub(super) const PALE: RGBColor = RGBColor(200, 200, 200);
/// Before, after, and what follows them.
pub(super) const SERIES: [RGBColor; 6] = [
    RGBColor(200, 60, 40),
    RGBColor(20, 110, 180),
    RGBColor(30, 140, 70),
    RGBColor(150, 80, 170),
    RGBColor(220, 140, 20),
    RGBColor(90, 90, 90),
];

/// Why a plot could not be drawn.
pub(super) fn failed<E: std::fmt::Display>(error: E) -> Failure {
    Failure::new(format!("cannot draw the plot: {error}"))
}

/// Draws into a string; plotters writes an XML header that has no place inside a page.
pub(super) fn draw(
    size: (u32, u32),
    paint: impl for<'a> FnOnce(&DrawingArea<SVGBackend<'a>, Shift>) -> Outcome<()>,
) -> Outcome<String> {
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        paint(&root)?;
        root.present().map_err(failed)?;
    }
    let start = text.find("<svg").unwrap_or(0);
    // Scales with the page instead of having a size of its own.
    Ok(text[start..].replacen(
        &format!("width=\"{}\" height=\"{}\"", size.0, size.1),
        &format!(
            "width=\"100%\" style=\"max-width:{}px\" font-family=\"sans-serif\"",
            size.0
        ),
        1,
    ))
}

/// Two axes in an SVG.
pub(super) type Chart<'a> =
    ChartContext<'a, SVGBackend<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// The names of the series, in a corner.
pub(super) fn legend(chart: &mut Chart<'_>, corner: SeriesLabelPosition) -> Outcome<()> {
    let labels = chart
        .configure_series_labels()
        .position(corner)
        .border_style(PALE)
        .background_style(WHITE.mix(0.85))
        .draw();
    labels.map_err(failed)
}

/// A line of the legend.
pub(super) fn name_in_legend<'a>(
    series: &mut SeriesAnno<'a, SVGBackend<'a>>,
    name: &str,
    color: RGBColor,
) {
    series
        .label(name)
        .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], color.stroke_width(3)));
}

/// At most about `most` of the items, evenly chosen: more dots than pixels show nothing.
pub(super) fn thinned<T>(items: &[T], most: usize) -> impl Iterator<Item = &T> {
    items.iter().step_by(items.len().div_ceil(most).max(1))
}
