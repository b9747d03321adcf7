//! `quadrant circle`: one reference circle and its figures.

use crate::circle_test::{self, CircleRun};
use crate::cli::{self, Method};
use crate::commands::asked_compensation::asked;
use crate::compensation;
use crate::console;
use crate::error::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::output_files::{json, write};
use crate::presentation::plots::{self, Trace};
use crate::session::Stand;
use crate::trajectory::Circle;
use crate::trajectory::circle_limits::check_circle;

/// Runs the circle, prints its figures and writes what was asked for.
///
/// # Errors
/// Where an argument, a file or the machine is wrong.
pub fn run(arguments: &cli::CircleArguments, interrupt: &Interrupt) -> Outcome<()> {
    let (machine, place) = arguments.machine.machine_and_place()?;
    let circle = cli::circle(arguments.radius_mm, arguments.feed_mm_min)?;
    check_circle(&machine, &circle)?;
    let stand = Stand {
        machine: &machine,
        place,
        interrupt: interrupt.clone(),
    };
    if arguments.self_tune > 0 && arguments.compensation.method != Method::Model {
        return Err(Failure::new(
            "--self-tune: needs --compensation model; drives refine a model of friction alone",
        ));
    }
    let turns = arguments.self_tune;
    let asked = asked(&arguments.compensation, &stand)?;
    let refining = compensation::self_tuning(&asked).filter(|_| turns > 0);
    let compensation = refining.unwrap_or(asked);
    let log = arguments.candump.as_deref();
    let run = circle_test::run_after(&stand, &circle, turns, &compensation, log)?;
    console::print_circle(&run.report);
    if let Some(path) = &arguments.json {
        write(path, &json(&run.report)?)?;
    }
    if let Some(path) = &arguments.plot {
        write(path, &plots::standalone(&plot(arguments, &run, &circle)?))?;
    }
    Ok(())
}

fn plot(arguments: &cli::CircleArguments, run: &CircleRun, circle: &Circle) -> Outcome<String> {
    let title = format!(
        "R {} mm, F {} mm/min",
        arguments.radius_mm, arguments.feed_mm_min
    );
    let trace = Trace {
        name: run.report.compensation.clone(),
        points: &run.points,
        radius_m: circle.radius_m,
    };
    plots::polar(&title, &[trace])
}
