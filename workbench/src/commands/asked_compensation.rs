//! The compensation that `circle` and `contour` are asked for.

use crate::cli::{CompensationArguments, Method};
use crate::compensation::{self, AxisCompensation, Compensation};
use crate::error::{Failure, Outcome};
use crate::session::Stand;
use crate::tuning::coulomb_force;

/// The method that was asked for, with the parameters that it needs.
///
/// # Errors
/// Where it lacks a file, or the file holds another method.
pub(super) fn asked(
    arguments: &CompensationArguments,
    stand: &Stand<'_>,
) -> Outcome<Vec<AxisCompensation>> {
    let file = arguments.compensation_file.as_deref();
    match (arguments.method, file) {
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
