//! The six curves of the paper's Fig. 8(a) about a reversal: setpoint, table, disturbance, drive
//! force, speed of the motor, error.
//!
//! Disturbance is what the motor has to overcome beside its inertia: `d = F − M·a`, N.

use plant_sim::Machine;

use super::reversal_run::ReversalRow;
use crate::error::Outcome;
use crate::network::master::AxisCycle;
use crate::presentation::plots::{self, Curve};

/// Velocity and acceleration are differences over so many cycles to either side: single encoder
/// counts would be noise.
const SIDE: usize = 10;
/// Size of each picture, px.
const SIZE: (u32, u32) = (540, 300);

/// Setpoint and table; disturbance and drive force; speed; error.
///
/// # Errors
/// Where a plot cannot be drawn.
pub fn six_curves(machine: &Machine, name: &str, rows: &[ReversalRow]) -> Outcome<Vec<String>> {
    let reversal = Reversal {
        rows,
        period_s: machine.period_s,
        inertia_kg: inertia_kg(machine),
    };
    let turning_m = reversal.turning_m();
    let [setpoint, table, disturbance, drive, speed, error] = [
        reversal.curve("(1) setpoint", |at, i| {
            1.0e6 * (at.reference_m(i) - turning_m)
        }),
        reversal.curve("(2) table", |at, i| 1.0e6 * (at.table_m(i) - turning_m)),
        reversal.curve("(3) disturbance", Reversal::disturbance_n),
        reversal.curve("(4) drive", Reversal::force_n),
        reversal.curve("speed", |at, i| 1.0e3 * at.speed_m_per_s(i)),
        reversal.curve("error", |at, i| 1.0e6 * (at.reference_m(i) - at.table_m(i))),
    ];
    let plot = |title: &str, unit: &str, curves: &[Curve]| {
        let title = format!("{title}, {name}");
        plots::curves(&title, "time from the reversal, ms", unit, SIZE, curves)
    };
    Ok(vec![
        plot("Position", "µm from the turning point", &[setpoint, table])?,
        plot("Force", "N", &[disturbance, drive])?,
        plot("(5) Speed of the motor", "mm/s", &[speed])?,
        plot("(6) Error", "µm", &[error])?,
    ])
}

/// What the motor of the first axis moves.
fn inertia_kg(machine: &Machine) -> f64 {
    machine.axes.first().map_or(0.0, |axis| {
        let mechanics = &axis.actual.mechanics;
        mechanics.motor_inertia_kg + mechanics.table_mass_kg
    })
}

/// The cycles about a reversal, and what follows from them.
struct Reversal<'a> {
    rows: &'a [ReversalRow],
    period_s: f64,
    inertia_kg: f64,
}

impl Reversal<'_> {
    /// A value over the time, ms, where there are neighbours to both sides.
    fn curve(&self, name: &str, value: impl Fn(&Self, usize) -> f64) -> Curve {
        let places = SIDE..self.rows.len().saturating_sub(SIDE);
        Curve {
            name: name.into(),
            points: places
                .map(|i| (1.0e3 * self.rows[i].0, value(self, i)))
                .collect(),
            dots: false,
        }
    }

    fn cycle(&self, i: usize) -> &AxisCycle {
        &self.rows[i].1
    }

    fn turning_m(&self) -> f64 {
        let setpoints = (0..self.rows.len()).map(|i| self.reference_m(i));
        setpoints.fold(f64::INFINITY, f64::min)
    }

    fn reference_m(&self, i: usize) -> f64 {
        self.cycle(i).reference_m
    }

    /// By an instrument at the table, or by the load scale.
    fn table_m(&self, i: usize) -> f64 {
        let cycle = self.cycle(i);
        cycle.truth.map_or(cycle.load_m, |truth| truth.table_m)
    }

    fn force_n(&self, i: usize) -> f64 {
        let cycle = self.cycle(i);
        cycle.truth.map_or(cycle.force_n, |truth| truth.force_n)
    }

    fn disturbance_n(&self, i: usize) -> f64 {
        self.force_n(i) - self.inertia_kg * self.acceleration_m_per_s2(i)
    }

    fn speed_m_per_s(&self, i: usize) -> f64 {
        (self.cycle(i + SIDE).motor_m - self.cycle(i - SIDE).motor_m) / (20.0 * self.period_s)
    }

    fn acceleration_m_per_s2(&self, i: usize) -> f64 {
        let [before, here, after] = [i - SIDE, i, i + SIDE].map(|i| self.cycle(i).motor_m);
        (after - 2.0 * here + before) / (100.0 * self.period_s * self.period_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_S: f64 = 1.0e-3;

    /// A motor that turns round with 2 m/s², driven by 30 N, and a table 3 µm behind.
    fn rows() -> Vec<ReversalRow> {
        let row = |i: i32| {
            let time_s = PERIOD_S * f64::from(i);
            let at = time_s * time_s;
            let cycle = AxisCycle {
                reference_m: at,
                motor_m: at,
                load_m: at - 3.0e-6,
                force_n: 30.0,
                is_measured: true,
                truth: None,
            };
            (time_s, cycle)
        };
        (-50..=50).map(row).collect()
    }

    #[test]
    fn what_the_drive_overcomes_is_its_force_without_the_inertia() {
        let rows = rows();
        let reversal = Reversal {
            rows: &rows,
            period_s: PERIOD_S,
            inertia_kg: 5.0,
        };
        assert!((reversal.acceleration_m_per_s2(40) - 2.0).abs() < 1.0e-9);
        assert!((reversal.disturbance_n(40) - 20.0).abs() < 1.0e-6);
        // Ten cycles before the reversal, at 2 m/s² · 10 ms.
        assert!((reversal.speed_m_per_s(40) + 0.02).abs() < 1.0e-9);
    }

    #[test]
    fn curves_begin_and_end_where_there_are_neighbours() {
        let rows = rows();
        let reversal = Reversal {
            rows: &rows,
            period_s: PERIOD_S,
            inertia_kg: 5.0,
        };
        let curve = reversal.curve("error", |at, i| at.reference_m(i) - at.table_m(i));
        assert_eq!(curve.points.len(), 101 - 2 * SIDE);
        assert!((curve.points[0].0 + 40.0).abs() < 1.0e-9);
        assert!(
            curve
                .points
                .iter()
                .all(|(_, error)| (error - 3.0e-6).abs() < 1.0e-12)
        );
        assert_eq!(reversal.turning_m(), 0.0);
    }
}
