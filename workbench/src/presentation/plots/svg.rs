//! An SVG in the making: elements at hundredths of a pixel, colours by class, words for those who
//! do not see it.
//!
//! Colours and letters are those of the palette: a page has them once, a file of its own has them
//! inside ([`standalone`]).

use std::fmt::Write as _;

use maud::{Markup, PreEscaped, html};

use super::palette::style;

/// Width of a letter over its height: of the widest sans-serif in use.
const LETTER: f64 = 0.62;

/// How wide a text will be at most, px.
pub(super) fn text_width_px(text: &str, size_px: f64) -> f64 {
    LETTER * size_px * text.chars().count() as f64
}

/// Which end of a text stands at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    /// The begin.
    Start,
    /// The middle.
    Middle,
    /// The end.
    End,
}

impl Anchor {
    const fn word(self) -> &'static str {
        match self {
            Self::Start => "start",
            Self::Middle => "middle",
            Self::End => "end",
        }
    }
}

/// A coordinate to a hundredth of a pixel.
pub(super) fn px(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".into()
    } else {
        text.into()
    }
}

/// The `d` of a polyline; steps between rounded places, so that nothing adds up.
pub(super) fn path_through(points: impl IntoIterator<Item = (f64, f64)>) -> String {
    let mut path = String::new();
    let mut last: Option<[f64; 2]> = None;
    for (x, y) in points {
        let place = [x, y].map(|value| (100.0 * value).round() / 100.0);
        let _ = match last {
            None => write!(path, "M{} {}", px(place[0]), px(place[1])),
            Some([x, y]) => write!(path, "l{} {}", px(place[0] - x), px(place[1] - y)),
        };
        last = Some(place);
    }
    path
}

/// A picture in the making.
pub(super) struct Figure {
    size_px: (f64, f64),
    title: String,
    description: String,
    body: String,
}

impl Figure {
    /// An empty picture; `description` is what it shows, in words.
    pub(super) fn new(size_px: (f64, f64), title: &str, description: String) -> Self {
        Self {
            size_px,
            title: title.to_owned(),
            description,
            body: String::new(),
        }
    }

    /// A path; `tip` shows where the pointer rests on it.
    pub(super) fn path(&mut self, class: &str, path: &str, tip: &str) {
        self.add(&html! {
            path class=(class) d=(path) { @if !tip.is_empty() { title { (tip) } } }
        });
    }

    /// A straight line.
    pub(super) fn line(&mut self, class: &str, from: (f64, f64), to: (f64, f64)) {
        self.path(class, &path_through([from, to]), "");
    }

    /// A circle.
    pub(super) fn circle(&mut self, class: &str, at: (f64, f64), radius: f64) {
        self.add(&html! {
            circle class=(class) cx=(px(at.0)) cy=(px(at.1)) r=(px(radius)) {}
        });
    }

    /// A rectangle from its upper left corner.
    pub(super) fn rectangle(&mut self, class: &str, at: (f64, f64), size: (f64, f64)) {
        self.add(&html! {
            rect class=(class) x=(px(at.0)) y=(px(at.1)) width=(px(size.0)) height=(px(size.1)) {}
        });
    }

    /// A text on its base line.
    pub(super) fn text(&mut self, class: &str, at: (f64, f64), anchor: Anchor, text: &str) {
        self.add(&html! {
            text class=(class) x=(px(at.0)) y=(px(at.1)) text-anchor=(anchor.word()) { (text) }
        });
    }

    /// A text upwards about its middle.
    pub(super) fn text_upwards(&mut self, class: &str, at: (f64, f64), text: &str) {
        let turned = format!("rotate(-90 {} {})", px(at.0), px(at.1));
        self.add(&html! {
            text class=(class) x=(px(at.0)) y=(px(at.1)) text-anchor="middle" transform=(turned) { (text) }
        });
    }

    fn add(&mut self, element: &Markup) {
        self.body.push_str(&element.0);
    }

    /// The SVG element: as wide as the page lets it be.
    pub(super) fn finish(self) -> String {
        let (width, height) = self.size_px;
        let label = format!("{}. {}", self.title, self.description);
        html! {
            svg xmlns="http://www.w3.org/2000/svg" class="plot" role="img" aria-label=(label)
                viewBox={ "0 0 " (px(width)) " " (px(height)) }
                style={ "max-width:" (px(width)) "px" } {
                title { (self.title) }
                desc { (self.description) }
                rect class="ground" width=(px(width)) height=(px(height)) {}
                (PreEscaped(self.body))
            }
        }
        .into_string()
    }
}

/// The text of an SVG file of its own.
#[must_use]
pub fn standalone(svg: &str) -> String {
    let with_style = svg.replacen("<title>", &format!("<style>{}</style><title>", style()), 1);
    format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{with_style}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_never_adds_up_along_a_path() {
        let path = path_through((0..1000).map(|i| (f64::from(i) / 3.0, 0.0)));
        let steps = path.split('l').skip(1);
        let end: f64 = steps
            .map(|step| step.split(' ').next().unwrap().parse::<f64>().unwrap())
            .sum();
        assert!((end - 333.0).abs() < 0.01, "{end}");
    }

    #[test]
    fn a_coordinate_has_hundredths_and_no_zeros_that_say_nothing() {
        for (value, text) in [
            (1.0, "1"),
            (-0.001, "0"),
            (2.345_67, "2.35"),
            (-1.5, "-1.5"),
        ] {
            assert_eq!(px(value), text);
        }
    }

    #[test]
    fn text_cannot_break_a_picture_and_a_file_has_its_colours_inside() {
        let mut figure = Figure::new((10.0, 10.0), "a < b", "c & d".into());
        figure.text("tick", (1.0, 2.0), Anchor::Middle, "<script>");
        let text = standalone(&figure.finish());
        assert!(text.contains("<title>a &lt; b</title><desc>c &amp; d</desc>"));
        assert!(text.contains(">&lt;script&gt;</text>"), "{text}");
        assert!(text.contains("<style>") && text.starts_with("<?xml"));
    }
}
