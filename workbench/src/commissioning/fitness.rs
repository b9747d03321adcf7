//! Whether an axis is fit to be compensated: a loop that oscillates is told so before anything is
//! recorded or tuned on it.
//!
//! The axes stand, then run through the middle of their travel at two speeds. What a loop does by
//! itself it does at the same frequency whatever the speed; what comes from the screw or the motor
//! follows the speed, and noise does neither. Then they creep: what rings at slow speeds alone is
//! told, and the job goes on.

mod creeping;

use creeping::Sweep;
use identification::Identification;
use plant_sim::Machine;
use plant_sim::machine::{MachineAxis, PositionSensor};
use serde::Serialize;

use crate::error::Outcome;
use crate::network::master::AxisCycle;
use crate::progress;
use crate::session::{Session, Stand};
use crate::trajectory::Move;
use crate::trajectory::circle_limits::Slowest;

/// How long the axes stand and run, s.
const HOLD_S: f64 = 1.0;
/// The two speeds, as shares of the velocity limit; both run within a part of the travel.
const SPEED_SHARES: [f64; 2] = [0.05, 0.2];
/// A run takes this part of the travel at most.
const TRAVEL_SHARE: f64 = 0.4;
/// From this amplitude on an axis is not fit, µm: friction, ripple and gaps of healthy axes leave
/// as much in motion.
const UNFIT_UM: f64 = 5.0;
const LEAST_IN_MOTION_UM: f64 = UNFIT_UM;
/// From this amplitude on an oscillation is told at standstill, µm, where only noise is left, and
/// from so many steps of the coarser encoder.
const LEAST_STANDING_UM: f64 = 1.0;
const LEAST_STEPS: f64 = 3.0;
/// Fewer crossings of the mean are the motion itself, or a drift.
const LEAST_CROSSINGS: f64 = 8.0;
/// The amplitude in the second half of a run is at least this share of that in the first: a motion
/// that dies out is a settling.
const LASTING: f64 = 0.5;
/// Share of velocity and acceleration limits on the way, and of the acceleration of the runs: a
/// motor that is too weak for more is found by the records, not here.
const GENTLE: f64 = 0.1;
/// How long an axis settles, s.
const SETTLE_S: f64 = 0.3;
/// What is looked at of a run that broke off, s.
const LAST_S: f64 = 0.25;
/// Frequencies that differ by less than this share are the same.
const SAME: f64 = 0.2;
/// A force that comes so near to its limit is at it.
const AT_LIMIT: f64 = 0.98;

/// An oscillation that an axis does by itself.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Oscillation {
    /// The axis.
    pub axis: String,
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Amplitude of the position, µm.
    pub amplitude_um: f64,
    /// Whether the axis stands or runs.
    pub at_standstill: bool,
    /// Speed at which it oscillates while it creeps, m/s; elsewhere it does not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub creeping_m_per_s: Option<f64>,
    /// It was seen on the records only: what moves as a record does wakes it, and gentle motion
    /// does not.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub on_record: bool,
    /// The force comes to its limit.
    pub at_force_limit: bool,
}

/// Position error and force of one axis over a run.
#[derive(Clone, Debug, Default)]
struct Run {
    error_um: Vec<f64>,
    force_n: Vec<f64>,
}

