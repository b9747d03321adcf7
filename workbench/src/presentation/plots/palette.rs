//! The colours of all pictures, on white and on black.
//!
//! No custom properties: programs that show an SVG file of its own do not know them. Curves differ
//! in lightness too, so that they stay apart in grey and for eyes that see fewer colours; those
//! beyond the first three are dashed as well.

use std::fmt::Write as _;

/// Classes without colours: letters, widths, dashes.
const SHAPES: &str = include_str!("plot.css");

/// What is coloured, on a light ground and on a dark one.
const COLOURS: [(Paint, &str, &str, &str); 15] = [
    (Paint::Fill, ".ground", "#fff", "#16181c"),
    (Paint::Fill, "text", "#222", "#e8e8e8"),
    (Paint::Fill, ".tick", "#555", "#b5b5b5"),
    (Paint::Fill, ".ring", "#555", "#b5b5b5"),
    (Paint::Stroke, ".ring", "#fff", "#16181c"),
    (Paint::Stroke, ".grid", "#ddd", "#3a3d44"),
    (Paint::Stroke, ".frame", "#777", "#999"),
    (Paint::Stroke, ".nominal", "#222", "#e8e8e8"),
    (Paint::Stroke, ".tolerance", "#b00020", "#ff7a8a"),
    (Paint::Both, ".before", "#e07b00", "#ffb14d"),
    (Paint::Both, ".after", "#0a4a8f", "#4a98f0"),
    (Paint::Both, ".recorded", "#9a9a9a", "#8a8a8a"),
    (Paint::Both, ".other3", "#7b2d86", "#d79be0"),
    (Paint::Both, ".other4", "#2a8f86", "#7fdccf"),
    (Paint::Both, ".other5", "#333", "#ddd"),
];

/// What of a shape is coloured.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Paint {
    /// Its inside.
    Fill,
    /// Its edge.
    Stroke,
    /// The edge of curves; the inside of clouds and bands.
    Both,
}

/// The style sheet of all pictures.
#[must_use]
pub fn style() -> String {
    let [light, dark] = [false, true].map(rules);
    format!("{SHAPES}{light}\n@media screen and (prefers-color-scheme:dark){{{dark}}}\n")
}

fn rules(is_dark: bool) -> String {
    let mut rules = String::new();
    for (paint, name, light, dark) in COLOURS {
        let colour = if is_dark { dark } else { light };
        let _ = match paint {
            Paint::Fill => write!(rules, ".plot {name}{{fill:{colour}}}"),
            Paint::Stroke => write!(rules, ".plot {name}{{stroke:{colour}}}"),
            Paint::Both => write!(
                rules,
                ".plot .curve{name}{{stroke:{colour}}}.plot .cloud{name},.plot .band{name}{{fill:{colour}}}"
            ),
        };
    }
    rules
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lightness L* of a colour by CIE 1976.
    fn lightness(colour: &str) -> f64 {
        let digits = &colour[1..];
        let channel = |i: usize| {
            let wide = digits.len() / 3;
            let text = &digits[i * wide..(i + 1) * wide];
            let value = f64::from(u8::from_str_radix(text, 16).unwrap());
            let share = if wide == 1 {
                value / 15.0
            } else {
                value / 255.0
            };
            if share <= 0.040_45 {
                share / 12.92
            } else {
                ((share + 0.055) / 1.055).powf(2.4)
            }
        };
        let y = 0.2126 * channel(0) + 0.7152 * channel(1) + 0.0722 * channel(2);
        116.0 * y.cbrt() - 16.0
    }

    fn colour(name: &str, is_dark: bool) -> &'static str {
        let row = COLOURS
            .iter()
            .find(|row| row.1 == name && row.0 != Paint::Stroke);
        let row = row.unwrap();
        if is_dark { row.3 } else { row.2 }
    }

    #[test]
    fn before_and_after_stay_apart_in_grey_and_from_their_ground() {
        for is_dark in [false, true] {
            let [before, after, ground] =
                [".before", ".after", ".ground"].map(|name| lightness(colour(name, is_dark)));
            assert!((before - after).abs() > 8.0, "{is_dark}: {before} {after}");
            for own in [before, after] {
                assert!((own - ground).abs() > 35.0, "{is_dark}: {own} on {ground}");
            }
        }
        let [before, after] = [".before", ".after"].map(|name| lightness(colour(name, false)));
        assert!((before - after).abs() > 25.0, "on paper: {before} {after}");
    }
}
