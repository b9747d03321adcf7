//! Circles as people know them from a ballbar: both directions, before and after on one scale.

use super::plots::{Ink, Polar, Trace, Zone, polar};
use crate::ballbar::zone_m;
use crate::circle_test::CircleRun;

/// A circle and what it is called.
pub struct Shown<'a> {
    /// Its name; empty where it is the only one.
    pub name: &'a str,
    /// Its colour.
    pub ink: Ink,
    /// That of its clockwise turn, which is dashed where it is the same.
    pub clockwise: Ink,
    /// The circle.
    pub run: &'a CircleRun,
}

/// Circles over each other; the spike at each reversal, the larger of both directions, stands
/// beside it.
#[must_use]
pub fn circles(
    title: &str,
    axes: [&str; 2],
    list: &[Shown<'_>],
    tolerance_um: Option<f64>,
) -> String {
    let traces: Vec<Trace<'_>> = list.iter().flat_map(both_directions).collect();
    let burst = |place: usize| {
        let each = list.iter().map(|shown| shown.run.report.spikes_um[place]);
        let words: Vec<String> = each.map(|um| format!("{um:.2}")).collect();
        format!("{} µm", words.join(" → "))
    };
    polar(&Polar {
        title,
        axes,
        traces: &traces,
        bursts: [0, 1, 2, 3].map(burst),
        zone: tolerance_um.and_then(|tolerance_um| zone(list, tolerance_um)),
    })
}

/// The zone about the last circle: G is a width, wherever it lies.
fn zone(list: &[Shown<'_>], tolerance_um: f64) -> Option<Zone> {
    let run = list.last()?.run;
    let (center_m, radius_m) = zone_m(&[&run.points[..], &run.clockwise].concat())?;
    Some(Zone {
        width_um: tolerance_um,
        middle_um: 1.0e6 * (radius_m - 1.0e-3 * run.report.radius_mm),
        center_um: center_m.map(|own| 1.0e6 * own),
    })
}

fn both_directions<'a>(shown: &Shown<'a>) -> [Trace<'a>; 2] {
    let radius_m = 1.0e-3 * shown.run.report.radius_mm;
    let trace = |direction: &str, points, ink, is_dashed| Trace {
        name: format!("{} {direction}", shown.name).trim().to_owned(),
        ink,
        is_dashed,
        points,
        radius_m,
    };
    [
        trace("counter-clockwise", shown.run.one_turn(), shown.ink, false),
        trace(
            "clockwise",
            &shown.run.clockwise,
            shown.clockwise,
            shown.clockwise == shown.ink,
        ),
    ]
}
