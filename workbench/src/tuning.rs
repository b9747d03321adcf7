//! Tuning of the pulse, as at a real machine: circles, and nothing else.
//!
//! Start values come from the uncompensated circle: `T_comp` from the width of the burst in time,
//! and the product Δn·T_comp (the way that the pulse adds) from the area under the following error.
//! Nelder–Mead then searches in (ln Δn·T_comp, ln T_comp): the cost is a narrow valley along
//! constant product, which these coordinates make parallel to an axis.

use std::cell::RefCell;

use argmin::core::{CostFunction, Executor, State};
use argmin::solver::neldermead::NelderMead;
use plant_sim::Machine;

use crate::ballbar::{self, CircleFigures, Point, REVERSALS};
use crate::compensation::{AxisCompensation, Compensation, Pulse};
use crate::error::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::progress;
use crate::session::{Place, Session};
use crate::trajectory::{Circle, MEASURE_FROM_RAD};

/// What tuning did.
#[derive(Clone, Debug)]
pub struct Tuned {
    /// One compensation per axis.
    pub compensation: Vec<AxisCompensation>,
    /// Burst before, per axis, µm.
    pub before_um: [f64; 2],
    /// Burst with the tuned pulse on the tuning circles, per axis, µm.
    pub after_um: [f64; 2],
    /// Circles that were run.
    pub circles: u32,
}

/// Most circles of one search.
const MOST_CIRCLES: u64 = 30;
/// The search ends when its corners differ by less than this, µm: below it is noise.
const TOLERANCE_UM: f64 = 0.05;
/// Way that the pulse adds, over the area under the burst: found on the reference machine, and only
/// a start value.
const WAY_OVER_AREA: f64 = 1.25;
/// First steps of the search in ln(way) and ln(T).
const STEPS: [f64; 2] = [0.12, 0.15];

/// Tunes the pulse of both axes at one circle.
///
/// # Errors
/// Where a circle cannot be run, the machine shows no burst, or the operator interrupts.
pub fn pulse(
    machine: &Machine,
    place: &Place,
    circle: &Circle,
    start_delay_s: f64,
    interrupt: &Interrupt,
) -> Outcome<Tuned> {
    let none = vec![AxisCompensation::default(); machine.axes.len()];
    let session = Session::connect(machine, place, TUNING_RUN, interrupt)?;
    session.perform(&none, None, |session| {
        search(
            &RefCell::new(Bench::on(session, circle)),
            machine,
            start_delay_s,
        )
    })
}

fn search(bench: &RefCell<Bench<'_, '_>>, machine: &Machine, start_delay_s: f64) -> Outcome<Tuned> {
    let mut compensation = vec![AxisCompensation::default(); machine.axes.len()];
    let points = bench.borrow_mut().points(&compensation)?;
    let before_um = axis_bursts(&bench.borrow().figures(&points));
    let circle = bench.borrow().circle;
    let starts = [0, 1].map(|axis| start(&points, axis, &circle, machine));
    for axis in 0..2 {
        let start = starts[axis].ok_or_else(|| {
            Failure::new(format!(
                "axis {}: no burst to compensate on this circle",
                machine.axes[axis].name
            ))
        })?;
        let search = Search {
            bench,
            axis,
            others: compensation.clone(),
            start_delay_s,
            failure: RefCell::new(None),
        };
        compensation[axis].reversal = Compensation::Pulse(search.run(start)?);
    }
    let tuned = bench.borrow_mut().points(&compensation)?;
    let after_um = axis_bursts(&bench.borrow().figures(&tuned));
    let circles = bench.borrow().circles;
    Ok(Tuned {
        compensation,
        before_um,
        after_um,
        circles,
    })
}

/// Largest burst of each axis.
#[must_use]
pub fn axis_bursts(figures: &CircleFigures) -> [f64; 2] {
    let of = |axis: usize| {
        let own = REVERSALS
            .iter()
            .zip(figures.peak_um)
            .filter(|((_, of, _), _)| *of == axis);
        own.map(|(_, peak)| peak).fold(0.0, f64::max)
    };
    [of(0), of(1)]
}

struct Bench<'a, 'm> {
    session: &'a mut Session<'m>,
    circle: Circle,
    backlash_m: f64,
    circles: u32,
}

impl<'a, 'm> Bench<'a, 'm> {
    /// One turn shows each reversal once; noise is far below the burst.
    fn on(session: &'a mut Session<'m>, circle: &Circle) -> Self {
        Self {
            session,
            circle: Circle {
                turns: 1,
                ..*circle
            },
            backlash_m: 0.0,
            circles: 0,
        }
    }

    fn points(&mut self, compensation: &[AxisCompensation]) -> Outcome<Vec<Point>> {
        self.session.compensate(compensation)?;
        self.circles += 1;
        self.session.circle(&self.circle)
    }

