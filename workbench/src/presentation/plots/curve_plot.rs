//! Curves, clouds and bands over one axis.
//!
//! ```text
//! title
//! ▬ one   ▬ another        never on the data
//! ┌────────────────┐
//! │                │
//! └────────────────┘
//! ```

use super::curve::{Curve, Form};
use super::density::cells;
use super::scale::Scale;
use super::svg::{Anchor, Figure, path_through, text_width_px};
use super::thinning::by_columns;

const TITLE_PX: f64 = 15.0;
const LABEL_PX: f64 = 12.0;
const LEFT_PX: f64 = 66.0;
const RIGHT_PX: f64 = 16.0;
const BOTTOM_PX: f64 = 46.0;
const TITLE_LINE_PX: f64 = 19.0;
const LEGEND_LINE_PX: f64 = 18.0;
const SWATCH_PX: f64 = 22.0;
/// Between two ticks, px.
const TICK_X_PX: f64 = 80.0;
const TICK_Y_PX: f64 = 45.0;

/// A plot of curves over one axis.
#[derive(Clone, Copy, Debug)]
pub struct Plot<'a> {
    /// What it shows.
    pub title: &'a str,
    /// Name and unit of the axis to the right.
    pub x: &'a str,
    /// Name and unit of the axis upwards.
    pub y: &'a str,
    /// Width, and height with one line of title and one of names, px.
    pub size_px: (f64, f64),
    /// What of the axis is shown; all that the curves reach without it.
    pub x_range: Option<(f64, f64)>,
    /// Over the logarithm of x; all values are above zero then.
    pub is_logarithmic: bool,
}

impl<'a> Plot<'a> {
    /// A linear plot of all that its curves reach.
    #[must_use]
    pub const fn new(title: &'a str, x: &'a str, y: &'a str, size_px: (f64, f64)) -> Self {
        Self {
            title,
            x,
            y,
            size_px,
            x_range: None,
            is_logarithmic: false,
        }
    }
}

/// Draws curves, the first one lowest.
#[must_use]
pub fn curves(plot: &Plot<'_>, list: &[Curve]) -> String {
    let title = lines(plot.title, TITLE_PX, plot.size_px.0 - 20.0);
    let names = legend_places(list, plot.size_px.0 - LEFT_PX - RIGHT_PX);
    let legend_lines = names.last().map_or(0, |(line, _)| line + 1);
    let head_px = 10.0 + TITLE_LINE_PX * title.len() as f64 + LEGEND_LINE_PX * legend_lines as f64;
    let extra_px = head_px - 10.0 - TITLE_LINE_PX - LEGEND_LINE_PX;
    let size_px = (plot.size_px.0, plot.size_px.1 + extra_px.max(0.0));
    let (x, y) = scales(plot, list, size_px, head_px);
    let mut figure = Figure::new(size_px, plot.title, description(plot, list));
    for (line, text) in title.iter().enumerate() {
        let at = (10.0, TITLE_LINE_PX * (line + 1) as f64);
        figure.text("name", at, Anchor::Start, text);
    }
    legend(
        &mut figure,
        list,
        &names,
        10.0 + TITLE_LINE_PX * title.len() as f64,
    );
    let area = Area {
        x,
        y,
        size_px,
        head_px,
    };
    area.mesh(&mut figure, plot);
    for curve in list {
        area.draw(&mut figure, curve);
    }
    figure.finish()
}

fn description(plot: &Plot<'_>, list: &[Curve]) -> String {
    let names: Vec<&str> = list.iter().map(|curve| curve.name.as_str()).collect();
    format!("{} over {}: {}", plot.y, plot.x, names.join(", "))
}