/// Oscillations of the axes of a machine; none is what it should be. A drive that stops with a
/// fault on the way is one that oscillates where its last cycles say so.
///
/// # Errors
/// Where the machine cannot be moved for another reason, or the operator interrupts.
pub fn oscillations(stand: &Stand<'_>) -> Outcome<Vec<Oscillation>> {
    progress::step("whether the loops are stable");
    let mut runs: Vec<Vec<Run>> = Vec::new();
    let session = stand.connect(FITNESS_RUN)?;
    let outcome = session.perform(&stand.uncompensated(), None, |session| {
        standing(session, stand, &mut runs)?;
        SPEED_SHARES
            .into_iter()
            .try_for_each(|share| moving(session, stand, share, &mut runs))?;
        creeping(session, stand, &mut runs)
    });
    stand.interrupt.check()?;
    let axes = stand.machine.axes.iter().enumerate();
    let told = |(place, axis): (usize, &MachineAxis)| {
        let own: Vec<&Run> = runs.iter().filter_map(|run| run.get(place)).collect();
        let period_s = stand.machine.period_s;
        let seen = of_axis(axis, &own, period_s, outcome.is_err());
        let told = seen.map(|(seen, at_standstill)| seen.told(&axis.name, at_standstill));
        let sweep = own.get(CREEPING).filter(|_| outcome.is_ok());
        told.or_else(|| while_creeping(stand, axis, sweep?))
    };
    let found: Vec<Oscillation> = axes.filter_map(told).collect();
    match outcome {
        Err(failure) if !found.iter().any(Oscillation::is_unfit) => Err(failure),
        _ => Ok(found),
    }
}

/// Oscillations that only the records show, as their identification says: of a load that shakes
/// between the flanks of a gap, or of a loop that is stable until it moves fast.
#[must_use]
pub fn on_records(machine: &Machine, results: &[Identification]) -> Vec<Oscillation> {
    let axes = machine.axes.iter().zip(results);
    let seen = |(axis, result): (&MachineAxis, &Identification)| {
        let own = result.report.loop_oscillation?;
        Some(Oscillation {
            axis: axis.name.clone(),
            frequency_hz: own.frequency_hz,
            amplitude_um: 1.0e6 * std::f64::consts::SQRT_2 * own.rms,
            at_standstill: false,
            creeping_m_per_s: None,
            on_record: true,
            at_force_limit: false,
        })
    };
    let seen = axes.filter_map(seen);
    seen.filter(Oscillation::is_unfit).collect()
}

/// What one axis does by itself, and whether at standstill; the last run may have broken off.
fn of_axis(
    axis: &MachineAxis,
    runs: &[&Run],
    period_s: f64,
    broke_off: bool,
) -> Option<(Seen, bool)> {
    let limit_n = axis.actual.force_limit_n;
    let seen = |run: &Run, least_um| Seen::of(run, period_s, limit_n, least_um);
    match (runs, broke_off) {
        (_, true) => {
            let last = Seen::at_the_end(runs.last()?, period_s, limit_n)?;
            Some((last, runs.len() == 1))
        }
        ([still, slow, fast, ..], _) => judged(
            seen(still, least_standing_um(axis)),
            [slow, fast].map(|run| seen(run, LEAST_IN_MOTION_UM)),
        ),
        _ => None,
    }
}

fn least_standing_um(axis: &MachineAxis) -> f64 {
    let actual = &axis.actual;
    let motor_m = actual.lead_m_per_rev / f64::from(actual.motor_encoder_counts_per_rev);
    let step_m = motor_m.max(actual.load_encoder_resolution_m);
    LEAST_STANDING_UM.max(1.0e6 * LEAST_STEPS * step_m)
}

/// Noise of this run is another than that of the others.
const FITNESS_RUN: u64 = 2000;

fn standing(session: &mut Session<'_>, stand: &Stand<'_>, runs: &mut Vec<Vec<Run>>) -> Outcome<()> {
    let home = vec![0.0; stand.machine.axes.len()];
    led(session, stand, &home, runs)?;
    recorded(session, stand, HOLD_S, runs, |_| home.clone())
}

/// A run through the middle of the travel.
fn moving(
    session: &mut Session<'_>,
    stand: &Stand<'_>,
    share: f64,
    runs: &mut Vec<Vec<Run>>,
) -> Outcome<()> {
    let slowest = Slowest::of(stand.machine);
    let speed = (share * slowest.velocity_m_per_s).min(TRAVEL_SHARE * slowest.travel_m / HOLD_S);
    let end = |side: f64| vec![0.5 * side * speed * HOLD_S; stand.machine.axes.len()];
    led(session, stand, &end(-1.0), runs)?;
    let acceleration = GENTLE * slowest.acceleration_m_per_s2;
    let way = Move::new(&end(-1.0), &end(1.0), speed, acceleration);
    recorded(session, stand, way.duration_s(), runs, |time_s| {
        way.at(time_s)
    })
}

