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
    let mut rows = vec![head(["figure", "before, µm", "after, µm"])];
    let mut add = |name: &str, value: &dyn Fn(&CircleReport) -> String| {
        rows.push(vec![name.to_owned(), value(before), value(after)]);
    };
    add("G, both directions", &|own| {
        um(own.roundness.circular_deviation_g_both_um)
    });
    add("G, counter-clockwise", &|own| {
        um(own.figures.circular_deviation_g_um)
    });
    add("turn by turn, from–to", &turns);
    add("G, clockwise", &|own| {
        um(own.roundness.circular_deviation_g_clockwise_um)
    });
    add("H", &|own| {
        let own = own.figures.circular_hysteresis_h_um;
        own.map_or_else(|| NOT_MEASURED.into(), um)
    });
    add("Fmax, counter-clockwise", &|own| {
        um(own.figures.radial_deviation_fmax_um)
    });
    add("Fmin, counter-clockwise", &|own| {
        um(own.figures.radial_deviation_fmin_um)
    });
    add("largest reversal spike", &|own| um(own.spike_um()));
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
    format!("{}–{}", um(low), um(high))
}

/// The causes, the largest before first, with the same after and the value in which it is mended;
/// those that cost nothing stand in one row.
#[must_use]
pub fn cause_table(before: &[Cause], after: &[Cause]) -> TextTable {
    let mut rows = vec![head([
        "cause",
        "before, µm",
        "sum, %",
        "after, µm",
        "sum, %",
        "left to mend",
    ])];
    let of = |name: &str| after.iter().find(|own| own.cause == name);
    let costs = |own: &Cause| own.um.is_none_or(|um| um.is_nan() || um >= NOTHING_UM);
    let is_told = |own: &&Cause| costs(own) || of(&own.cause).is_some_and(costs);
    rows.extend(before.iter().filter(is_told).map(|own| {
        let same = of(&own.cause);
        let or = |text: Option<String>| text.unwrap_or_else(|| "–".to_owned());
        vec![
            own.cause.clone(),
            size(own),
            share(own),
            or(same.map(size)),
            or(same.map(share)),
            or(same.map(value)),
        ]
    }));
    let nothing = before.iter().filter(|own| !is_told(own));
    let nothing: Vec<&str> = nothing.map(|own| own.cause.as_str()).collect();
    if !nothing.is_empty() {
        let mut row = vec![nothing.join(", ")];
        let little = format!("<\u{a0}{NOTHING_UM}");
        row.extend([little.as_str(), "", little.as_str(), "", "–"].map(String::from));
        rows.push(row);
    }
    rows
}

fn size(own: &Cause) -> String {
    own.um.map_or_else(|| NOT_MEASURED.to_owned(), um)
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
            format!("{}\u{a0}{}", figures::error(value), own.unit)
        }
        _ => "–".to_owned(),
    }
}
