//! A contour over the bus, and how far from it the table was.

use std::path::Path;

use plant_sim::Machine;
use plant_sim::machine::MachineAxis;
use serde::Serialize;

use crate::compensation::{self, AxisCompensation};
use crate::error::{Failure, Outcome};
use crate::network::master::AxisCycle;
use crate::progress;
use crate::session::{Session, Stand, table_m};
use crate::trajectory::circle_limits::{LONGEST_H, two_axes};
use crate::trajectory::{Contour, Place};

/// What `contour --json` says.
#[derive(Clone, Debug, Serialize)]
pub struct ContourReport {
    /// Machine.
    pub machine: String,
    /// Feed.
    pub feed_mm_min: f64,
    /// Length of the contour.
    pub length_mm: f64,
    /// How often each axis turns round on it.
    pub reversals: [u32; 2],
    /// Compensation method.
    pub compensation: String,
    /// What saw the error: an instrument at the table, or the load scale.
    pub error_of: &'static str,
    /// Largest distance of the table from the contour.
    pub largest_um: f64,
    /// Where that was.
    pub largest_at_mm: [f64; 2],
    /// Its root mean square.
    pub rms_um: f64,
    /// Cycles whose torque did not come in time.
    pub missed_cycles: u32,
}

/// Shorter is a mistake in the feed.
const FEWEST_CYCLES: f64 = 10.0;

/// Distances from the contour at its feed; those of start and stop do not count.
#[derive(Clone, Debug, Default)]
struct Distances {
    cycles: u32,
    squares_um2: f64,
    largest: (f64, [f64; 2]),
    reversals: [u32; 2],
    directions: [f64; 2],
}

impl Distances {
    fn take(&mut self, place: &Place, table_m: [f64; 2]) {
        let off_um = [0, 1].map(|axis| 1.0e6 * (table_m[axis] - place.at_m[axis]));
        let distance_um = (off_um[1] * place.along[0] - off_um[0] * place.along[1]).abs();
        self.cycles += 1;
        self.squares_um2 += distance_um * distance_um;
        if distance_um > self.largest.0 {
            self.largest = (distance_um, place.at_m);
        }
        for ((turns, before), now) in self
            .reversals
            .iter_mut()
            .zip(&mut self.directions)
            .zip(place.along)
        {
            *turns += u32::from(*before * now < 0.0);
            *before = now;
        }
    }
}

/// Runs a contour; the frames go to `log`, also where it breaks off.
///
/// # Errors
/// Where it cannot be run.
pub fn run(
    stand: &Stand<'_>,
    contour: &Contour,
    compensation: &[AxisCompensation],
    log: Option<&Path>,
) -> Outcome<ContourReport> {
    check(stand.machine, contour)?;
    stand.connect(0)?.perform(compensation, log, |session| {
        progress::step(&format!(
            "contour of {:.1} mm, F {} mm/min",
            1.0e3 * contour.length_m(),
            6.0e4 * contour.feed_m_per_s()
        ));
        let distances = follow(session, stand.machine, contour)?;
        Ok(ContourReport {
            machine: stand.machine.name.clone(),
            feed_mm_min: 6.0e4 * contour.feed_m_per_s(),
            length_mm: 1.0e3 * contour.length_m(),
            reversals: distances.reversals,
            compensation: compensation::method(compensation).to_owned(),
            error_of: session.sees(),
            largest_um: distances.largest.0,
            largest_at_mm: distances.largest.1.map(|at_m| 1.0e3 * at_m),
            rms_um: (distances.squares_um2 / f64::from(distances.cycles.max(1))).sqrt(),
            missed_cycles: session.missed(),
        })
    })
}

fn follow(session: &mut Session<'_>, machine: &Machine, contour: &Contour) -> Outcome<Distances> {
    let setpoints = |time_s: f64| {
        let mut all = vec![0.0; machine.axes.len()];
        all[..2].copy_from_slice(&contour.place(time_s).at_m);
        all
    };
    session.go_to(&setpoints(0.0))?;
    let mut distances = Distances::default();
    let counts = contour.at_feed_s();
    session.follow(contour.duration_s(), setpoints, |time_s, axes| {
        if counts.contains(&time_s) && axes.iter().all(AxisCycle::shows_table) {
            distances.take(&contour.place(time_s), table_m(machine, axes));
        }
    })?;
    Ok(distances)
}

