//! How long the cycles of a machine take: all axes go to and fro, and a stopwatch at the buses
//! notes what goes by.

use std::cell::RefCell;
use std::f64::consts::TAU;
use std::rc::Rc;

use plant_sim::Machine;
use quadrant_host::Pace;
use serde::Serialize;
use servo::objects;

use crate::drive_times::{self, DriveTimes};
use crate::error::Outcome;
use crate::network::in_process::InProcess;
use crate::network::link::Link;
use crate::network::place::Place;
use crate::network::round_trip;
use crate::network::stopwatch::{Durations, Stopwatch, Times, no_durations};
use crate::progress;
use crate::session::{Session, Stand};
use crate::trajectory::circle_limits::Slowest;

/// Bare frames there and back.
const ROUND_TRIPS: u32 = 2000;
/// Amplitude and feed of the motion, where the machine can go so far and so fast: R 10 F 1000.
const AMPLITUDE_M: f64 = 5.0e-3;
const FEED_M_PER_S: f64 = 1.0 / 60.0;
/// Share of what the axes can do.
const SHARE: f64 = 0.5;
/// Classes of a histogram for every doubling of the duration.
const PER_DOUBLING: f64 = 4.0;

/// Durations in a few numbers, µs.
#[derive(Clone, Debug, Serialize)]
pub struct Spread {
    /// What was timed.
    pub of: &'static str,
    /// So many.
    pub count: u64,
    /// Least.
    pub min_us: f64,
    /// Mean.
    pub mean_us: f64,
    /// Half of all are below.
    pub p50_us: f64,
    /// 99 of 100.
    pub p99_us: f64,
    /// 999 of 1000.
    pub p99_9_us: f64,
    /// Largest.
    pub max_us: f64,
    /// Upper end of each class, µs, and how many are in it; classes without any are left out
    /// beyond either end.
    pub histogram: Vec<(f64, u64)>,
}

/// What `timing --json` says.
#[derive(Clone, Debug, Serialize)]
pub struct TimingReport {
    /// Machine.
    pub machine: String,
    /// Where it is: `in process`, or the interfaces.
    pub place: String,
    /// `virtual`, `lockstep` or `clock`.
    pub pace: &'static str,
    /// What the system granted to a run at clock pace.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scheduling: Option<String>,
    /// Period of the machine file.
    pub period_us: f64,
    /// Computed cyclic bus load.
    pub bus_load_percent: f64,
    /// Cycles that were timed.
    pub cycles: u64,
    /// Cycles whose torque did not come in time.
    pub missed_cycles: u64,
    /// What was timed; `cycle` comes first.
    pub times: Vec<Spread>,
    /// What each drive says of itself since it started: only a board, or a program at the pace of
    /// the clock, counts.
    pub drives: Vec<DriveReport>,
}

/// What a drive says of itself.
#[derive(Clone, Debug, Serialize)]
pub struct DriveReport {
    /// Its axis.
    pub axis: String,
    /// Deadlines that it missed.
    pub missed_deadlines: u32,
    /// The latest that it was, µs.
    pub latest_us: u32,
    /// What it timed of itself during the run.
    pub times: Vec<DriveTimes>,
}

/// Times the cycles of a machine for so long, s of its own time.
///
/// # Errors
/// Where it cannot be moved, or an interface is gone.
pub fn run(stand: &Stand<'_>, duration_s: f64) -> Outcome<TimingReport> {
    let timed = timed(stand, duration_s)?;
    let times = &timed.times;
    progress::step("bare frames there and back");
    let (place, pace, trips) = match &stand.place {
        Place::InProcess => {
            let trips = round_trip::in_process(ROUND_TRIPS)?;
            ("in process".to_owned(), "virtual", trips)
        }
        Place::Can { names, pace } => {
            let own = stand
                .machine
                .axes
                .first()
                .and_then(|axis| axis.interface.as_deref());
            let trips = round_trip::on_interface(own.unwrap_or(names), ROUND_TRIPS)?;
            (names.clone(), pace_name(*pace), trips)
        }
    };
    Ok(TimingReport {
        machine: stand.machine.name.clone(),
        place,
        pace,
        scheduling: timed.scheduling,
        period_us: 1.0e6 * stand.machine.period_s,
        bus_load_percent: f64::from(stand.machine.bus_load_per_mille()) / 10.0,
        cycles: times.cycles + times.missed,
        missed_cycles: times.missed,
        times: spreads(times, timed.steps.as_ref(), &trips),
        drives: timed.drives,
    })
}

