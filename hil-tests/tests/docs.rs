//! Documents that are made from tables stay what the tables say. `QUADRANT_BLESS=1` rewrites them.

use std::path::Path;

use hil_tests::confusion::{self, Counts};
use protocol::cob::AxisIds;
use protocol::table::{FRAMES, Rate};

/// How the frames follow each other, written by hand.
const CYCLE: &str = include_str!("docs/cycle.md");

fn check(name: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../docs")
        .join(name);
    if std::env::var_os("QUADRANT_BLESS").is_some() {
        std::fs::write(&path, text).unwrap();
    }
    let there = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        there == text,
        "docs/{name} is not what its table says (QUADRANT_BLESS=1 rewrites it)"
    );
}

#[test]
fn the_list_of_objects_is_the_table_of_the_drive() {
    let text = [
        OBJECTS_HEAD.to_owned(),
        parameter_rows(),
        reading_rows(),
        reason_rows(),
    ]
    .concat();
    check("objects.md", &text);
}

const OBJECTS_HEAD: &str = "# Objects of the drive\n\n\
    Made from `firmware/servo/src/objects.rs` by `QUADRANT_BLESS=1 cargo test -p hil-tests --test docs`.\n\n\
    ## Parameters\n\n\
    A parameter is an INTEGER32 that counts steps of a physical unit: 5 m/s² in steps of 1 um/s^2 are 5000000. All of them are read and written \
    with four bytes. A write is checked against its range before it is acknowledged, and staged. Writing \"cmit\" (0x74696D63) to 2F00h:0 turns \
    the staged set into machine units of its own cycle time (1006h) and makes it active as a whole. A commit is refused with 0604 0043h where \
    the values do not go together or do not fit the machine units at that cycle time. 2F02h:1 then gives the row of the parameter to look at \
    first, 2F02h:2 the reason. With torque on the axis, cycle time (1006h), position source (2100h:1), feed constant (6092h), encoder resolution \
    (608Fh) and the scale's offset (2103h:1) have to stay: 0800 0022h. A board converts a set beside its cycles, for about a millisecond, and \
    answers then; meanwhile the staged set stays as it is, and parameters and commits are refused with 0800 0022h. \
    2F01h chooses which set uploads read.\n\n\
    A row with \"choice\" takes the codes that its name lists, and no others. Torque is that of the motor, ways and velocities are those of \
    the table, inertia is motor torque per acceleration at the table: mass · lead / 2 pi.\n\n\
    The setpoint period (60C2h) is value · 10^exponent seconds, and 1 to 20 whole cycles. Q29 coefficients of the torque filter \
    are raw numbers for one cycle time, which 2120h:6 states.\n\n";

fn parameter_rows() -> String {
    let mut text = String::from(
        "| row | object | parameter | step | min | max | after reset |\n|---|---|---|---|---|---|---|\n",
    );
    for (place, entry) in servo::objects::TABLE.iter().enumerate() {
        let (index, subindex) = (entry.address.index, entry.address.subindex);
        text += &format!(
            "| {} | {index:04X}h:{subindex} | {} | {} | {} | {} | {} |\n",
            place + 1,
            entry.name(),
            entry.unit().text,
            entry.min,
            entry.max,
            entry.default()
        );
    }
    text
}

fn reading_rows() -> String {
    let mut rows = servo::objects::READINGS;
    rows.sort_unstable();
    let mut text = String::from("\n## What else can be read\n\n| object | value |\n|---|---|\n");
    for (address, name) in rows {
        text += &format!("| {:04X}h:{} | {name} |\n", address.index, address.subindex);
    }
    text
}

fn reason_rows() -> String {
    let mut text = String::from(
        "\n## Reasons of a refused commit (2F02h:2)\n\n| code | reason |\n|---|---|\n",
    );
    for (code, reason) in servo::parameters::SetError::REASONS {
        text += &format!("| {code} | {reason} |\n");
    }
    text
}

#[test]
fn the_list_of_frames_is_the_table_of_the_protocol() {
    let ids = AxisIds::of_axis(0).unwrap();
    let mut text = String::from(
        "# Frames\n\nWhat the nodes say (this table), and [when](#the-cycle). Made from `protocol/src/table.rs` and `hil-tests/tests/docs/cycle.md` by `QUADRANT_BLESS=1 cargo test -p hil-tests --test docs`; identifiers of the first axis \
         (servo 0x01, plant 0x11). `protocol/quadrant.dbc` is made from the same table.\n\n\
         | identifier | frame | sender | bytes | rate | signals (first bit, bits, weight) |\n|---|---|---|---|---|---|\n",
    );
    for frame in FRAMES {
        let rate = match frame.rate {
            Rate::EveryCycles(1) => "every cycle".to_owned(),
            Rate::EveryCycles(n) => format!("every {n} cycles"),
            Rate::OnEvent => "on event".to_owned(),
        };
        let signals: Vec<String> = frame
            .signals
            .iter()
            .map(|s| {
                format!(
                    "{} ({}, {}, {} {})",
                    s.name, s.start, s.length, s.weight, s.weight.unit
                )
            })
            .collect();
        let id = ids.identifier(frame.kind).as_raw();
        text += &format!(
            "| 0x{id:03X} | {} | {:?} | {} | {rate} | {} |\n",
            frame.name,
            frame.sender,
            frame.length,
            signals.join("; ")
        );
    }
    text += "\n";
    text += CYCLE;
    check("frames.md", &text);
}

/// A document without its line breaks, so that a sentence can be looked for.
fn prose(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path);
    let text = std::fs::read_to_string(path).unwrap();
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn the_counts_on_seeded_records_are_those_of_the_golden_table() {
    let Counts {
        records,
        exact,
        empty,
        false_alarms,
        ..
    } = Counts::of(&confusion::rows(&confusion::golden()));
    assert_eq!(false_alarms, 0, "the documents say that there is none");
    for (document, sentences) in [
        (
            "docs/identification.md",
            vec![
                format!("{records} records from our simulator"),
                format!("{exact} are named exactly. On the {empty} that hide nothing, nothing is"),
                "golden table `hil-tests/golden/identification.md`".to_owned(),
            ],
        ),
        (
            "README.md",
            vec![
                format!("On {records} seeded records with hidden effects it names {exact} exactly"),
                format!("nothing named on the {empty} that lack nothing"),
            ],
        ),
    ] {
        let text = prose(document);
        for sentence in sentences {
            assert!(
                text.contains(&sentence),
                "{document} does not say: {sentence}"
            );
        }
    }
}
