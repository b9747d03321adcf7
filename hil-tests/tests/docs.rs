//! Documents that are made from tables stay what the tables say. `QUADRANT_BLESS=1` rewrites them.

use std::path::Path;

use protocol::cob::AxisIds;
use protocol::table::{FRAMES, Rate};

/// How the frames follow each other, written by hand.
const CYCLE: &str = include_str!("docs/cycle.md");

fn check(name: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs").join(name);
    if std::env::var_os("QUADRANT_BLESS").is_some() {
        std::fs::write(&path, text).unwrap();
    }
    let there = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(there == text, "docs/{name} is not what its table says (QUADRANT_BLESS=1 rewrites it)");
}

#[test]
fn the_list_of_objects_is_the_table_of_the_drive() {
    let mut text = String::from(
        "# Objects of the drive\n\nMade from `firmware/servo/src/objects.rs` by `QUADRANT_BLESS=1 cargo test -p hil-tests --test docs`.\n\n\
         Parameters are INTEGER32, read and write. A write is checked against its range before it is acknowledged and staged; writing \"cmit\" \
         (0x74696D63) to 2F00h makes the staged set active as a whole. Read only: 1000h device type, 1001h error register, 6041h status word, \
         6061h mode (8), 6064h position, 60F4h following error, 2200h:1-5 frames lost, stale, malformed, implausible, doubled.\n\n\
         | object | name | unit of the raw number | min | max | after reset |\n|---|---|---|---|---|---|\n",
    );
    for entry in &servo::objects::TABLE {
        let (index, subindex) = (entry.address.index, entry.address.subindex);
        text += &format!(
            "| {index:04X}h:{subindex} | {} | {} | {} | {} | {} |\n",
            entry.name, entry.unit, entry.min, entry.max, entry.default
        );
    }
    check("objects.md", &text);
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
            .map(|s| format!("{} ({}, {}, {} {})", s.name, s.start, s.length, s.weight, s.weight.unit))
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
