//! Curves, or clouds of dots, over one axis.

use plotters::prelude::*;

use super::canvas::{Chart, PALE, SERIES, draw, failed, legend, name_in_legend, thinned};
use crate::error::Outcome;

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
        mesh(&mut chart, x, y)?;
        for (curve, color) in list.iter().zip(SERIES) {
            series(&mut chart, curve, color)?;
        }
        if list.len() > 1 {
            legend(&mut chart)
        } else {
            Ok(())
        }
    })
}

fn mesh(chart: &mut Chart<'_>, x: &str, y: &str) -> Outcome<()> {
    let mut mesh = chart.configure_mesh();
    mesh.x_desc(x)
        .y_desc(y)
        .light_line_style(WHITE)
        .bold_line_style(PALE.mix(0.5))
        .label_style(("sans-serif", 12))
        .draw()
        .map_err(failed)
}

fn series(chart: &mut Chart<'_>, curve: &Curve, color: RGBColor) -> Outcome<()> {
    let points = thinned(&curve.points, 3000).copied();
    let drawn = if curve.dots {
        chart.draw_series(points.map(|at| Circle::new(at, 1, color.mix(0.5).filled())))
    } else {
        chart.draw_series(LineSeries::new(points, color.stroke_width(2)))
    };
    name_in_legend(drawn.map_err(failed)?, &curve.name, color);
    Ok(())
}

/// From the smallest to the largest value, and a share of the width more at both ends.
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
