//! The polar plot of a ballbar test: the deviation is drawn with an exaggerated scale on the
//! nominal circle.

use super::curve::Ink;
use super::curve_plot::lines;
use super::scale::nice_step;
use super::svg::{Anchor, Figure, path_through};
use super::thinning::{COLUMN_PX, extremes, without_straight};
use crate::ballbar::{Point, radial_um};

/// From the nominal circle to the outermost ring, px.
const BAND_PX: f64 = 69.0;
/// At most so many rings to either side of the nominal circle.
const RINGS: f64 = 4.5;
/// The nominal circle, px.
const NOMINAL_PX: f64 = 172.0;
/// The path is the record within this, µm: where a column of the picture is less, only its extremes
/// are drawn.
const DRAWN_UM: f64 = 0.05;
/// Where the rings have their numbers: between two reversals, and steep enough that none touches
/// another.
const NUMBERS_DEG: f64 = 67.0;
const WIDTH_PX: f64 = 760.0;
/// From the middle to the ends above and below.
const ABOVE_PX: f64 = 290.0;
const BELOW_PX: f64 = 290.0;
const LEGEND_LINE_PX: f64 = 18.0;

/// A path for the polar plot.
pub struct Trace<'a> {
    /// Name.
    pub name: String,
    /// Colour.
    pub ink: Ink,
    /// Dashed: the other direction of the same.
    pub is_dashed: bool,
    /// Turns that are shown.
    pub points: &'a [Point],
    /// Nominal radius, m.
    pub radius_m: f64,
}

/// The polar plot of a circle test.
pub struct Polar<'a> {
    /// What it shows.
    pub title: &'a str,
    /// Names of the axes to the right and upwards.
    pub axes: [&'a str; 2],
    /// The paths; the first one lowest.
    pub traces: &'a [Trace<'a>],
    /// What stands at the reversals, at 0°, 90°, 180° and 270°.
    pub bursts: [String; 4],
    /// The zone that the tolerance leaves.
    pub zone: Option<Zone>,
}

/// A zone of circular deviation: so wide, wherever it lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zone {
    /// Width, µm.
    pub width_um: f64,
    /// Deviation in the middle of it, µm.
    pub middle_um: f64,
    /// Where its centre is, µm from the nominal one.
    pub center_um: [f64; 2],
}

impl Zone {
    fn edges_um(self) -> [f64; 2] {
        [-0.5, 0.5].map(|side| self.middle_um + side * self.width_um)
    }
}

/// Draws it.
#[must_use]
pub fn polar(plot: &Polar<'_>) -> String {
    let largest_um = plot.traces.iter().map(largest_um).fold(0.1, f64::max);
    let edges_um = plot.zone.map(Zone::edges_um);
    let largest_um = edges_um
        .into_iter()
        .flatten()
        .map(f64::abs)
        .fold(largest_um, f64::max);
    let ring_um = nice_step(largest_um / RINGS);
    let title = lines(plot.title, 15.0, WIDTH_PX - 20.0);
    let names = plot.traces.len() + usize::from(plot.zone.is_some());
    let head_px = 19.0 * title.len() as f64 + LEGEND_LINE_PX * names.div_ceil(2) as f64;
    let middle = (0.5 * WIDTH_PX, head_px + ABOVE_PX + 10.0);
    let size_px = (WIDTH_PX, middle.1 + BELOW_PX);
    let mut figure = Figure::new(size_px, plot.title, description(plot, ring_um));
    for (line, text) in title.iter().enumerate() {
        figure.text(
            "name",
            (10.0, 19.0 * (line + 1) as f64),
            Anchor::Start,
            text,
        );
    }
    legend(&mut figure, plot, 19.0 * title.len() as f64 + 6.0);
    let rings = Rings {
        middle,
        ring_um,
        count: (largest_um / ring_um - 1.0e-9).ceil().max(1.0) as i32,
    };
    rings.grid(&mut figure, plot.axes);
    for (place, text) in plot.bursts.iter().enumerate() {
        rings.burst(&mut figure, place, text);
    }
    if let Some(zone) = plot.zone {
        rings.draw_zone(&mut figure, zone);
    }
    for trace in plot.traces {
        rings.draw(&mut figure, trace);
    }
    rings.numbers(&mut figure);
    figure.finish()
}

fn description(plot: &Polar<'_>, ring_um: f64) -> String {
    let of = |trace: &Trace<'_>| format!("{} up to {:.2} µm", trace.name, largest_um(trace));
    let traces: Vec<String> = plot.traces.iter().map(of).collect();
    format!(
        "Deviation from the nominal circle, {ring_um} µm from ring to ring: {}",
        traces.join("; ")
    )
}

fn largest_um(trace: &Trace<'_>) -> f64 {
    let deviations = trace
        .points
        .iter()
        .map(|point| radial_um(point, trace.radius_m).abs());
    deviations.fold(0.0, f64::max)
}

