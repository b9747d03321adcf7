//! Circles as people know them from a ballbar: both directions, before and after on one scale.

use super::plots::{Ink, Polar, Trace, polar};
use crate::circle_test::CircleRun;

/// A circle and what it is called.
pub struct Shown<'a> {
    /// Its name; empty where it is the only one.
    pub name: &'a str,
    /// Its colour.
    pub ink: Ink,
    /// The circle.
    pub run: &'a CircleRun,
}

/// Circles over each other; the largest burst of each reversal stands beside it.
#[must_use]
pub fn circles(
    title: &str,
    axes: [&str; 2],
    list: &[Shown<'_>],
    tolerance_um: Option<f64>,
) -> String {
    let traces: Vec<Trace<'_>> = list.iter().flat_map(both_directions).collect();
    let burst = |place: usize| {
        let each = list
            .iter()
            .map(|shown| shown.run.report.figures.peak_um[place]);
        let words: Vec<String> = each.map(|um| format!("{um:.2}")).collect();
        format!("{} µm", words.join(" → "))
    };
    polar(&Polar {
        title,
        axes,
        traces: &traces,
        bursts: [0, 1, 2, 3].map(burst),
        tolerance_um,
    })
}

fn both_directions<'a>(shown: &Shown<'a>) -> [Trace<'a>; 2] {
    let radius_m = 1.0e-3 * shown.run.report.radius_mm;
    let trace = |direction: &str, points, is_dashed| Trace {
        name: format!("{} {direction}", shown.name).trim().to_owned(),
        ink: shown.ink,
        is_dashed,
        points,
        radius_m,
    };
    [
        trace("counter-clockwise", shown.run.one_turn(), false),
        trace("clockwise", &shown.run.clockwise, true),
    ]
}