const fn pace_name(pace: Pace) -> &'static str {
    match pace {
        Pace::Lockstep { .. } => "lockstep",
        Pace::Clock => "clock",
    }
}

/// A run of the machine.
struct Timed {
    /// By the stopwatch.
    times: Times,
    /// What each drive does for a torque, where it is in this process.
    steps: Option<Durations>,
    /// What the system granted.
    scheduling: Option<String>,
    drives: Vec<DriveReport>,
}

fn timed(stand: &Stand<'_>, duration_s: f64) -> Outcome<Timed> {
    let steps = Rc::new(RefCell::new(no_durations()));
    let is_here = stand.place == Place::InProcess;
    let link: Box<dyn Link> = if is_here {
        Box::new(InProcess::watched(stand.machine, 0, &steps)?)
    } else {
        stand.place.open(stand.machine, 0)?
    };
    let scheduling = link.scheduling();
    let (link, button) = Stopwatch::at(link, stand.machine.axes.len())?;
    let session = Session::on(link, stand.machine, &stand.interrupt)?;
    session.perform(&stand.uncompensated(), None, |session| {
        let here = vec![0.0; stand.machine.axes.len()];
        session.go_to(&here)?;
        progress::step(&format!("cycles for {duration_s} s"));
        *steps.borrow_mut() = no_durations();
        (0..stand.machine.axes.len())
            .try_for_each(|axis| drive_times::clear(session.master_mut(), axis))?;
        button.start();
        session.follow(duration_s, to_and_fro(stand.machine, duration_s), |_, _| ())?;
        let times = button.stop();
        let names = stand.axis_names().into_iter().enumerate();
        let drives = names.map(|(index, axis)| {
            let master = session.master_mut();
            let mut read = |object| master.upload(index, object);
            Ok(DriveReport {
                axis,
                missed_deadlines: read(objects::MISSED_DEADLINES)?.to_u32(),
                latest_us: read(objects::LATEST)?.to_u32(),
                times: drive_times::read(master, index)?,
            })
        });
        let drives = drives.collect::<Outcome<_>>()?;
        Ok(Timed {
            times,
            steps: is_here.then(|| steps.borrow().clone()),
            scheduling,
            drives,
        })
    })
}

/// All axes to one side and back, again and again, from rest to rest.
fn to_and_fro(machine: &Machine, duration_s: f64) -> impl Fn(f64) -> Vec<f64> + use<> {
    let slowest = Slowest::of(machine);
    let widest_m = AMPLITUDE_M.min(0.5 * SHARE * slowest.travel_m);
    let feed = FEED_M_PER_S.min(SHARE * slowest.velocity_m_per_s);
    // As many whole periods as that feed makes, one at least.
    let periods = (duration_s * feed / (TAU * widest_m)).floor().max(1.0);
    let rate = TAU * periods / duration_s;
    let by_acceleration_m = SHARE * slowest.acceleration_m_per_s2 / (rate * rate);
    let amplitude_m = widest_m.min(feed / rate).min(by_acceleration_m);
    let axes = machine.axes.len();
    move |time_s| vec![amplitude_m * (1.0 - (rate * time_s).cos()); axes]
}

fn spreads(times: &Times, steps: Option<&Durations>, trips: &Durations) -> Vec<Spread> {
    let cycle = Spread::of("SYNC to the last torque", &times.cycle);
    let mut all = Vec::new();
    match steps {
        Some(steps) => all.push(Spread::of("a drive's work for one torque", steps)),
        None => {
            all.push(Spread::of("SYNC to feedback", &times.feedback));
            all.push(Spread::of("feedback to torque", &times.drive));
        }
    }
    all.push(Spread::of("begin to begin of cycles", &times.interval));
    all.push(Spread::of("lateness of SYNC", &times.lateness));
    all.push(Spread::of("bare frame, there and back", trips));
    all.retain(|spread| spread.count > 0);
    [vec![cycle], all].concat()
}

