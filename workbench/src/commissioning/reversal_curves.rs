//! The six curves of the paper's Fig. 8(a) about a reversal: setpoint, table, disturbance, drive
//! force, speed of the motor, error.
//!
//! Disturbance is what the motor has to overcome beside its inertia: `d = F − M·a`, N.

use plant_sim::Machine;

use super::reversal_run::ReversalRow;
use crate::network::master::AxisCycle;
use crate::presentation::plots::{Curve, Ink, Plot, curves};

/// Velocity and acceleration are differences over so many cycles to either side: single encoder
/// counts would be noise.
const SIDE: usize = 10;
/// Size of each picture, px.
const SIZE_PX: (f64, f64) = (540.0, 300.0);

/// A run about a reversal, its name where there are several, and its colours.
pub struct ReversalRun<'a> {
    /// Its name.
    pub name: &'a str,
    /// Colour of its curves, and of the second one where a picture has two.
    pub inks: [Ink; 2],
    /// Its cycles.
    pub rows: &'a [ReversalRow],
}

/// A value in a cycle.
type Value<'a> = &'a dyn Fn(&Reversal<'_>, usize) -> f64;

/// Setpoint and table; disturbance and drive force; speed; error: all runs over each other.
#[must_use]
pub fn six_curves(machine: &Machine, runs: &[ReversalRun<'_>]) -> Vec<String> {
    let each = |what: &str, which: usize, value: Value<'_>| -> Vec<Curve> {
        let curve = |run: &ReversalRun<'_>| {
            let name = format!("{what} {}", run.name);
            Curve::line(
                name.trim(),
                run.inks[which],
                Reversal::of(machine, run).over_time(value),
            )
        };
        runs.iter().map(curve).collect()
    };
    let turning_m = runs
        .first()
        .map_or(0.0, |run| Reversal::of(machine, run).turning_m());
    let setpoint: Value<'_> = &|at, i| 1.0e6 * (at.reference_m(i) - turning_m);
    let position = runs.first().map(|run| {
        Curve::line(
            "(1) setpoint",
            Ink::Recorded,
            Reversal::of(machine, run).over_time(setpoint),
        )
    });
    let table = each("(2) table", 0, &|at, i| 1.0e6 * (at.table_m(i) - turning_m));
    let disturbance = each("(3) disturbance", 0, &|at, i| at.disturbance_n(i));
    let drive = each("(4) drive", 1, &|at, i| at.force_n(i));
    let speed = each("(5) speed", 0, &|at, i| 1.0e3 * at.speed_m_per_s(i));
    let error = each("(6) error", 0, &|at, i| {
        1.0e6 * (at.reference_m(i) - at.table_m(i))
    });
    let picture = |title: &str, unit: &str, list: &[Curve]| {
        curves(
            &Plot::new(title, "time from the reversal, ms", unit, SIZE_PX),
            list,
        )
    };
    let position: Vec<Curve> = position.into_iter().chain(table).collect();
    vec![
        picture("Position", "µm from the turning point", &position),
        picture("Force", "N", &[disturbance, drive].concat()),
        picture("Speed of the motor", "mm/s", &speed),
        picture("Error: setpoint − table", "µm", &error),
    ]
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

impl<'a> Reversal<'a> {
    fn of(machine: &Machine, run: &ReversalRun<'a>) -> Self {
        Self {
            rows: run.rows,
            period_s: machine.period_s,
            inertia_kg: inertia_kg(machine),
        }
    }

    /// A value over the time, ms, where there are neighbours to both sides.
    fn over_time(&self, value: impl Fn(&Self, usize) -> f64) -> Vec<(f64, f64)> {
        let places = SIDE..self.rows.len().saturating_sub(SIDE);
        places
            .map(|i| (1.0e3 * self.rows[i].0, value(self, i)))
            .collect()
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
        let points = reversal.over_time(|at, i| at.reference_m(i) - at.table_m(i));
        assert_eq!(points.len(), 101 - 2 * SIDE);
        assert!((points[0].0 + 40.0).abs() < 1.0e-9);
        assert!(
            points
                .iter()
                .all(|(_, error)| (error - 3.0e-6).abs() < 1.0e-12)
        );
        assert_eq!(reversal.turning_m(), 0.0);
    }
}
