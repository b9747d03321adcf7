//! The direction between the rooms of a crate: a room may use the rooms before it, not those after.

use super::sources::{Source, Sources};

/// The rooms of `identification`, from the record to the report. An error and a step of progress
/// may be told everywhere; `identify` is the list of steps and sees them all.
pub const IDENTIFICATION: [&str; 10] = [
    "error", "progress", "record", "motion", "model", "fit", "simulate", "evidence", "report",
    "identify",
];

/// The floors of `workbench`, from the ground up: `commands` use everything.
pub const WORKBENCH: [&str; 24] = [
    "error",
    "interrupt",
    "progress",
    "stdout",
    "output_files",
    "model_file",
    "compensation",
    "drive_parameters",
    "network",
    "drive_times",
    "trajectory",
    "ballbar",
    "session",
    "axis_records",
    "circle_test",
    "contour_test",
    "timing_test",
    "tuning",
    "presentation",
    "console",
    "commissioning",
    "cli",
    "commands",
    "main",
];

/// Room of a file: the first name of its module, or the crate's name for `lib.rs`.
fn room(file: &Source) -> &str {
    file.module.first().map_or("lib", |name| name)
}

/// Every use that goes from a room to a later one, and every room that the order does not know.
/// `lib.rs` and `main.rs` stand outside.
#[must_use]
pub fn against_the_order(sources: &Sources, order: &[&str]) -> Vec<String> {
    let place = |path: &str| {
        let file = sources.files.iter().find(|file| file.path == path)?;
        order.iter().position(|name| *name == room(file))
    };
    let unknown = sources.files.iter().map(room).filter(|room| {
        let is_outside = ["lib", "main"].contains(room);
        !is_outside && !order.contains(room)
    });
    let mut wrong: Vec<String> = unknown
        .map(|room| format!("unknown room: {room}"))
        .collect();
    wrong.dedup();
    let graph = sources.uses();
    let upwards = graph.edges().filter(|(from, to, _)| {
        let places = place(from).zip(place(to));
        places.is_some_and(|(from, to)| from < to)
    });
    wrong.extend(upwards.map(|(from, to, because)| format!("{from} -> {to} ({because})")));
    wrong
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_use_of_a_later_room_and_a_room_without_a_place_are_told() {
        let texts = [
            ("lib.rs", "mod fit; mod record; mod attic; use fit::Fit;"),
            ("record.rs", "pub mod csv; pub struct Row;"),
            ("record/csv.rs", "use crate::fit::Fit;"),
            ("fit.rs", "use crate::record::Row; pub struct Fit;"),
            ("attic.rs", ""),
        ];
        let texts = texts.map(|(path, text)| (path.to_owned(), text.to_owned()));
        let sources = Sources::parse("made_up", texts.into()).unwrap();
        assert_eq!(
            against_the_order(&sources, &["record", "fit"]),
            [
                "unknown room: attic",
                "record/csv.rs -> fit.rs (line 1: crate::fit::Fit)"
            ]
        );
    }
}
