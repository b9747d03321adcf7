//! `quadrant circle`: one reference circle and its figures.

use crate::circle_test::{self, CircleRun};
use crate::cli::{self, Method};
use crate::compensation::{self, AxisCompensation, Compensation};
use crate::console;
use crate::error::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::output_files::{json, write};
use crate::presentation::plots::{self, Trace};
use crate::session::Stand;
use crate::trajectory::Circle;
use crate::trajectory::circle_limits::check_circle;
use crate::tuning::coulomb_force;

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
    if arguments.self_tune > 0 && arguments.compensation != Method::Model {
        return Err(Failure::new(
            "--self-tune: needs --compensation model; drives refine a model of friction alone",
        ));
    }
    let turns = arguments.self_tune;
    let asked = compensation_of(arguments, &stand)?;
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

/// The method that was asked for, with the parameters that it needs.
fn compensation_of(
    arguments: &cli::CircleArguments,
    stand: &Stand<'_>,
) -> Outcome<Vec<AxisCompensation>> {
    let file = arguments.compensation_file.as_deref();
    match (arguments.compensation, file) {
        (Method::None, None) => Ok(stand.uncompensated()),
        (Method::None, Some(_)) => Err(Failure::new(
            "--compensation-file: needs --compensation pulse, adaptive, coulomb or model; without it the file would not be used",
        )),
        (Method::Coulomb, None) => coulomb_force::measured(stand),
        (Method::Pulse, None) => Err(lacks_file("pulse")),
        (Method::Adaptive, None) => Err(lacks_file("adaptive")),
        (Method::Model, None) => Err(lacks_file("model")),
        (method, Some(path)) => {
            let read = compensation::read(path, &stand.axis_names())?;
            if is_file_of(method, &read) {
                Ok(read)
            } else {
                Err(Failure::new(format!(
                    "{}: the file holds another method than --compensation asks for",
                    path.display()
                )))
            }
        }
    }
}

fn lacks_file(method: &str) -> Failure {
    Failure::new(format!(
        "--compensation {method}: needs --compensation-file; make one with `quadrant tune --method {method} --out FILE`"
    ))
}

/// An axis without a burst, or without friction, has none.
fn is_file_of(method: Method, axes: &[AxisCompensation]) -> bool {
    let is_none = |axis: &AxisCompensation| axis.reversal == Compensation::None;
    let fits = |axis: &AxisCompensation| is_none(axis) || is_of_method(method, axis);
    axes.iter().all(fits) && !axes.iter().all(is_none)
}

fn is_of_method(method: Method, compensation: &AxisCompensation) -> bool {
    matches!(
        (method, &compensation.reversal),
        (Method::Pulse, Compensation::Pulse(_))
            | (Method::Adaptive, Compensation::Adaptive(_))
            | (Method::Coulomb, Compensation::Coulomb { .. })
            | (Method::Model, Compensation::Model(_))
    )
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_serves_only_the_method_that_it_holds() {
        let coulomb = AxisCompensation {
            reversal: Compensation::Coulomb { force_n: 10.0 },
            backlash_m: 0.0,
        };
        assert!(is_of_method(Method::Coulomb, &coulomb));
        assert!(!is_of_method(Method::Pulse, &coulomb));
        let none = AxisCompensation::default();
        assert!(is_file_of(
            Method::Coulomb,
            &[none.clone(), coulomb.clone()]
        ));
        assert!(!is_file_of(Method::Pulse, &[none.clone(), coulomb]));
        assert!(!is_file_of(Method::Coulomb, &[none.clone(), none]));
    }
}
