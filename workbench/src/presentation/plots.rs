//! The pictures people know, as SVG text.

mod canvas;
mod curve_plot;
mod polar_plot;

pub use curve_plot::{Curve, curves};
pub use polar_plot::{Trace, polar};

/// The text of an SVG file of its own.
#[must_use]
pub fn standalone(svg: &str) -> String {
    svg.replacen(
        "<svg",
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg",
        1,
    )
}
