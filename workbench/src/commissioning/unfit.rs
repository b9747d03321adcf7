//! The report of a machine that is not fit to be compensated: what it does by itself, and what to
//! change first.

use std::path::Path;

use plant_sim::Machine;
use serde::Serialize;

use super::fitness::Oscillation;
use super::program::{now, program};
use crate::error::Outcome;
use crate::output_files::{json, write};
use crate::presentation::page::Page;
use crate::presentation::result_tables::{TextTable, head};

/// `summary.json` of such a machine.
#[derive(Serialize)]
struct Summary<'a> {
    machine: &'a str,
    date: String,
    program: String,
    simulation: bool,
    verdict: &'static str,
    oscillations: &'a [Oscillation],
}

/// Writes `summary.json` and `report.html`.
///
/// # Errors
/// Where a file cannot be written.
pub fn report(
    machine: &Machine,
    oscillations: &[Oscillation],
    is_simulation: bool,
    out: &Path,
) -> Outcome<()> {
    let summary = Summary {
        machine: &machine.name,
        date: now(),
        program: program(),
        simulation: is_simulation,
        verdict: "unfit",
        oscillations,
    };
    write(&out.join("summary.json"), &json(&summary)?)?;
    write(
        &out.join("report.html"),
        &page(machine, oscillations, is_simulation),
    )
}

fn page(machine: &Machine, oscillations: &[Oscillation], is_simulation: bool) -> String {
    let mut page = Page::new(&format!("Machine {} is not commissioned", machine.name));
    if is_simulation {
        page.simulation();
    }
    page.paragraph(&format!("{}; {}.", now(), program()));
    for oscillation in oscillations {
        page.key(&oscillation.sentence());
    }
    page.table(&table(oscillations));
    let seen = if oscillations.iter().any(|own| own.on_record) {
        "The axes were enabled without any compensation, stood for a second, ran through the middle of their travel at two speeds and crept, without an oscillation of 5 µm or more that lasts. Where they move \
         as the records do, they have one: a load that shakes between the flanks of a gap does so, and a loop near the edge of its stability. The records lie beside this page. Nothing was tuned or downloaded"
    } else {
        "The axes were enabled without any compensation, stood for a second and ran through the middle of their travel at two speeds, and from rest to slow ones. An oscillation that lasts is the loop's \
         own where the axis stands, or where its frequency is the same at both speeds. Nothing was recorded, tuned or downloaded"
    };
    page.paragraph(&format!(
        "{seen}: friction that is identified while a loop oscillates is wrong, and a compensation tuned on it makes circles worse."
    ));
    page.finish()
}

fn table(oscillations: &[Oscillation]) -> TextTable {
    let mut rows = vec![head([
        "axis",
        "frequency, Hz",
        "amplitude, µm",
        "seen",
        "force at its limit",
    ])];
    rows.extend(oscillations.iter().map(|own| {
        let limit = match own.at_force_limit {
            _ if own.on_record => "–",
            true => "yes",
            false => "no",
        };
        vec![
            own.axis.clone(),
            format!("{:.1}", own.frequency_hz),
            format!("{:.1}", own.amplitude_um),
            own.place(),
            limit.to_owned(),
        ]
    }));
    rows
}