/// The place of that run: after the one at standstill and two in motion.
const CREEPING: usize = 1 + SPEED_SHARES.len();

/// From rest with an acceleration that leaves slow speeds time to show themselves, and to rest
/// again.
fn creeping(session: &mut Session<'_>, stand: &Stand<'_>, runs: &mut Vec<Vec<Run>>) -> Outcome<()> {
    let axes = stand.machine.axes.len();
    let slowest = Slowest::of(stand.machine);
    let acceleration = sweep_acceleration(stand);
    let sweep_s = creeping::LONGEST_S
        .min((2.0 * TRAVEL_SHARE * slowest.travel_m / acceleration).sqrt())
        .min(0.5 * slowest.velocity_m_per_s / acceleration);
    led(session, stand, &vec![0.0; axes], runs)?;
    let up = |time_s: f64| vec![0.5 * acceleration * time_s * time_s; axes];
    recorded(session, stand, sweep_s, runs, up)?;
    let speed = acceleration * sweep_s;
    let brake = acceleration.max(GENTLE * slowest.acceleration_m_per_s2);
    let end_m = up(sweep_s)[0];
    session.follow(
        speed / brake,
        |time_s| {
            let time_s = time_s.min(speed / brake);
            vec![end_m + speed * time_s - 0.5 * brake * time_s * time_s; axes]
        },
        |_, _| (),
    )
}

fn sweep_acceleration(stand: &Stand<'_>) -> f64 {
    let most = 0.5 * Slowest::of(stand.machine).acceleration_m_per_s2;
    creeping::ACCELERATION_M_PER_S2.min(most)
}

/// What rings while an axis creeps.
fn while_creeping(stand: &Stand<'_>, axis: &MachineAxis, run: &Run) -> Option<Oscillation> {
    let sweep = Sweep {
        error_um: &run.error_um,
        period_s: stand.machine.period_s,
        acceleration_m_per_s2: sweep_acceleration(stand),
    };
    let seen = creeping::oscillation(sweep, least_standing_um(axis))?;
    Some(Oscillation {
        axis: axis.name.clone(),
        frequency_hz: seen.frequency_hz,
        amplitude_um: seen.amplitude_um,
        at_standstill: false,
        creeping_m_per_s: Some(seen.speed_m_per_s),
        on_record: false,
        at_force_limit: false,
    })
}

/// Leads the axes to a place and lets them settle. It is recorded only in case that a drive stops.
fn led(
    session: &mut Session<'_>,
    stand: &Stand<'_>,
    to: &[f64],
    runs: &mut Vec<Vec<Run>>,
) -> Outcome<()> {
    let slowest = Slowest::of(stand.machine);
    let here: Vec<f64> = (0..to.len())
        .map(|axis| session.master().axis(axis).reference_m)
        .collect();
    let (speed, acceleration) = (
        GENTLE * slowest.velocity_m_per_s,
        GENTLE * slowest.acceleration_m_per_s2,
    );
    let way = Move::new(&here, to, speed, acceleration);
    let duration_s = way.duration_s() + SETTLE_S;
    recorded(session, stand, duration_s, runs, |time_s| way.at(time_s))?;
    runs.pop();
    Ok(())
}

/// Follows a path; what was recorded is there also where it breaks off.
fn recorded(
    session: &mut Session<'_>,
    stand: &Stand<'_>,
    duration_s: f64,
    runs: &mut Vec<Vec<Run>>,
    at: impl Fn(f64) -> Vec<f64>,
) -> Outcome<()> {
    let mut own = vec![Run::default(); stand.machine.axes.len()];
    let outcome = session.follow(duration_s, at, |_, cycles| {
        for ((run, cycle), axis) in own.iter_mut().zip(cycles).zip(&stand.machine.axes) {
            run.error_um
                .push(1.0e6 * (cycle.reference_m - measured_m(axis.gains.position_sensor, cycle)));
            run.force_n.push(cycle.force_n);
        }
    });
    runs.push(own);
    outcome
}

