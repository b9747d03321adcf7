//! Which circles a machine can run: two axes, within their travel, velocity and acceleration.

use plant_sim::Machine;
use plant_sim::machine::{Limits, MachineAxis};

use super::Circle;
use crate::error::{Failure, Outcome};

/// The circle of commissioning: R 100 mm, F 2000 mm/min.
const USUAL: Circle = Circle {
    radius_m: 0.1,
    feed_m_per_s: 2.0 / 60.0,
    turns: 3,
    counter_clockwise: true,
};
/// What a circle that is made to fit uses of the shortest travel.
const TRAVEL_SHARE: f64 = 0.8;
/// What it uses of the velocity and of the acceleration.
const MOTION_SHARE: f64 = 0.5;

/// The smallest limits of the axes of a machine: what all of them can do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slowest {
    /// Way to either side, m.
    pub travel_m: f64,
    /// Velocity, m/s.
    pub velocity_m_per_s: f64,
    /// Acceleration, m/s².
    pub acceleration_m_per_s2: f64,
}

impl Slowest {
    /// Of the axes of a machine.
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        let least = |limit: fn(&Limits) -> f64| {
            let of_axes = machine.axes.iter().map(|axis| limit(&axis.limits));
            of_axes.fold(f64::INFINITY, f64::min)
        };
        Self {
            travel_m: least(|limits| limits.travel_m),
            velocity_m_per_s: least(|limits| limits.velocity_m_per_s),
            acceleration_m_per_s2: least(|limits| limits.acceleration_m_per_s2),
        }
    }
}

/// The same circle at a share of its feed; `None` where the machine cannot run it.
#[must_use]
pub fn at_share_of_feed(machine: &Machine, circle: &Circle, share: f64) -> Option<Circle> {
    let other = Circle {
        feed_m_per_s: share * circle.feed_m_per_s,
        ..*circle
    };
    check_circle(machine, &other).is_ok().then_some(other)
}

/// The usual circle, or a smaller and slower one where the axes are short or slow.
#[must_use]
pub fn fitting_circle(machine: &Machine) -> Circle {
    let slowest = Slowest::of(machine);
    let radius_m = USUAL.radius_m.min(TRAVEL_SHARE * slowest.travel_m);
    let feed_m_per_s = USUAL
        .feed_m_per_s
        .min(MOTION_SHARE * slowest.velocity_m_per_s)
        .min((MOTION_SHARE * slowest.acceleration_m_per_s2 * radius_m).sqrt());
    Circle {
        radius_m,
        feed_m_per_s,
        ..USUAL
    }
}

/// The axes that move in a plane.
///
/// # Errors
/// Where the machine has fewer, with what needs them.
pub fn two_axes<'a>(machine: &'a Machine, what: &str) -> Outcome<[&'a MachineAxis; 2]> {
    match &machine.axes[..] {
        [x, y, ..] => Ok([x, y]),
        fewer => Err(Failure::new(format!(
            "machine {}: {what} needs two axes, this machine has {}",
            machine.name,
            fewer.len()
        ))),
    }
}

/// Longer is a mistake in the feed.
pub const LONGEST_H: f64 = 2.0;

/// Refuses a circle that the machine cannot run.
///
/// # Errors
/// What does not fit, and the limit.
pub fn check_circle(machine: &Machine, circle: &Circle) -> Outcome<()> {
    let [x, y] = two_axes(machine, "a circle")?;
    let hours = circle.duration_s() / 3600.0;
    if hours > LONGEST_H {
        return Err(Failure::new(format!(
            "--feed-mm-min {}: a circle of R {} mm would take {hours:.1} h, more than {LONGEST_H}; a faster feed takes less",
            6.0e4 * circle.feed_m_per_s,
            1.0e3 * circle.radius_m
        )));
    }
    check_axis(x, circle)?;
    check_axis(y, circle)
}

fn check_axis(axis: &MachineAxis, circle: &Circle) -> Outcome<()> {
    let limits = &axis.limits;
    within(
        axis,
        "--radius-mm",
        (circle.radius_m * 1.0e3, limits.travel_m * 1.0e3),
        "mm of travel",
    )?;
    within(
        axis,
        "--feed-mm-min",
        (circle.feed_m_per_s * 6.0e4, limits.velocity_m_per_s * 6.0e4),
        "mm/min of velocity",
    )?;
    let acceleration_m_per_s2 = circle.feed_m_per_s * circle.feed_m_per_s / circle.radius_m;
    within(
        axis,
        "--feed-mm-min with --radius-mm",
        (acceleration_m_per_s2, limits.acceleration_m_per_s2),
        "m/s² of acceleration",
    )
}

fn within(
    axis: &MachineAxis,
    option: &str,
    (wanted, limit): (f64, f64),
    unit: &str,
) -> Outcome<()> {
    if wanted > limit {
        return Err(Failure::new(format!(
            "{option}: axis {} allows {limit} {unit}, the circle needs {wanted:.3}",
            axis.name
        )));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The reference machine with other limits on its second axis.
    fn limited(change: impl FnOnce(&mut Limits)) -> Machine {
        let mut machine = Machine::reference();
        change(&mut machine.axes[1].limits);
        machine
    }

    #[test]
    fn a_circle_that_takes_half_a_day_is_a_mistake_in_the_feed() {
        let slow = Circle {
            feed_m_per_s: 2.0 / 6.0e4,
            ..USUAL
        };
        let refusal = check_circle(&Machine::reference(), &slow).unwrap_err();
        let refusal = refusal.to_string();
        assert!(
            refusal.starts_with("--feed-mm-min 2: a circle of R 100 mm would take "),
            "{refusal}"
        );
    }

    #[test]
    fn the_usual_circle_is_run_wherever_it_fits() {
        assert_eq!(fitting_circle(&Machine::reference()), USUAL);
    }

    #[test]
    fn a_short_or_slow_axis_makes_the_circle_smaller_or_slower_until_it_fits() {
        let short = limited(|limits| limits.travel_m = 0.05);
        assert!((fitting_circle(&short).radius_m - 0.04).abs() < 1.0e-12);
        let slow = limited(|limits| limits.velocity_m_per_s = 0.02);
        assert!((fitting_circle(&slow).feed_m_per_s - 0.01).abs() < 1.0e-12);
        let weak = limited(|limits| limits.acceleration_m_per_s2 = 2.0e-3);
        assert!((fitting_circle(&weak).feed_m_per_s - 0.01).abs() < 1.0e-12);
        for machine in [short, slow, weak] {
            assert_eq!(check_circle(&machine, &fitting_circle(&machine)), Ok(()));
        }
    }

    #[test]
    fn a_circle_that_does_not_fit_is_refused_by_the_option_to_change() {
        for (machine, option) in [
            (
                limited(|limits| limits.travel_m = 0.05),
                "--radius-mm: axis Y",
            ),
            (
                limited(|limits| limits.velocity_m_per_s = 0.02),
                "--feed-mm-min: axis Y",
            ),
            (
                limited(|limits| limits.acceleration_m_per_s2 = 2.0e-3),
                "--feed-mm-min with --radius-mm: axis Y",
            ),
        ] {
            let refusal = check_circle(&machine, &USUAL).unwrap_err().to_string();
            assert!(refusal.starts_with(option), "{refusal}");
        }
    }
}
