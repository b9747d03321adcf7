//! Circles as tables: figures by ISO 230-4, and causes.

use identification::figures;

use super::result_tables::{TextTable, head};
use crate::ballbar::Cause;
use crate::circle_test::CircleReport;

/// What stands where a cause cannot be seen.
pub const NOT_MEASURED: &str = "not measured";

/// A length to a hundredth of a micrometre, which is what the figures of a circle mean.
fn um(value: f64) -> String {
    let text = format!("{value:.2}");
    match text.strip_prefix('-') {
        Some("0.00") => "0.00".into(),
        Some(size) => format!("−{size}"),
        None => text,
    }
}

/// The figures of a circle, before and after.
#[must_use]
pub fn circle_table(before: &CircleReport, after: &CircleReport) -> TextTable {
    let mut rows = vec![head(["ISO 230-4", "before, µm", "after, µm"])];
    let mut add = |name: &str, value: &dyn Fn(&CircleReport) -> String| {
        rows.push(vec![name.to_owned(), value(before), value(after)]);
    };
    add("largest burst", &|own| um(own.figures.peak_max_um));
    add("G of both directions", &|own| {
        um(own.roundness.circular_deviation_g_both_um)
    });
    add("G counter-clockwise, 3 turns", &|own| {
        um(own.figures.circular_deviation_g_um)
    });
    add("each of its turns", &turns);
    add("G clockwise", &|own| {
        um(own.roundness.circular_deviation_g_clockwise_um)
    });
    add("hysteresis H", &|own| {
        let own = own.figures.circular_hysteresis_h_um;
        own.map_or_else(|| NOT_MEASURED.into(), um)
    });
    add("radial deviation Fmax", &|own| {
        um(own.figures.radial_deviation_fmax_um)
    });
    add("radial deviation Fmin", &|own| {
        um(own.figures.radial_deviation_fmin_um)
    });
    rows
}

/// The scatter over the turns: smallest and largest.
fn turns(report: &CircleReport) -> String {
    let own = &report.roundness.circular_deviation_g_turns_um;
    let (low, high) = own
        .iter()
        .fold((f64::INFINITY, 0.0_f64), |(low, high), um| {
            (low.min(*um), high.max(*um))
        });
    format!("{} to {}", um(low), um(high))
}

/// The causes, the largest before first, with the same after and the value in which it is mended.
#[must_use]
pub fn cause_table(before: &[Cause], after: &[Cause]) -> TextTable {
    let mut rows = vec![head([
        "cause",
        "before, µm",
        "share, %",
        "after, µm",
        "share, %",
        "left after",
    ])];
    rows.extend(before.iter().map(|own| {
        let same = after.iter().find(|other| other.cause == own.cause);
        let same = same.unwrap_or(own);
        let size = |own: &Cause| own.um.map_or_else(|| NOT_MEASURED.to_owned(), um);
        vec![
            own.cause.clone(),
            size(own),
            share(own),
            size(same),
            share(same),
            value(same),
        ]
    }));
    rows
}

fn share(own: &Cause) -> String {
    let percent = own.share_percent;
    percent.map_or_else(|| "–".to_owned(), |percent| format!("{percent:.0}"))
}

/// Causes below this are noise of the figures, µm.
const NOTHING_UM: f64 = 0.05;

/// In the unit in which it is mended; nothing where there is nothing to mend.
fn value(own: &Cause) -> String {
    match (own.um, own.value) {
        (Some(um), Some(value)) if um >= NOTHING_UM => {
            format!("{} {}", figures::error(value), own.unit)
        }
        _ => "–".to_owned(),
    }
}
