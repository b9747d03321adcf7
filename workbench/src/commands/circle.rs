//! `quadrant circle`: one reference circle and its figures.

use crate::circle_test::{self, CircleRun};
use crate::cli::{self, Method};
use crate::commands::asked_compensation::asked;
use crate::compensation;
use crate::console;
use crate::error::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::output_files::{self, json, write};
use crate::presentation::circle_pictures::{Shown, circles};
use crate::presentation::plots::{Ink, standalone};
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
    output_files::check(
        [&arguments.json, &arguments.plot, &arguments.candump].map(Option::as_ref),
    )?;
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
    if turns > 0 {
        check_circle(&machine, &Circle { turns, ..circle })
            .map_err(|failure| Failure::new(format!("--self-tune {turns}: {failure}")))?;
    }
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
        write(path, &standalone(&plot(&stand, &run)))?;
    }
    Ok(())
}

fn plot(stand: &Stand<'_>, run: &CircleRun) -> String {
    let report = &run.report;
    let title = format!(
        "Circle R {} mm, F {} mm/min, compensation {}",
        report.radius_mm, report.feed_mm_min, report.compensation
    );
    let axes = &stand.machine.axes;
    let shown = Shown {
        name: "",
        ink: Ink::After,
        clockwise: Ink::After,
        run,
    };
    circles(&title, [&axes[0].name, &axes[1].name], &[shown], None)
}
