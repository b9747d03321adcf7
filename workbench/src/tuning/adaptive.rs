//! The pulse over the acceleration at the reversal: a circle for each point of the drive's table.
//!
//! What a pulse has to do goes with v² / r alone, so circles of one small radius do for all. On
//! each the axes turn round both ways: one circle without a pulse and a few with pulses tell the
//! best for both axes and both directions at once ([`super::pulse_response`]).

use super::pulse_response::{Bursts, Probe, Pulses, left_um};
use super::start_values::start;
use super::tuning_circles::{TuningCircle, TuningCircles};
use super::{TUNING_RUN, Tuned, worth};
use crate::ballbar::{self, REVERSALS, apart};
use crate::compensation::{Adaptive, Compensation, POINTS};
use crate::error::Outcome;
use crate::progress;
use crate::session::{Session, Stand};
use crate::trajectory::Circle;
use crate::trajectory::circle_limits::check_circle;

/// Radius of the circles, or less where the given one is less.
const RADIUS_M: f64 = 0.020;
/// Circles with pulses at each acceleration.
const PROBES: usize = 4;
/// Samples before a reversal that are looked at: a drive knows it a cycle ahead.
const BEFORE: usize = 4;
/// So far behind a reversal its burst is looked at.
const BEHIND_RAD: f64 = std::f64::consts::FRAC_PI_6;

/// Tunes pulses at the accelerations of the drive's table that the machine can do; beyond them they
/// stay. `None` where no circle shows a burst. `circle` tells what it is worth.
///
/// # Errors
/// Where a circle cannot be run, or the operator interrupts.
pub fn adaptive(stand: &Stand<'_>, circle: &Circle) -> Outcome<Option<Tuned>> {
    let session = stand.connect(TUNING_RUN)?;
    session.perform(&stand.uncompensated(), None, |session| {
        let (tables, turns) = tables(stand, circle, session)?;
        if tables.iter().all(Adaptive::is_off) {
            return Ok(None);
        }
        let mut compensation = stand.uncompensated();
        for (axis, table) in compensation.iter_mut().zip(tables) {
            if !table.is_off() {
                axis.reversal = Compensation::Adaptive(Box::new(table));
            }
        }
        let tuned = worth(TuningCircles::on(session, circle), stand, compensation)?;
        Ok(Some(Tuned {
            circles: turns + tuned.circles,
            ..tuned
        }))
    })
}

/// The tables of both axes, and how many circles they took.
fn tables(
    stand: &Stand<'_>,
    circle: &Circle,
    session: &mut Session<'_>,
) -> Outcome<([Adaptive; 2], u32)> {
    let mut tables = [Adaptive::OFF; 2];
    let mut all = 0;
    let radius_m = RADIUS_M.min(circle.radius_m);
    let accelerations = Adaptive::OFF.accelerations_m_per_s2();
    let mut found: [Option<Pulses>; 2] = [None; 2];
    for (place, acceleration) in accelerations.into_iter().enumerate() {
        let own = Circle {
            radius_m,
            feed_m_per_s: (acceleration * radius_m).sqrt(),
            ..*circle
        };
        if check_circle(stand.machine, &own).is_ok() {
            progress::step(&format!(
                "circles at {:.2} mm/s² (R {:.0} mm, {:.0} mm/min)",
                1.0e3 * acceleration,
                1.0e3 * radius_m,
                6.0e4 * own.feed_m_per_s
            ));
            let mut circles = TuningCircles::on(session, &own);
            found = at_one_acceleration(stand, &mut circles)?;
            all += circles.count;
        }
        for (table, pulses) in tables.iter_mut().zip(found) {
            if let Some(pulses) = pulses {
                put(table, place, &pulses);
            }
        }
    }
    tables.iter_mut().for_each(fill);
    Ok((tables, all))
}

