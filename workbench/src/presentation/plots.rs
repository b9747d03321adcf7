//! The pictures people know, as SVG text.

use std::f64::consts::TAU;

use plotters::coord::Shift;
use plotters::prelude::*;

use crate::ballbar::{Point, radial_um};
use crate::error::{Failure, Outcome};

const INK: RGBColor = RGBColor(40, 40, 40);
const PALE: RGBColor = RGBColor(200, 200, 200);
/// Before, after, and what follows them.
const SERIES: [RGBColor; 6] = [
    RGBColor(200, 60, 40),
    RGBColor(20, 110, 180),
    RGBColor(30, 140, 70),
    RGBColor(150, 80, 170),
    RGBColor(220, 140, 20),
    RGBColor(90, 90, 90),
];

fn failed<E: std::fmt::Display>(error: E) -> Failure {
    Failure::new(format!("cannot draw the plot: {error}"))
}

/// Draws into a string; plotters writes an XML header that has no place inside a page.
fn draw(
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

/// The text of an SVG file of its own.
#[must_use]
pub fn standalone(svg: &str) -> String {
    svg.replacen(
        "<svg",
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg",
        1,
    )
}

/// A path for the polar plot.
pub struct Trace<'a> {
    /// Legend.
    pub name: String,
    /// Turns that count.
    pub points: &'a [Point],
    /// Nominal radius, m.
    pub radius_m: f64,
}

/// Polar plot of circle deviations: the deviation is drawn with an exaggerated scale on the nominal
/// circle.
///
/// # Errors
/// Where the plot cannot be drawn.
pub fn polar(title: &str, traces: &[Trace<'_>]) -> Outcome<String> {
    let largest = |trace: &Trace<'_>| {
        trace
            .points
            .iter()
            .map(|p| radial_um(p, trace.radius_m).abs())
            .fold(0.0, f64::max)
    };
    let step = nice_step(traces.iter().map(largest).fold(1.0, f64::max) / 3.0);
    // The nominal circle at 1, one step of deviation 0.12 of it.
    let per_um = 0.12 / step;
    draw((620, 647), |root| {
        let mut chart = ChartBuilder::on(root)
            .caption(title, ("sans-serif", 18))
            .margin(10)
            .build_cartesian_2d(-1.55..1.55, -1.55..1.55)
            .map_err(failed)?;
        for ring in -3..=3_i32 {
            let radius = 1.0 + f64::from(ring) * 0.12;
            let style = if ring == 0 {
                INK.stroke_width(1)
            } else {
                PALE.stroke_width(1)
            };
            chart
                .draw_series(LineSeries::new(ring_points(radius), style))
                .map_err(failed)?;
        }
        for axis in 0..4_u8 {
            let (sin, cos) = (TAU / 4.0 * f64::from(axis)).sin_cos();
            chart
                .draw_series(LineSeries::new(
                    [(0.5 * cos, 0.5 * sin), (1.45 * cos, 1.45 * sin)],
                    PALE,
                ))
                .map_err(failed)?;
        }
        for (trace, color) in traces.iter().zip(SERIES) {
            let place = |point: &Point| {
                let angle = point.reference_m[1].atan2(point.reference_m[0]);
                let radius = (1.0 + per_um * radial_um(point, trace.radius_m)).max(0.0);
                (radius * angle.cos(), radius * angle.sin())
            };
            let line = thinned(trace.points, 4000).map(place);
            let series = chart
                .draw_series(LineSeries::new(line, color.stroke_width(2)))
                .map_err(failed)?;
            series.label(trace.name.clone()).legend(move |(x, y)| {
                PathElement::new([(x, y), (x + 18, y)], color.stroke_width(3))
            });
        }
        let note = format!("ring to ring {step} µm");
        let style = ("sans-serif", 13).into_font().color(&INK);
        chart
            .draw_series([Text::new(note, (-1.5, -1.5), style)])
            .map_err(failed)?;
        legend(&mut chart)
    })
}

fn ring_points(radius: f64) -> impl Iterator<Item = (f64, f64)> {
    (0..=180_u8).map(move |i| {
        let (sin, cos) = (TAU * f64::from(i) / 180.0).sin_cos();
        (radius * cos, radius * sin)
    })
}

fn legend<'a, X, Y>(chart: &mut ChartContext<'a, SVGBackend<'a>, Cartesian2d<X, Y>>) -> Outcome<()>
where
    X: plotters::coord::ranged1d::Ranged<ValueType = f64>,
    Y: plotters::coord::ranged1d::Ranged<ValueType = f64>,
{
    let labels = chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .border_style(PALE)
        .background_style(WHITE.mix(0.85))
        .draw();
    labels.map_err(failed)
}

/// 1, 2 or 5 times a power of ten, at least `value`.
fn nice_step(value: f64) -> f64 {
    let power = 10.0_f64.powf(value.max(1.0e-9).log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|m| m * power)
        .find(|step| *step >= value * (1.0 - 1.0e-9))
        .unwrap_or(10.0 * power)
}

fn thinned<T>(items: &[T], most: usize) -> impl Iterator<Item = &T> {
    items.iter().step_by(items.len().div_ceil(most).max(1))
}

/// A named curve.
pub struct Curve {
    /// Legend.
    pub name: String,
    /// Points.
    pub points: Vec<(f64, f64)>,
    /// Dots instead of a line.
    pub dots: bool,
}

/// One plot of several curves over the same axis.
///
/// # Errors
/// Where the plot cannot be drawn.
pub fn curves(title: &str, x: &str, y: &str, size: (u32, u32), list: &[Curve]) -> Outcome<String> {
    let all = || list.iter().flat_map(|curve| curve.points.iter());
    let (x_low, x_high) = range(all().map(|(x, _)| *x), 0.0);
    let (y_low, y_high) = range(all().map(|(_, y)| *y), 0.05);
    draw(size, |root| {
        let mut chart = ChartBuilder::on(root)
            .caption(title, ("sans-serif", 16))
            .margin(8)
            .x_label_area_size(36)
            .y_label_area_size(64)
            .build_cartesian_2d(x_low..x_high, y_low..y_high)
            .map_err(failed)?;
        let mut mesh = chart.configure_mesh();
        mesh.x_desc(x)
            .y_desc(y)
            .light_line_style(WHITE)
            .bold_line_style(PALE.mix(0.5))
            .label_style(("sans-serif", 12))
            .draw()
            .map_err(failed)?;
        for (curve, color) in list.iter().zip(SERIES) {
            let points = thinned(&curve.points, 3000).copied();
            let series = if curve.dots {
                chart
                    .draw_series(points.map(|at| Circle::new(at, 1, color.mix(0.5).filled())))
                    .map_err(failed)?
            } else {
                chart
                    .draw_series(LineSeries::new(points, color.stroke_width(2)))
                    .map_err(failed)?
            };
            series.label(curve.name.clone()).legend(move |(x, y)| {
                PathElement::new([(x, y), (x + 18, y)], color.stroke_width(3))
            });
        }
        if list.len() > 1 {
            legend(&mut chart)
        } else {
            Ok(())
        }
    })
}

fn range(values: impl Iterator<Item = f64>, margin: f64) -> (f64, f64) {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
        (low.min(v), high.max(v))
    });
    if !(low.is_finite() && high.is_finite()) {
        return (0.0, 1.0);
    }
    let width = (high - low).max(1.0e-12);
    (low - margin * width, high + margin * width)
}
