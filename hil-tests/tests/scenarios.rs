//! Most scenarios in one program: its threads always have something to do, and nothing is linked
//! thirty times. `cargo test -p hil-tests --test brought` still runs one file: `Cargo.toml` keeps
//! each as a target that is run when it is asked for.
//!
//! `emulated`, `silence` and `vcan` stand apart, because they run their own program again for what
//! it ignores where there is no vcan; `report_layout`, because all of it needs a browser;
//! `passed_over`, because a clock of 1 ms has to have a core.

#[path = "adaptive.rs"]
mod adaptive;
#[path = "architecture.rs"]
mod architecture;
#[path = "board.rs"]
mod board;
#[path = "board_contract.rs"]
mod board_contract;
#[path = "brought.rs"]
mod brought;
#[path = "circle_causes.rs"]
mod circle_causes;
#[path = "coarse_setpoints.rs"]
mod coarse_setpoints;
#[path = "commission.rs"]
mod commission;
#[path = "consistent_report.rs"]
mod consistent_report;
#[path = "dead_nodes.rs"]
mod dead_nodes;
#[path = "docs.rs"]
mod docs;
#[path = "drawn.rs"]
mod drawn;
#[path = "friction_model.rs"]
mod friction_model;
#[path = "gap_and_compliance.rs"]
mod gap_and_compliance;
#[path = "gap_from_the_motor.rs"]
mod gap_from_the_motor;
#[path = "identification.rs"]
mod identification;
#[path = "load_friction.rs"]
mod load_friction;
#[path = "makes.rs"]
mod makes;
#[path = "many_effects.rs"]
mod many_effects;
#[path = "mounting.rs"]
mod mounting;
#[path = "paper.rs"]
mod paper;
#[path = "pointers.rs"]
mod pointers;
#[path = "properties.rs"]
mod properties;
#[path = "reference_machine.rs"]
mod reference_machine;
#[path = "reference_timing.rs"]
mod reference_timing;
#[path = "refusals.rs"]
mod refusals;
#[path = "standstill.rs"]
mod standstill;
#[path = "undeclared.rs"]
mod undeclared;
#[path = "vertical.rs"]
mod vertical;
#[path = "worked_example.rs"]
mod worked_example;