impl Spread {
    /// Of durations in ns.
    fn of(of: &'static str, durations: &Durations) -> Self {
        let us = |nanos: u64| 1.0e-3 * nanos as f64;
        Self {
            of,
            count: durations.len(),
            min_us: us(durations.min()),
            mean_us: 1.0e-3 * durations.mean(),
            p50_us: us(durations.value_at_quantile(0.5)),
            p99_us: us(durations.value_at_quantile(0.99)),
            p99_9_us: us(durations.value_at_quantile(0.999)),
            max_us: us(durations.max()),
            histogram: histogram(durations),
        }
    }
}

/// Classes that grow with the duration: there are a hundred times between the usual and the worst.
fn histogram(durations: &Durations) -> Vec<(f64, u64)> {
    let class = |nanos: u64| (PER_DOUBLING * (nanos as f64).log2()).floor() as i32;
    let upper_us = |class: i32| 1.0e-3 * (f64::from(class + 1) / PER_DOUBLING).exp2();
    if durations.is_empty() {
        return Vec::new();
    }
    let (first, last) = (class(durations.min().max(1)), class(durations.max()));
    let mut counts = vec![0; usize::try_from(last - first).map_or(1, |more| more + 1)];
    for value in durations.iter_recorded() {
        let place = class(value.value_iterated_to()).clamp(first, last) - first;
        counts[usize::try_from(place).unwrap_or(0)] += value.count_since_last_iteration();
    }
    (first..=last).map(upper_us).zip(counts).collect()
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::network::stopwatch::note;

    #[test]
    fn classes_hold_all_durations_and_end_above_the_largest() {
        let mut durations = no_durations();
        for micros in [10, 11, 12, 900] {
            note(&mut durations, Duration::from_micros(micros));
        }
        let spread = Spread::of("", &durations);
        let sum: u64 = spread.histogram.iter().map(|(_, count)| count).sum();
        assert_eq!((sum, spread.count), (4, 4));
        let (last_us, in_it) = *spread.histogram.last().unwrap();
        assert!(
            (900.0..1100.0).contains(&last_us) && in_it == 1,
            "{last_us}"
        );
        assert!((spread.p50_us - 11.0).abs() < 0.1, "{spread:?}");
        assert!(histogram(&no_durations()).is_empty());
    }

    #[test]
    fn every_cycle_in_process_is_timed_and_none_is_missed() {
        let machine = Machine::reference();
        let report = run(&Stand::in_process(&machine), 0.2).unwrap();
        assert_eq!((report.cycles, report.missed_cycles), (200, 0));
        let of = |name: &str| report.times.iter().find(|times| times.of == name);
        assert_eq!(report.times[0].count, 200);
        // Both drives.
        assert_eq!(of("a drive's work for one torque").unwrap().count, 400);
        assert_eq!(of("lateness of SYNC").map(|times| times.count), None);
        assert_eq!(of("bare frame, there and back").unwrap().count, 2000);
    }

    #[test]
    fn the_motion_begins_at_rest_and_stays_within_what_the_axes_can_do() {
        let (machine, slowest) = (Machine::reference(), Slowest::of(&Machine::reference()));
        for duration_s in [1.0, 10.0] {
            let at = to_and_fro(&machine, duration_s);
            assert_eq!(at(0.0), [0.0, 0.0]);
            assert!(at(duration_s)[1].abs() < 1.0e-9);
            let way = (0..10_000).map(|ms| at(1.0e-3 * f64::from(ms))[0]);
            let way: Vec<f64> = way.collect();
            let furthest = way.iter().copied().fold(0.0, f64::max);
            assert!(
                furthest > 0.005 && furthest < slowest.travel_m,
                "{furthest}"
            );
            let fastest = way.windows(2).map(|pair| 1.0e3 * (pair[1] - pair[0]));
            assert!(fastest.fold(0.0, f64::max) < 1.001 * FEED_M_PER_S);
        }
    }
}