fn measured_m(sensor: PositionSensor, cycle: &AxisCycle) -> f64 {
    match sensor {
        PositionSensor::Motor => cycle.motor_m,
        PositionSensor::Load => cycle.load_m,
    }
}

/// What is seen of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Seen {
    frequency_hz: f64,
    amplitude_um: f64,
    at_limit: bool,
}

impl Seen {
    /// `None` where nothing oscillates, or what does dies out.
    fn of(run: &Run, period_s: f64, limit_n: f64, least_um: f64) -> Option<Self> {
        let rows = run.error_um.len();
        // The first and the last quarter are the begin and the end of the motion.
        let rest = run.error_um.get(rows / 4..rows - rows / 4)?;
        let (first, second) = rest.split_at(rest.len() / 2);
        let seen = Self::in_part(second, run, period_s, limit_n)?;
        let lasts = seen.amplitude_um >= LASTING * amplitude(first);
        (seen.amplitude_um >= least_um && lasts).then_some(seen)
    }

    /// Of the last part of a run that broke off, where the drive stopped with a fault.
    fn at_the_end(run: &Run, period_s: f64, limit_n: f64) -> Option<Self> {
        let rows = ((LAST_S / period_s).round() as usize).min(run.error_um.len());
        let last = &run.error_um[run.error_um.len() - rows..];
        let seen = Self::in_part(last, run, period_s, limit_n)?;
        (seen.amplitude_um >= UNFIT_UM).then_some(seen)
    }

    /// Of a part of a run; `None` where it crosses its mean too seldom.
    fn in_part(error_um: &[f64], run: &Run, period_s: f64, limit_n: f64) -> Option<Self> {
        let crossings = crossings(error_um);
        let most_n = run
            .force_n
            .iter()
            .fold(0.0_f64, |most, n| most.max(n.abs()));
        (crossings >= LEAST_CROSSINGS).then(|| Self {
            frequency_hz: crossings / (2.0 * period_s * error_um.len() as f64),
            amplitude_um: amplitude(error_um),
            at_limit: most_n > AT_LIMIT * limit_n,
        })
    }

    fn told(self, axis: &str, at_standstill: bool) -> Oscillation {
        Oscillation {
            axis: axis.to_owned(),
            frequency_hz: self.frequency_hz,
            amplitude_um: self.amplitude_um,
            at_standstill,
            creeping_m_per_s: None,
            on_record: false,
            at_force_limit: self.at_limit,
        }
    }
}

/// What the loop does by itself, and whether at standstill.
fn judged(still: Option<Seen>, running: [Option<Seen>; 2]) -> Option<(Seen, bool)> {
    if let Some(seen) = still {
        return Some((seen, true));
    }
    let [Some(slow), Some(fast)] = running else {
        return None;
    };
    let apart = (fast.frequency_hz / slow.frequency_hz - 1.0).abs();
    (apart < SAME).then_some((fast, false))
}

/// Amplitude of a sine of the same power, about the mean.
fn amplitude(values: &[f64]) -> f64 {
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    let power = values
        .iter()
        .map(|value| (value - mean).powi(2))
        .sum::<f64>()
        / count;
    (2.0 * power).sqrt()
}

/// Crossings of the mean.
fn crossings(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    let crosses = |pair: &&[f64]| (pair[0] > mean) != (pair[1] > mean);
    values.windows(2).filter(crosses).count() as f64
}

impl Oscillation {
    /// Whether an axis with it is not to be compensated: it makes friction and circles unknowable.
    #[must_use]
    pub fn is_unfit(&self) -> bool {
        self.amplitude_um >= UNFIT_UM && self.creeping_m_per_s.is_none()
    }