/// A text in lines that are not wider than this.
pub(super) fn lines(text: &str, size_px: f64, width_px: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if text_width_px(&format!("{line} {word}"), size_px) <= width_px => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Line and place of each name; nothing where there is one curve alone without a name.
fn legend_places(list: &[Curve], width_px: f64) -> Vec<(usize, f64)> {
    let mut places = Vec::new();
    let (mut line, mut x) = (0, 0.0);
    for curve in list.iter().filter(|curve| !curve.name.is_empty()) {
        let wide = SWATCH_PX + 6.0 + text_width_px(&curve.name, LABEL_PX) + 14.0;
        if x > 0.0 && x + wide > width_px {
            (line, x) = (line + 1, 0.0);
        }
        places.push((line, x));
        x += wide;
    }
    places
}

fn legend(figure: &mut Figure, list: &[Curve], places: &[(usize, f64)], top_px: f64) {
    let named = list.iter().filter(|curve| !curve.name.is_empty());
    for (curve, (line, x)) in named.zip(places) {
        let (x, y) = (LEFT_PX + x, top_px + LEGEND_LINE_PX * (*line as f64 + 0.5));
        let class = curve.ink.class();
        match curve.form {
            Form::Line(_) => {
                figure.line(&format!("curve {class}"), (x, y), (x + SWATCH_PX, y));
            }
            Form::Cloud(_) => {
                figure.rectangle(&format!("cloud {class}"), (x, y - 4.0), (SWATCH_PX, 8.0));
            }
            Form::Band(_) => {
                figure.rectangle(&format!("band {class}"), (x, y - 5.0), (SWATCH_PX, 10.0));
            }
        }
        figure.text(
            "label",
            (x + SWATCH_PX + 6.0, y + 4.0),
            Anchor::Start,
            &curve.name,
        );
    }
}

/// The axes: what is shown of x, and all that the curves reach there.
fn scales(plot: &Plot<'_>, list: &[Curve], size_px: (f64, f64), head_px: f64) -> (Scale, Scale) {
    let reach: Vec<(f64, f64)> = list.iter().flat_map(Curve::reach).collect();
    let x_values = plot
        .x_range
        .unwrap_or_else(|| range(reach.iter().map(|(x, _)| *x), 0.0));
    let shown = reach
        .iter()
        .filter(|(x, _)| (x_values.0..=x_values.1).contains(x));
    let y_values = range(shown.map(|(_, y)| *y), 0.05);
    let x_places = (LEFT_PX, size_px.0 - RIGHT_PX);
    let x = if plot.is_logarithmic {
        Scale::logarithmic(x_values, x_places)
    } else {
        Scale::linear(x_values, x_places)
    };
    (
        x,
        Scale::linear(y_values, (size_px.1 - BOTTOM_PX, head_px + 4.0)),
    )
}

/// From the smallest to the largest value, and a share of the width more at both ends.
fn range(values: impl Iterator<Item = f64>, margin: f64) -> (f64, f64) {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
        (low.min(v), high.max(v))
    });
    if !(low.is_finite() && high.is_finite()) {
        return (0.0, 1.0);
    }
    // One value alone stands in the middle of its axis.
    let least = (1.0e-9 * high.abs().max(low.abs())).max(1.0e-12);
    if high - low < least {
        return (low - least, high + least);
    }
    let width = high - low;
    (low - margin * width, high + margin * width)
}

/// Where the data are.
struct Area {
    x: Scale,
    y: Scale,
    size_px: (f64, f64),
    head_px: f64,
}

impl Area {
    fn mesh(&self, figure: &mut Figure, plot: &Plot<'_>) {
        let (left, right) = (LEFT_PX, self.size_px.0 - RIGHT_PX);
        let (top, bottom) = (self.head_px + 4.0, self.size_px.1 - BOTTOM_PX);
        for (value, word) in self.y.ticks(((bottom - top) / TICK_Y_PX).max(2.0)) {
            let y = self.y.px(value);
            figure.line("grid", (left, y), (right, y));
            figure.text("tick", (left - 6.0, y + 4.0), Anchor::End, &word);
        }
        let mut free_from = f64::NEG_INFINITY;
        for (value, word) in self.x.ticks(((right - left) / TICK_X_PX).max(2.0)) {
            let x = self.x.px(value);
            figure.line("grid", (x, top), (x, bottom));
            let half = 0.5 * text_width_px(&word, 11.0);
            let end = x + half;
            // Words never touch each other, and never leave the picture.
            if x - half > free_from && end < self.size_px.0 {
                figure.text("tick", (x, bottom + 16.0), Anchor::Middle, &word);
                free_from = end + 4.0;
            }
        }
        figure.path("frame", &format!("M{left} {top}V{bottom}H{right}"), "");
        let middle = 0.5 * (left + right);
        figure.text("label", (middle, bottom + 36.0), Anchor::Middle, plot.x);
        figure.text_upwards("label", (14.0, 0.5 * (top + bottom)), plot.y);
    }

    /// Places of the points that are shown.
    fn places<'a>(&'a self, points: &'a [(f64, f64)]) -> impl Iterator<Item = (f64, f64)> + 'a {
        let shown = points
            .iter()
            .filter(|(x, y)| self.x.holds(*x) && y.is_finite());
        shown.map(|(x, y)| (self.x.px(*x), self.y.px(*y)))
    }