/// Refuses a contour that the machine cannot run.
///
/// # Errors
/// What does not fit, and the limit.
pub fn check(machine: &Machine, contour: &Contour) -> Outcome<()> {
    let both = two_axes(machine, "a contour")?;
    let feed_mm_min = 6.0e4 * contour.feed_m_per_s();
    let hours = contour.duration_s() / 3600.0;
    if hours > LONGEST_H {
        return Err(Failure::new(format!(
            "--feed-mm-min {feed_mm_min}: the contour of {:.0} mm would take {hours:.1} h, more than {LONGEST_H}; a faster feed takes less",
            1.0e3 * contour.length_m(),
        )));
    }
    if contour.at_feed_s().is_empty() || contour.duration_s() < FEWEST_CYCLES * machine.period_s {
        return Err(Failure::new(format!(
            "--feed-mm-min {feed_mm_min}: the contour of {:.3} mm would be over within {FEWEST_CYCLES} cycles",
            1.0e3 * contour.length_m(),
        )));
    }
    let demands = Demand::of(contour, machine.period_s);
    both.into_iter()
        .zip(demands)
        .try_for_each(|(axis, demand)| demand.within(axis))
}

/// What a contour asks of an axis, by differences of setpoints.
#[derive(Clone, Copy, Debug, Default)]
struct Demand {
    travel_m: f64,
    velocity_m_per_s: f64,
    acceleration_m_per_s2: f64,
}

impl Demand {
    fn of(contour: &Contour, period_s: f64) -> [Self; 2] {
        let cycles = (contour.duration_s() / period_s).ceil();
        let at = |cycle: f64| contour.place(cycle * period_s).at_m;
        let (mut most, mut cycle) = ([Self::default(); 2], 0.0);
        let [mut before, mut here] = [at(-1.0), at(0.0)];
        while cycle <= cycles {
            let after = at(cycle + 1.0);
            for (axis, own) in most.iter_mut().enumerate() {
                let way = after[axis] - here[axis];
                let turn = way - (here[axis] - before[axis]);
                own.travel_m = own.travel_m.max(here[axis].abs());
                own.velocity_m_per_s = own.velocity_m_per_s.max(way.abs() / period_s);
                let acceleration = turn.abs() / (period_s * period_s);
                own.acceleration_m_per_s2 = own.acceleration_m_per_s2.max(acceleration);
            }
            (before, here) = (here, after);
            cycle += 1.0;
        }
        most
    }

    fn within(self, axis: &MachineAxis) -> Outcome<()> {
        let limits = &axis.limits;
        for (wanted, limit, unit, what) in [
            (
                1.0e3 * self.travel_m,
                1.0e3 * limits.travel_m,
                "mm",
                "of travel to either side",
            ),
            (
                6.0e4 * self.velocity_m_per_s,
                6.0e4 * limits.velocity_m_per_s,
                "mm/min",
                "of velocity; a slower feed takes less",
            ),
            (
                self.acceleration_m_per_s2,
                limits.acceleration_m_per_s2,
                "m/s²",
                "of acceleration; a slower feed takes less with its square",
            ),
        ] {
            if wanted > limit {
                return Err(Failure::new(format!(
                    "axis {}: the contour takes {wanted:.2} {unit}, the limit is {limit} {unit} {what}",
                    axis.name
                )));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A circle of 10 mm about the middle, once around.
    fn around(feed_mm_min: f64) -> Contour {
        let points = (0..=628).map(|step| {
            let angle = 0.01 * f64::from(step);
            [0.01 * angle.cos(), 0.01 * angle.sin()]
        });
        Contour::through(points.collect(), feed_mm_min / 6.0e4).unwrap()
    }

    #[test]
    fn a_contour_that_the_machine_cannot_run_is_refused_with_the_limit() {
        let machine = Machine::reference();
        assert_eq!(check(&machine, &around(2000.0)), Ok(()));
        let refused = |contour: &Contour| check(&machine, contour).unwrap_err().0;
        assert!(refused(&around(0.1)).contains("would take 10.5 h"));
        assert!(refused(&around(2.0e4)).contains("the limit is 5 m/s² of acceleration"));
        assert!(refused(&around(1.0e9)).contains("would be over within 10 cycles"));
        let bulge = [[0.0, -0.19], [0.19, -0.1], [0.19, 0.1], [0.0, 0.19]];
        let travel_m = machine.axes[0].limits.travel_m;
        let scale = travel_m / 0.191;
        let out = bulge.map(|point| point.map(|at_m| scale * at_m)).to_vec();
        let out = Contour::through(out, 0.01).unwrap();
        assert!(
            refused(&out).contains("of travel to either side"),
            "between its points"
        );
        let mut one = Machine::reference();
        one.axes.truncate(1);
        assert!(
            check(&one, &around(2000.0))
                .unwrap_err()
                .0
                .contains("two axes")
        );
    }

    #[test]
    fn a_contour_is_followed_and_its_error_seen() {
        let machine = Machine::reference();
        let stand = Stand::in_process(&machine);
        let none = stand.uncompensated();
        let report = run(&stand, &around(3000.0), &none, None).unwrap();
        // Bursts of some tens of micrometres at three of the four reversals; one is where it ends.
        assert_eq!(report.reversals, [1, 2]);
        assert!(
            (20.0..60.0).contains(&report.largest_um),
            "{}",
            report.largest_um
        );
        assert!(report.rms_um < 0.5 * report.largest_um);
    }
}
