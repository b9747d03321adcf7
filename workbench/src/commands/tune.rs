//! `quadrant tune`: compensation parameters from circles or records, as at a real machine.

use crate::cli::{self, TuneMethod};
use crate::commissioning::identified_axes;
use crate::compensation;
use crate::console;
use crate::error::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::output_files::{self, make_folder, write};
use crate::say;
use crate::session::Stand;
use crate::trajectory::Circle;
use crate::trajectory::circle_limits::check_circle;
use crate::tuning::{self, Tuned};

/// Tunes, writes the compensation file and prints what was found.
///
/// # Errors
/// Where an argument or the machine is wrong.
pub fn run(arguments: &cli::Tune, interrupt: &Interrupt) -> Outcome<()> {
    let (machine, place) = arguments.machine.machine_and_place()?;
    let circle = cli::circle(arguments.radius_mm, arguments.feed_mm_min)?;
    check_circle(&machine, &circle)?;
    output_files::check([Some(&arguments.out)])?;
    let start_delay_s = start_delay_s(arguments.start_delay_ms)?;
    let stand = Stand {
        machine: &machine,
        place,
        interrupt: interrupt.clone(),
    };
    let tuned = match arguments.method {
        TuneMethod::Pulse => tuning::pulse(&stand, &circle, start_delay_s)?.ok_or_else(nothing)?,
        TuneMethod::Adaptive => tuning::adaptive(&stand, &circle)?.ok_or_else(nothing)?,
        TuneMethod::Model => model(&stand, &circle)?.ok_or_else(without_friction)?,
    };
    write(&arguments.out, &file(arguments, &stand, &tuned)?)?;
    console::print_tuned(&stand.axis_names(), &tuned);
    say!("wrote {}", arguments.out.display());
    Ok(())
}

fn nothing() -> Failure {
    Failure::new(
        "no axis has a burst to compensate on the tuning circles: nothing was tuned, and no file written",
    )
}

fn without_friction() -> Failure {
    Failure::new("no friction was identified on any axis: no model was made, and no file written")
}

/// Records the axes, identifies them and makes the model of what was found.
fn model(stand: &Stand<'_>, circle: &Circle) -> Outcome<Option<Tuned>> {
    let folder = std::env::temp_dir().join(format!("quadrant-tune-{}", std::process::id()));
    make_folder(&folder)?;
    let results = identified_axes::record(stand, &folder)
        .and_then(|()| identified_axes::identify(stand, &folder));
    // The folder is in the system's temporary directory: leaving it behind is untidy, not wrong.
    let _ = std::fs::remove_dir_all(&folder);
    tuning::model(stand, circle, &results?)
}

fn start_delay_s(start_delay_ms: f64) -> Outcome<f64> {
    if !(0.0..=1000.0).contains(&start_delay_ms) {
        return Err(Failure::new(format!(
            "--start-delay-ms: must be 0 to 1000 ms, got {start_delay_ms}"
        )));
    }
    Ok(1.0e-3 * start_delay_ms)
}

/// The compensation file, headed by the circle that it is good for.
fn file(arguments: &cli::Tune, stand: &Stand<'_>, tuned: &Tuned) -> Outcome<String> {
    let (radius, feed) = (arguments.radius_mm, arguments.feed_mm_min);
    let head = match arguments.method {
        TuneMethod::Pulse => format!(
            "# Tuned at R {radius} mm, F {feed} mm/min in {} circles: best there, and only there.\n",
            tuned.circles
        ),
        TuneMethod::Adaptive => format!(
            "# Tuned on circles of R 20 mm or less at up to {} accelerations, {} in all; burst at R {radius} mm, F {feed} mm/min {}.\n",
            compensation::POINTS,
            tuned.circles,
            fall(tuned)
        ),
        TuneMethod::Model => format!(
            "# From records of the axes, for every radius and feed; burst at R {radius} mm, F {feed} mm/min {}.\n",
            fall(tuned)
        ),
    };
    Ok(head + &compensation::text(&stand.axis_names(), &tuned.compensation)?)
}

/// The largest burst of both axes, before and after.
fn fall(tuned: &Tuned) -> String {
    let [before, after] = tuned.largest_um();
    format!("{before:.2} µm without, {after:.2} µm with it")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_start_delay_is_at_most_a_second_and_never_negative() {
        assert_eq!(start_delay_s(0.0), Ok(0.0));
        assert_eq!(start_delay_s(250.0), Ok(0.25));
        for wrong in [-1.0, 1000.1, f64::NAN] {
            assert!(start_delay_s(wrong).is_err(), "{wrong}");
        }
    }
}