/// A point without a burst has the times of the nearest one that has: between the two the drive
/// goes from one to the other.
fn fill(table: &mut Adaptive) {
    let has_height = |place: &usize| table.forward_m_per_s[*place] != 0.0;
    let tuned: Vec<usize> = (0..POINTS).filter(has_height).collect();
    for place in 0..POINTS {
        let nearest = tuned.iter().min_by_key(|tuned| tuned.abs_diff(place));
        if let Some(nearest) = nearest {
            table.time_constant_s[place] = table.time_constant_s[*nearest];
            table.start_delay_s[place] = table.start_delay_s[*nearest];
        }
    }
}

fn put(table: &mut Adaptive, place: usize, pulses: &Pulses) {
    let [forward, backward] = pulses.heights_m_per_s;
    table.forward_m_per_s[place] = forward;
    table.backward_m_per_s[place] = backward;
    table.time_constant_s[place] = pulses.time_constant_s;
    table.start_delay_s[place] = pulses.start_delay_s;
}

/// The best pulses of both axes on a circle; none for an axis without a burst.
fn at_one_acceleration(
    stand: &Stand<'_>,
    circles: &mut TuningCircles<'_, '_>,
) -> Outcome<[Option<Pulses>; 2]> {
    let without = circles.run(&stand.uncompensated())?;
    let mut searches = [0, 1].map(|axis| Search::on(axis, &without, stand));
    for _ in 0..PROBES {
        let mut compensation = stand.uncompensated();
        for (axis, search) in compensation.iter_mut().zip(&searches) {
            if let Some(search) = search {
                axis.reversal = search.compensation();
            }
        }
        if compensation == stand.uncompensated() {
            break;
        }
        let with = circles.run(&compensation)?;
        for search in searches.iter_mut().flatten() {
            search.learn(&with)?;
        }
    }
    Ok(searches.map(|search| search.map(|search| search.best)))
}

/// The search on one axis.
struct Search {
    axis: usize,
    period_s: f64,
    without: Bursts,
    /// What is tried next.
    next: Pulses,
    best: Pulses,
    left_um: f64,
}

impl Search {
    fn on(axis: usize, without: &TuningCircle, stand: &Stand<'_>) -> Option<Self> {
        let start = start(&without.points, axis, without.radius_m, stand.machine)?;
        Some(Self {
            axis,
            period_s: stand.machine.period_s,
            without: bursts(without, axis),
            next: Pulses::both(&start),
            best: Pulses {
                heights_m_per_s: [0.0; 2],
                ..Pulses::both(&start)
            },
            left_um: left_um(&bursts(without, axis)),
        })
    }

    /// The pulses that are tried next, at every acceleration alike.
    fn compensation(&self) -> Compensation {
        let mut table = Adaptive::OFF;
        (0..POINTS).for_each(|place| put(&mut table, place, &self.next));
        Compensation::Adaptive(Box::new(table))
    }

    /// Takes the circle with the pulses that were tried.
    fn learn(&mut self, with: &TuningCircle) -> Outcome<()> {
        let with = bursts(with, self.axis);
        let left_um = left_um(&with);
        if left_um < self.left_um {
            (self.best, self.left_um) = (self.next, left_um);
        }
        let probe = Probe {
            without: &self.without,
            with: &with,
            pulses: self.next,
            period_s: self.period_s,
        };
        self.next = probe.best()?;
        Ok(())
    }
}

/// Radial deviations from their median behind the reversals of an axis.
fn bursts(circle: &TuningCircle, axis: usize) -> Bursts {
    let points = &circle.points;
    let all = ballbar::about_median_um(points, circle.radius_m);
    let mut bursts = Bursts::default();
    for (at, ..) in REVERSALS.into_iter().filter(|(_, of, _)| *of == axis) {
        let distances = points.iter().map(|point| apart(point.angle_rad, at));
        let nearest = distances
            .enumerate()
            .min_by(|(_, one), (_, other)| one.total_cmp(other));
        let Some((turn, _)) = nearest else { continue };
        let behind = points[turn..].iter();
        let samples = behind
            .take_while(|point| apart(point.angle_rad, at) <= BEHIND_RAD)
            .count();
        // At its far end an axis turns to negative position.
        let way = usize::from(points[turn].reference_m[axis] > 0.0);
        bursts[way] = all[turn.saturating_sub(BEFORE)..turn + samples].to_vec();
    }
    bursts
}