    fn draw(&self, figure: &mut Figure, curve: &Curve) {
        let class = curve.ink.class();
        match &curve.form {
            Form::Line(points) => {
                let path = path_through(by_columns(self.places(points)));
                figure.path(&format!("curve {class}"), &path, &curve.name);
            }
            Form::Cloud(points) => {
                let paths = cells(self.places(points));
                for (level, path) in paths.iter().enumerate() {
                    if !path.is_empty() {
                        let class = format!("cloud {class} thin{level}");
                        figure.path(&class, path, &curve.name);
                    }
                }
            }
            Form::Band(points) => {
                let edge = |which: usize| -> Vec<(f64, f64)> {
                    points.iter().map(|at| (at[0], at[which])).collect()
                };
                let (low, high) = (edge(1), edge(2));
                let back: Vec<_> = self.places(&high).collect();
                let around = self.places(&low).chain(back.into_iter().rev());
                figure.path(&format!("band {class}"), &path_through(around), &curve.name);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::curve::Ink;
    use super::*;

    fn plot(title: &str) -> Plot<'_> {
        Plot::new(title, "time, s", "N", (540.0, 300.0))
    }

    #[test]
    fn a_long_title_and_many_names_make_the_picture_higher_and_nothing_narrower() {
        let words = "word ".repeat(60);
        assert!(lines(&words, TITLE_PX, 520.0).len() > 3);
        for line in lines(&words, TITLE_PX, 520.0) {
            assert!(text_width_px(&line, TITLE_PX) <= 520.0, "{line}");
        }
        let named =
            |i: usize| Curve::line(&format!("a name of curve {i}"), Ink::Other(i), [(0.0, 1.0)]);
        let list: Vec<Curve> = (0..8).map(named).collect();
        let places = legend_places(&list, 460.0);
        assert_eq!(places.len(), 8);
        assert!(places.last().unwrap().0 >= 2);
        assert!(curves(&plot(&words), &list).contains("viewBox=\"0 0 540 "));
    }

    #[test]
    fn what_is_out_of_the_range_is_neither_drawn_nor_widens_the_axis_upwards() {
        let curve = Curve::line("", Ink::Before, [(0.0, 1.0), (1.0, 2.0), (9.0, 1000.0)]);
        let part = Plot {
            x_range: Some((0.0, 1.0)),
            ..plot("")
        };
        let svg = curves(&part, &[curve]);
        assert!(!svg.contains("1000") && svg.contains(">2</text>"), "{svg}");
    }

    /// A name on the data hides them.
    #[test]
    fn names_stand_above_the_data() {
        let named = |i: usize| {
            Curve::line(
                &format!("curve {i}"),
                Ink::Other(i),
                [(0.0, 1.0), (1.0, 2.0)],
            )
        };
        let list: Vec<Curve> = (0..9).map(named).collect();
        let svg = curves(&plot("title"), &list);
        let height = |text: &str| -> f64 {
            let (before, _) = svg.split_once(text).unwrap();
            let (_, y) = before.rsplit_once(" y=\"").unwrap();
            y.split('"').next().unwrap().parse().unwrap()
        };
        let (_, frame) = svg.split_once("class=\"frame\" d=\"M66 ").unwrap();
        let top: f64 = frame.split('V').next().unwrap().parse().unwrap();
        for curve in &list {
            assert!(
                height(&format!(">{}</text>", curve.name)) < top,
                "{}",
                curve.name
            );
        }
    }

    #[test]
    fn a_constant_in_encoder_counts_and_a_single_feed_are_drawn() {
        let constant = Curve::line("", Ink::Before, (0..100).map(|i| (f64::from(i), 1.0e9)));
        assert!(!curves(&plot("counts"), &[constant]).contains("NaN"));
        let single = Plot {
            is_logarithmic: true,
            ..plot("feed")
        };
        let svg = curves(&single, &[Curve::line("", Ink::Before, [(500.0, 1.0)])]);
        assert!(!svg.contains("NaN"), "{svg}");
    }

    #[test]
    fn nothing_to_draw_is_an_empty_mesh() {
        let empty = Curve::line("", Ink::Before, [(f64::NAN, 1.0)]);
        assert!(curves(&plot("empty"), &[empty]).contains("empty"));
    }
}
