//! The pictures people know, as SVG text.

mod curve;
mod curve_plot;
mod density;
mod palette;
mod polar_plot;
mod scale;
mod svg;
mod thinning;

pub use curve::{Curve, Ink};
pub use curve_plot::{Plot, curves};
pub use palette::style;
pub use polar_plot::{Polar, Trace, Zone, polar};
pub use svg::standalone;
