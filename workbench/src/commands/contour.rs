//! `quadrant contour`: one contour of dense points and how far from it the table was.

use crate::cli;
use crate::commands::asked_compensation::asked;
use crate::console;
use crate::contour_test;
use crate::error::Outcome;
use crate::interrupt::Interrupt;
use crate::output_files::{self, json, write};
use crate::session::Stand;
use crate::trajectory::Contour;

/// Runs the contour, prints its figures and writes what was asked for.
///
/// # Errors
/// Where an argument, a file or the machine is wrong.
pub fn run(arguments: &cli::ContourArguments, interrupt: &Interrupt) -> Outcome<()> {
    let (machine, place) = arguments.machine.machine_and_place()?;
    output_files::check([&arguments.json, &arguments.candump].map(Option::as_ref))?;
    let contour = Contour::read(&arguments.points, cli::feed(arguments.feed_mm_min)?)?;
    let stand = Stand {
        machine: &machine,
        place,
        interrupt: interrupt.clone(),
    };
    contour_test::check(&machine, &contour)?;
    let compensation = asked(&arguments.compensation, &stand)?;
    let log = arguments.candump.as_deref();
    let report = contour_test::run(&stand, &contour, &compensation, log)?;
    console::print_contour(&report);
    if let Some(path) = &arguments.json {
        write(path, &json(&report)?)?;
    }
    Ok(())
}
