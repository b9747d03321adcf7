//! The polar plot of a ballbar test: the deviation is drawn with an exaggerated scale on the
//! nominal circle.

use std::f64::consts::TAU;

use plotters::prelude::*;

use super::canvas::{Chart, INK, PALE, SERIES, draw, failed, legend, name_in_legend, thinned};
use crate::ballbar::{Point, radial_um};
use crate::error::Outcome;

/// A ring is so far from the next, in radii of the nominal circle.
const RING: f64 = 0.12;
/// Rings to either side of the nominal circle.
const RINGS: i32 = 3;

/// A path for the polar plot.
pub struct Trace<'a> {
    /// Legend.
    pub name: String,
    /// Turns that count.
    pub points: &'a [Point],
    /// Nominal radius, m.
    pub radius_m: f64,
}

/// Polar plot of circle deviations.
///
/// # Errors
/// Where the plot cannot be drawn.
pub fn polar(title: &str, traces: &[Trace<'_>]) -> Outcome<String> {
    let largest_um = traces.iter().map(largest_um).fold(1.0, f64::max);
    let ring_um = nice_step(largest_um / f64::from(RINGS));
    draw((620, 647), |root| {
        let mut chart = ChartBuilder::on(root)
            .caption(title, ("sans-serif", 18))
            .margin(10)
            .build_cartesian_2d(-1.55..1.55, -1.55..1.55)
            .map_err(failed)?;
        grid(&mut chart)?;
        for (trace, color) in traces.iter().zip(SERIES) {
            path(&mut chart, trace, color, ring_um)?;
        }
        let note = format!("ring to ring {ring_um} µm");
        let style = ("sans-serif", 13).into_font().color(&INK);
        chart
            .draw_series([Text::new(note, (-1.5, -1.5), style)])
            .map_err(failed)?;
        legend(&mut chart, SeriesLabelPosition::UpperRight)
    })
}

fn largest_um(trace: &Trace<'_>) -> f64 {
    let deviations = trace
        .points
        .iter()
        .map(|point| radial_um(point, trace.radius_m).abs());
    deviations.fold(0.0, f64::max)
}

/// Rings, the nominal circle among them, and the axes.
fn grid(chart: &mut Chart<'_>) -> Outcome<()> {
    for ring in -RINGS..=RINGS {
        let radius = 1.0 + f64::from(ring) * RING;
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
        let ends = [(0.5 * cos, 0.5 * sin), (1.45 * cos, 1.45 * sin)];
        chart
            .draw_series(LineSeries::new(ends, PALE))
            .map_err(failed)?;
    }
    Ok(())
}

/// The deviation of a trace, `ring_um` of it from ring to ring.
fn path(chart: &mut Chart<'_>, trace: &Trace<'_>, color: RGBColor, ring_um: f64) -> Outcome<()> {
    let per_um = RING / ring_um;
    let place = |point: &Point| {
        let angle = point.reference_m[1].atan2(point.reference_m[0]);
        let radius = (1.0 + per_um * radial_um(point, trace.radius_m)).max(0.0);
        (radius * angle.cos(), radius * angle.sin())
    };
    let line = thinned(trace.points, 4000).map(place);
    let series = chart
        .draw_series(LineSeries::new(line, color.stroke_width(2)))
        .map_err(failed)?;
    name_in_legend(series, &trace.name, color);
    Ok(())
}

fn ring_points(radius: f64) -> impl Iterator<Item = (f64, f64)> {
    (0..=180_u8).map(move |i| {
        let (sin, cos) = (TAU * f64::from(i) / 180.0).sin_cos();
        (radius * cos, radius * sin)
    })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_1_2_or_5_times_a_power_of_ten_and_never_less_than_asked_for() {
        for (value, step) in [
            (0.3, 0.5),
            (1.0, 1.0),
            (1.1, 2.0),
            (4.0, 5.0),
            (51.0, 100.0),
        ] {
            let got = nice_step(value);
            assert!((got / step - 1.0).abs() < 1.0e-9, "{value}: {got}");
        }
    }
}