    /// Where it was seen.
    #[must_use]
    pub fn place(&self) -> String {
        match self.creeping_m_per_s {
            Some(speed) => format!("at {:.1} mm/s", 1.0e3 * speed),
            None if self.at_standstill => "at standstill".to_owned(),
            None if self.on_record => "on its records".to_owned(),
            None => "in motion".to_owned(),
        }
    }

    /// One sentence: what, how much, what to do.
    #[must_use]
    pub fn sentence(&self) -> String {
        if let Some(speed) = self.creeping_m_per_s {
            return format!(
                "axis {}: at about {:.1} mm/s the loop oscillates at {:.0} Hz with {:.1} µm without any compensation, and no compensation takes \
                 that away: slow circles keep as much of their burst; where friction falls as the speed grows a stiffer loop helps or another lubricant, \
                 where the screw rings a slower loop",
                self.axis,
                1.0e3 * speed,
                self.frequency_hz,
                self.amplitude_um
            );
        }
        let place = self.place();
        let limit = if self.at_force_limit {
            ", its force at the limit"
        } else {
            ""
        };
        format!(
            "axis {}: the loop oscillates {place} at {:.0} Hz with {:.1} µm{limit}; lower velocity_bandwidth_hz, \
             and position_gain_per_s with it, until it stands still, and commission again",
            self.axis, self.frequency_hz, self.amplitude_um
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(amplitude_um: f64, hz: f64, decay_per_s: f64) -> Run {
        let at = |cycle: u32| {
            let time_s = 1.0e-3 * f64::from(cycle);
            amplitude_um
                * (-decay_per_s * time_s).exp()
                * (std::f64::consts::TAU * hz * time_s).sin()
                + 3.0
        };
        Run {
            error_um: (0..1000).map(at).collect(),
            force_n: vec![990.0; 1000],
        }
    }

    fn seen(run: &Run) -> Option<Seen> {
        Seen::of(run, 1.0e-3, 1000.0, 5.0)
    }

    #[test]
    fn a_lasting_oscillation_is_seen_with_frequency_and_amplitude_and_a_settling_is_not() {
        let lasting = seen(&run(40.0, 31.0, 0.0)).unwrap();
        assert!((lasting.frequency_hz - 31.0).abs() < 1.5, "{lasting:?}");
        assert!((lasting.amplitude_um - 40.0).abs() < 1.0, "{lasting:?}");
        assert!(lasting.at_limit);
        assert_eq!(seen(&run(400.0, 31.0, 5.0)), None, "it dies out");
        assert_eq!(seen(&run(4.5, 31.0, 0.0)), None, "it is small");
        assert_eq!(seen(&run(40.0, 3.0, 0.0)), None, "it is the motion itself");
    }

    #[test]
    fn a_run_that_broke_off_is_judged_by_its_last_quarter_of_a_second() {
        let mut growing = run(0.0, 31.0, 0.0);
        growing.error_um.extend(run(60.0, 50.0, 0.0).error_um);
        let seen = Seen::at_the_end(&growing, 1.0e-3, 1000.0).unwrap();
        assert!((seen.frequency_hz - 50.0).abs() < 3.0, "{seen:?}");
        assert_eq!(Seen::at_the_end(&run(1.0, 50.0, 0.0), 1.0e-3, 1000.0), None);
        assert_eq!(Seen::at_the_end(&Run::default(), 1.0e-3, 1000.0), None);
    }

    #[test]
    fn what_follows_the_speed_is_not_the_loops() {
        let [slow, fast] = [24.0, 60.0].map(|hz| seen(&run(20.0, hz, 0.0)));
        assert_eq!(judged(None, [slow, fast]), None);
        assert_eq!(judged(None, [slow, None]), None);
        assert!(matches!(judged(None, [slow, slow]), Some((_, false))));
        assert!(matches!(judged(fast, [None, None]), Some((_, true))));
    }
}