    fn figures(&self, points: &[Point]) -> CircleFigures {
        ballbar::figures(
            points,
            self.circle.radius_m,
            self.backlash_m,
            MEASURE_FROM_RAD,
        )
    }
}

/// Noise of tuning runs is another than that of the circles that judge the result.
const TUNING_RUN: u64 = 1000;

/// Start values from the burst: full width at half height, and area, of the radial deviation about
/// one reversal of an axis.
fn start(points: &[Point], axis: usize, circle: &Circle, machine: &Machine) -> Option<Pulse> {
    let window = ballbar::window_rad(circle.radius_m, 0.0);
    let (at, ..) = REVERSALS.into_iter().find(|(_, of, _)| *of == axis)?;
    let near = |angle: f64| {
        let turn = (angle - at).rem_euclid(std::f64::consts::TAU);
        turn.min(std::f64::consts::TAU - turn) <= window
    };
    let mut all: Vec<f64> = points
        .iter()
        .map(|point| ballbar::radial_um(point, circle.radius_m))
        .collect();
    let here: Vec<f64> = points
        .iter()
        .zip(&all)
        .filter(|(point, _)| near(point.angle_rad))
        .map(|(_, d)| *d)
        .collect();
    all.sort_by(f64::total_cmp);
    let median = *all.get(all.len() / 2)?;
    let burst: Vec<f64> = here.iter().map(|d| (d - median).abs()).collect();
    let peak = burst.iter().copied().fold(0.0, f64::max);
    let wide = burst.iter().filter(|d| **d > 0.5 * peak).count();
    if wide == 0 || peak < 10.0 * TOLERANCE_UM {
        return None;
    }
    let time_constant_s = machine.period_s * wide as f64;
    let area_m_s = 1.0e-6 * burst.iter().sum::<f64>() * machine.period_s;
    let way_m = WAY_OVER_AREA * machine.axes.get(axis)?.gains.position_gain_per_s * area_m_s;
    Some(Pulse {
        height_m_per_s: way_m / time_constant_s,
        time_constant_s,
        start_delay_s: 0.0,
    })
}

struct Search<'a, 'b, 'm> {
    bench: &'b RefCell<Bench<'a, 'm>>,
    axis: usize,
    others: Vec<AxisCompensation>,
    start_delay_s: f64,
    failure: RefCell<Option<Failure>>,
}

impl Search<'_, '_, '_> {
    fn run(self, start: Pulse) -> Outcome<Pulse> {
        let corner = vec![
            (start.height_m_per_s * start.time_constant_s).ln(),
            start.time_constant_s.ln(),
        ];
        let moved = |place: usize| {
            let mut corner = corner.clone();
            corner[place] += STEPS[place];
            corner
        };
        let solver = NelderMead::new(vec![corner.clone(), moved(0), moved(1)])
            .with_sd_tolerance(TOLERANCE_UM);
        let solver = solver.map_err(|error| Failure::new(error.to_string()))?;
        let executor =
            Executor::new(&self, solver).configure(|state| state.max_iters(MOST_CIRCLES));
        match executor.run() {
            Ok(result) => {
                let best = result.state().get_best_param().cloned().unwrap_or(corner);
                Ok(self.pulse(&best))
            }
            Err(error) => Err(self
                .failure
                .take()
                .unwrap_or_else(|| Failure::new(error.to_string()))),
        }
    }

    fn pulse(&self, corner: &[f64]) -> Pulse {
        let (way, time_constant_s) = (corner[0].exp(), corner[1].exp());
        Pulse {
            height_m_per_s: way / time_constant_s,
            time_constant_s,
            start_delay_s: self.start_delay_s,
        }
    }

    fn burst_um(&self, pulse: Pulse) -> Outcome<f64> {
        let mut compensation = self.others.clone();
        compensation[self.axis].reversal = Compensation::Pulse(pulse);
        let mut bench = self.bench.borrow_mut();
        let points = bench.points(&compensation)?;
        let burst = axis_bursts(&bench.figures(&points))[self.axis];
        progress::step(&format!(
            "circle {}: {:.3} mm/s, {:.1} ms: burst {burst:.2} µm",
            bench.circles,
            1.0e3 * pulse.height_m_per_s,
            1.0e3 * pulse.time_constant_s
        ));
        Ok(burst)
    }
}

impl CostFunction for &Search<'_, '_, '_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, corner: &Self::Param) -> Result<f64, argmin::core::Error> {
        let pulse = self.pulse(corner);
        if !(1.0e-4..10.0).contains(&pulse.time_constant_s) || pulse.height_m_per_s.abs() > 0.5 {
            // Outside what makes sense; no need to run a circle for it.
            return Ok(1.0e6);
        }
        self.burst_um(pulse).map_err(|failure| {
            *self.failure.borrow_mut() = Some(failure.clone());
            argmin::core::Error::msg(failure.0)
        })
    }
}
