//! A contour over the bus, and how far from it the table was.

use std::path::Path;

use plant_sim::Machine;
use serde::Serialize;

use crate::compensation::{self, AxisCompensation};
use crate::error::{Failure, Outcome};
use crate::network::master::AxisCycle;
use crate::progress;
use crate::session::{Session, Stand};
use crate::trajectory::circle_limits::Slowest;
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
    fn take(&mut self, place: &Place, axes: &[AxisCycle]) {
        let off_um = [0, 1].map(|axis| {
            let table_m = axes[axis]
                .truth
                .map_or(axes[axis].load_m, |truth| truth.table_m);
            1.0e6 * (table_m - place.at_m[axis])
        });
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
        let distances = follow(session, stand.machine.axes.len(), contour)?;
        Ok(ContourReport {
            machine: stand.machine.name.clone(),
            feed_mm_min: 6.0e4 * contour.feed_m_per_s(),
            length_mm: 1.0e3 * contour.length_m(),
            reversals: distances.reversals,
            compensation: compensation::method(compensation).to_owned(),
            error_of: if session.sees_truth() {
                "table"
            } else {
                "load scale"
            },
            largest_um: distances.largest.0,
            largest_at_mm: distances.largest.1.map(|at_m| 1.0e3 * at_m),
            rms_um: (distances.squares_um2 / f64::from(distances.cycles.max(1))).sqrt(),
            missed_cycles: session.missed(),
        })
    })
}

fn follow(session: &mut Session<'_>, axes: usize, contour: &Contour) -> Outcome<Distances> {
    let setpoints = |time_s: f64| {
        let mut all = vec![0.0; axes];
        all[..2].copy_from_slice(&contour.place(time_s).at_m);
        all
    };
    session.go_to(&setpoints(0.0))?;
    let mut distances = Distances::default();
    let counts = contour.at_feed_s();
    session.follow(contour.duration_s(), setpoints, |time_s, axes| {
        if counts.contains(&time_s) {
            distances.take(&contour.place(time_s), axes);
        }
    })?;
    Ok(distances)
}

/// Refuses a contour that the machine cannot run.
///
/// # Errors
/// What does not fit, and the limit.
pub fn check(machine: &Machine, contour: &Contour) -> Outcome<()> {
    let limits = Slowest::of(machine);
    let refused = |text: String| Err(Failure::new(format!("machine {}: {text}", machine.name)));
    if machine.axes.len() < 2 {
        return refused(format!(
            "a contour needs two axes, this machine has {}",
            machine.axes.len()
        ));
    }
    let far = |point: &&[f64; 2]| point.iter().any(|at_m| at_m.abs() > limits.travel_m);
    if let Some([x_m, y_m]) = contour.points_m().iter().find(far) {
        return refused(format!(
            "the point {} / {} mm is beyond ±{} mm of travel",
            1.0e3 * x_m,
            1.0e3 * y_m,
            1.0e3 * limits.travel_m
        ));
    }
    let (fastest, hardest) = demands(contour, machine.period_s);
    if fastest > limits.velocity_m_per_s {
        return refused(format!(
            "--feed-mm-min: the contour takes {:.0} mm/min of an axis, the limit is {:.0}",
            6.0e4 * fastest,
            6.0e4 * limits.velocity_m_per_s
        ));
    }
    if hardest > limits.acceleration_m_per_s2 {
        return refused(format!(
            "--feed-mm-min: the contour takes {hardest:.2} m/s² of an axis, the limit is {}; a slower feed takes less with its square",
            limits.acceleration_m_per_s2
        ));
    }
    Ok(())
}

/// Largest velocity and acceleration of an axis, by differences of setpoints.
fn demands(contour: &Contour, period_s: f64) -> (f64, f64) {
    let cycles = (contour.duration_s() / period_s).ceil();
    let at = |cycle: f64| contour.place(cycle * period_s).at_m;
    let (mut fastest, mut hardest, mut cycle) = (0.0_f64, 0.0_f64, 1.0);
    while cycle < cycles {
        let [before, here, after] = [at(cycle - 1.0), at(cycle), at(cycle + 1.0)];
        for axis in 0..2 {
            let way = after[axis] - here[axis];
            let turn = way - (here[axis] - before[axis]);
            fastest = fastest.max(way.abs() / period_s);
            hardest = hardest.max(turn.abs() / (period_s * period_s));
        }
        cycle += 1.0;
    }
    (fastest, hardest)
}
