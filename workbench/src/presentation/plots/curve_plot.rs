//! Curves, or clouds of dots, over one axis.

use plotters::prelude::*;

use super::canvas::{Chart, PALE, SERIES, draw, failed, legend, name_in_legend, thinned};
use crate::error::Outcome;

/// Height of the letters of a title, px.
const LARGEST_TITLE: f64 = 16.0;
/// Width of a letter over its height, on average, and a little more.
const LETTER: f64 = 0.38;

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
            .caption(title, ("sans-serif", title_size(title, size.0)))
            .margin(8)
            .x_label_area_size(36)
            .y_label_area_size(64)
            .build_cartesian_2d(x_low..x_high, y_low..y_high)
            .map_err(failed)?;
        mesh(&mut chart, (x, x_high - x_low), (y, y_high - y_low))?;
        for (curve, color) in list.iter().zip(SERIES) {
            series(&mut chart, curve, color)?;
        }
        if list.len() > 1 {
            legend(&mut chart, emptiest(list, (x_low, x_high), (y_low, y_high)))
        } else {
            Ok(())
        }
    })
}

/// Part of the width and of the height that a legend takes.
const LEGEND: f64 = 0.3;

/// The corner with the fewest points of all curves in it.
fn emptiest(list: &[Curve], x: (f64, f64), y: (f64, f64)) -> SeriesLabelPosition {
    use SeriesLabelPosition::{LowerLeft, LowerRight, UpperLeft, UpperRight};
    let share = |value: f64, (low, high): (f64, f64)| (value - low) / (high - low);
    let points = list.iter().flat_map(|curve| thinned(&curve.points, 3000));
    let points: Vec<(f64, f64)> = points.map(|at| (share(at.0, x), share(at.1, y))).collect();
    let inside = |(right, upper): (bool, bool)| {
        let is_near = |share: f64, is_end: bool| if is_end { 1.0 - share } else { share } < LEGEND;
        let near = points
            .iter()
            .filter(|at| is_near(at.0, right) && is_near(at.1, upper));
        near.count()
    };
    let corners = [
        (UpperRight, (true, true)),
        (UpperLeft, (false, true)),
        (LowerRight, (true, false)),
        (LowerLeft, (false, false)),
    ];
    let fewest = corners
        .into_iter()
        .min_by_key(|(_, corner)| inside(*corner));
    fewest.map_or(UpperRight, |(position, _)| position)
}

/// Height of the letters of a title, px: as large as its plot is wide enough for.
fn title_size(title: &str, width_px: u32) -> f64 {
    let letters = title.chars().count().max(1) as f64;
    (f64::from(width_px) / (LETTER * letters)).min(LARGEST_TITLE)
}

/// The mesh with its labels; each axis has a name and a width.
fn mesh(
    chart: &mut Chart<'_>,
    (x, x_width): (&str, f64),
    (y, y_width): (&str, f64),
) -> Outcome<()> {
    let mut mesh = chart.configure_mesh();
    mesh.x_desc(x)
        .y_desc(y)
        .x_label_formatter(&|value| tick(*value, x_width))
        .y_label_formatter(&|value| tick(*value, y_width))
        .light_line_style(WHITE)
        .bold_line_style(PALE.mix(0.5))
        .label_style(("sans-serif", 12))
        .draw()
        .map_err(failed)
}

/// A value at an axis of some width: to a thousandth of it, without zeros that say nothing.
fn tick(value: f64, width: f64) -> String {
    let decimals = (3.0 - width.log10().floor()).clamp(0.0, 15.0) as usize;
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    if text == "-0" {
        "0".into()
    } else {
        text.into()
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_legend_stands_where_no_curve_is() {
        use SeriesLabelPosition::{LowerRight, UpperLeft, UpperRight};
        let rising = |sign: f64| Curve {
            name: String::new(),
            points: (0..100)
                .map(|i| (f64::from(i), sign * f64::from(i)))
                .collect(),
            dots: false,
        };
        let corner = |curve: Curve, y: (f64, f64)| emptiest(&[curve], (0.0, 99.0), y);
        assert!(matches!(corner(rising(1.0), (0.0, 99.0)), UpperLeft));
        assert!(matches!(corner(rising(-1.0), (-99.0, 0.0)), UpperRight));
        let both = [rising(1.0), rising(0.0)];
        assert!(matches!(
            emptiest(&both, (0.0, 99.0), (0.0, 99.0)),
            UpperLeft
        ));
        let above = Curve {
            points: vec![(0.0, 99.0), (99.0, 99.0)],
            ..rising(0.0)
        };
        assert!(matches!(corner(above, (0.0, 99.0)), LowerRight));
    }

    #[test]
    fn a_tick_has_the_digits_of_its_axis_and_no_zeros_that_say_nothing() {
        for (value, width, wanted) in [
            (100_000.0, 250_000.0, "100000"),
            (-0.0, 0.6, "0"),
            (-1.0e-9, 0.6, "0"),
            (0.15, 0.6, "0.15"),
            (0.1 + 0.2, 1.0, "0.3"),
            (-40.0, 200.0, "-40"),
            (2.5e-6, 2.0e-5, "0.0000025"),
        ] {
            assert_eq!(tick(value, width), wanted);
        }
    }

    #[test]
    fn a_title_is_as_wide_as_its_plot_at_most() {
        assert_eq!(title_size("short", 560), LARGEST_TITLE);
        let long = "l".repeat(100);
        let size = title_size(&long, 560);
        assert!((size * LETTER * 100.0 - 560.0).abs() < 1.0e-9, "{size}");
    }
}