fn legend(figure: &mut Figure, plot: &Polar<'_>, top_px: f64) {
    let traces = plot
        .traces
        .iter()
        .map(|trace| (class(trace), trace.name.clone()));
    let zone = plot.zone.map(|zone| {
        let name = format!("tolerance zone of G, {} µm wide", zone.width_um);
        ("tolerance".to_owned(), name)
    });
    for (index, (class, name)) in traces.chain(zone).enumerate() {
        let x = 10.0 + 0.5 * WIDTH_PX * (index % 2) as f64;
        let y = top_px + LEGEND_LINE_PX * ((index / 2) as f64 + 0.5);
        figure.line(&class, (x, y), (x + 30.0, y));
        figure.text("label", (x + 36.0, y + 4.0), Anchor::Start, &name);
    }
}

fn class(trace: &Trace<'_>) -> String {
    // Dashes tell the direction here, and nothing else.
    let dashes = if trace.is_dashed { "back" } else { "solid" };
    format!("curve {} {dashes}", trace.ink.class())
}

/// Where deviations are drawn.
struct Rings {
    middle: (f64, f64),
    ring_um: f64,
    /// To either side of the nominal circle.
    count: i32,
}

impl Rings {
    fn um_per_px(&self) -> f64 {
        f64::from(self.count) * self.ring_um / BAND_PX
    }

    fn radius_px(&self, deviation_um: f64) -> f64 {
        (NOMINAL_PX + deviation_um / self.um_per_px()).max(0.0)
    }

    fn ring_px(&self, ring: i32) -> f64 {
        self.radius_px(f64::from(ring) * self.ring_um)
    }

    fn at(&self, angle_rad: f64, radius_px: f64) -> (f64, f64) {
        let (sin, cos) = angle_rad.sin_cos();
        (
            self.middle.0 + radius_px * cos,
            self.middle.1 - radius_px * sin,
        )
    }

    /// Rings, the nominal circle among them, degrees and the signs of the axes.
    fn grid(&self, figure: &mut Figure, axes: [&str; 2]) {
        let outermost = NOMINAL_PX + BAND_PX;
        for ring in -self.count..=self.count {
            let class = if ring == 0 { "nominal" } else { "grid" };
            figure.circle(class, self.middle, self.ring_px(ring));
        }
        for step in 0..12_u8 {
            let degrees = 30.0 * f64::from(step);
            let angle = degrees.to_radians();
            figure.line(
                "grid",
                self.at(angle, 80.0),
                self.at(angle, outermost + 4.0),
            );
            if step % 3 != 0 {
                let (x, y) = self.at(angle, outermost + 20.0);
                figure.text("tick", (x, y + 4.0), Anchor::Middle, &format!("{degrees}°"));
            }
        }
        for place in 0..4 {
            let sign = if place < 2 { '+' } else { '−' };
            let text = format!("{sign}{} ({}°)", axes[place % 2], 90 * place);
            let (at, anchor) = self.beside(place, 0.0);
            figure.text("label", at, anchor, &text);
        }
    }

    /// A place for words outside the rings at 0°, 90°, 180° or 270°, so many lines further out.
    fn beside(&self, place: usize, line: f64) -> ((f64, f64), Anchor) {
        let out = NOMINAL_PX + BAND_PX + 8.0;
        let (x, y) = self.middle;
        match place {
            0 => ((x + out, y - 5.0 + 16.0 * line), Anchor::Start),
            1 => ((x, y - out - 4.0 - 16.0 * line), Anchor::Middle),
            2 => ((x - out, y - 5.0 + 16.0 * line), Anchor::End),
            _ => ((x, y + out + 8.0 + 16.0 * line), Anchor::Middle),
        }
    }

    /// The burst at a reversal; beside the circle in lines that fit there.
    fn burst(&self, figure: &mut Figure, place: usize, text: &str) {
        let out = NOMINAL_PX + BAND_PX + 16.0;
        let width = if place.is_multiple_of(2) {
            0.5 * WIDTH_PX - out
        } else {
            WIDTH_PX
        };
        let lines = lines(text, 12.0, width);
        let count = lines.len();
        for (index, line) in lines.iter().enumerate() {
            // Above the circle the first line is the uppermost as well.
            let number = if place == 1 { count - index } else { index + 1 };
            let (at, anchor) = self.beside(place, number as f64);
            figure.text("burst", at, anchor, line);
        }
    }

    fn draw_zone(&self, figure: &mut Figure, zone: Zone) {
        let [x, y] = zone.center_um;
        for edge_um in zone.edges_um() {
            let around = (0..=360_u16).map(|degrees| {
                let angle = f64::from(degrees).to_radians();
                let (sin, cos) = angle.sin_cos();
                self.at(angle, self.radius_px(edge_um + x * cos + y * sin))
            });
            figure.path("tolerance", &path_through(around), "tolerance");
        }
    }

    fn draw(&self, figure: &mut Figure, trace: &Trace<'_>) {
        // Along the nominal circle, as if it were cut and laid straight.
        let laid = |point: &Point| {
            let angle = point.reference_m[1].atan2(point.reference_m[0]);
            let radius = self.radius_px(radial_um(point, trace.radius_m));
            (NOMINAL_PX * angle, radius)
        };
        let laid = trace.points.iter().map(laid);
        let is_fine = COLUMN_PX * self.um_per_px() < DRAWN_UM;
        let laid: Vec<_> = if is_fine {
            extremes(laid)
        } else {
            laid.collect()
        };
        let bent = |(along, radius): (f64, f64)| self.at(along / NOMINAL_PX, radius);
        let path = path_through(without_straight(laid.into_iter().map(bent).collect()));
        let tip = format!("{}: up to {:.2} µm", trace.name, largest_um(trace));
        figure.path(&class(trace), &path, &tip);
    }

    /// The deviation that each ring stands for, where nothing happens on a circle.
    fn numbers(&self, figure: &mut Figure) {
        for ring in (-self.count..=self.count).filter(|ring| *ring != 0) {
            let (x, y) = self.at(NUMBERS_DEG.to_radians(), self.ring_px(ring));
            let um = (1.0e6 * f64::from(ring.abs()) * self.ring_um).round() / 1.0e6;
            let sign = if ring < 0 { '−' } else { '+' };
            figure.text(
                "ring",
                (x, y + 3.5),
                Anchor::Middle,
                &format!("{sign}{um} µm"),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::super::svg::text_width_px;
    use super::*;

    fn turn(deviation_um: impl Fn(f64) -> f64) -> Vec<Point> {
        let at = |i: u32| {
            let angle_rad = TAU * f64::from(i) / 20_000.0;
            let (sin, cos) = angle_rad.sin_cos();
            let on = |radius_m: f64| [radius_m * cos, radius_m * sin];
            Point {
                angle_rad,
                table_m: on(0.1 + 1.0e-6 * deviation_um(angle_rad)),
                motor_m: on(0.1),
                reference_m: on(0.1),
            }
        };
        (0..20_000).map(at).collect()
    }

    /// Places of a path.
    fn places(path: &str) -> Vec<(f64, f64)> {
        let mut at = (0.0, 0.0);
        let mut places = Vec::new();
        for step in path.trim_start_matches('M').split('l') {
            let (x, y) = step.split_once(' ').unwrap();
            at = (
                at.0 + x.parse::<f64>().unwrap(),
                at.1 + y.parse::<f64>().unwrap(),
            );
            places.push(at);
        }
        places
    }

    /// The claim of a certificate: what is drawn is what was measured.
    #[test]
    fn the_path_of_a_picture_is_the_deviation_within_five_hundredths_of_a_micrometre() {
        let shape =
            |angle: f64| 4.0 * (3.0 * angle).sin() + 9.0 * (-(angle - 2.0).powi(2) / 1.0e-3).exp();
        let points = turn(shape);
        let trace = Trace {
            name: "drawn".into(),
            ink: Ink::After,
            is_dashed: false,
            points: &points,
            radius_m: 0.1,
        };
        let svg = polar(&Polar {
            title: "",
            axes: ["X", "Y"],
            traces: &[trace],
            bursts: Default::default(),
            zone: None,
        });
        let path = svg
            .split("class=\"curve after solid\" d=\"")
            .nth(2)
            .unwrap();
        let places = places(path.split('"').next().unwrap());
        let middle = (0.5 * WIDTH_PX, LEGEND_LINE_PX + ABOVE_PX + 10.0);
        // Four rings of 2 µm.
        let um_per_px = 8.0 / BAND_PX;
        for pair in places.windows(2) {
            // Between two places a straight line is drawn.
            let at = (0.5 * (pair[0].0 + pair[1].0), 0.5 * (pair[0].1 + pair[1].1));
            for (x, y) in [pair[0], at] {
                let (x, y) = (x - middle.0, middle.1 - y);
                let drawn_um = um_per_px * (x.hypot(y) - NOMINAL_PX);
                let error_um = drawn_um - shape(y.atan2(x).rem_euclid(TAU));
                assert!(error_um.abs() < 0.05, "{error_um} at {x} {y}");
            }
        }
        assert!(places.len() < 3000, "{}", places.len());
    }

    #[test]
    fn a_burst_before_and_after_fits_beside_the_circle() {
        let out = NOMINAL_PX + BAND_PX + 16.0;
        let width = text_width_px("33.80 → 0.33 µm", 12.0);
        assert!(0.5 * WIDTH_PX - out > width, "{width}");
    }
}
