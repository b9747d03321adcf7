//! Friction that falls faster with the speed than the velocity loop holds against: what little a
//! compensation misses grows there, with the best parameters and without any oscillation.

use std::f64::consts::TAU;

use identification::figures;
use plant_sim::Machine;
use plant_sim::machine::MachineAxis;
use serde::Serialize;

use super::feeds::{AtFeed, Feeds};
use crate::compensation::{AxisCompensation, Compensation, Model};

/// A spike of which more than this share and this much is left, µm, is not what noise leaves.
const LEFT: (f64, f64) = (0.1, 1.0);

/// Such an axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SteepFall {
    /// The axis.
    pub axis: String,
    /// How fast friction falls at most, less its viscous part, N s/m.
    pub falls_n_s_per_m: f64,
    /// Speed at which it does, m/s.
    pub speed_m_per_s: f64,
    /// Proportional gain of the velocity loop, N s/m.
    pub holds_n_s_per_m: f64,
}

/// The axes of which that is true, where circles at the slowest feed keep much of their spikes with
/// the compensation that was taken.
#[must_use]
pub fn of(machine: &Machine, taken: &[AxisCompensation], feeds: &Feeds) -> Vec<SteepFall> {
    if !feeds.run.first().is_some_and(keeps_much) {
        return Vec::new();
    }
    let axes = machine.axes.iter().zip(taken);
    axes.filter_map(|(axis, own)| match &own.reversal {
        Compensation::Model(model) => steeper_than_its_loop(axis, model),
        _ => None,
    })
    .collect()
}

fn keeps_much(at: &AtFeed) -> bool {
    at.spike_after_um > (LEFT.0 * at.spike_before_um).max(LEFT.1)
}

fn steeper_than_its_loop(axis: &MachineAxis, model: &Model) -> Option<SteepFall> {
    let loop_per_s = TAU * axis.gains.velocity_bandwidth_hz;
    let holds_n_s_per_m = loop_per_s * axis.actual.inertia().inertia;
    let (steepest, speed_m_per_s) = steepest_fall(model)?;
    // What lags falls as much less within a period of the loop. The way in which a bristle comes to
    // its level is no such help: on the reference machine with a fall at 0.35 mm/s 15 of 14 µm are
    // left at R 100 F 500 (`tune --method model`, then `circle`, 2026-11-28).
    let in_time = 1.0 / (loop_per_s * model.lag_s).hypot(1.0);
    let falls_n_s_per_m = steepest * in_time - model.viscous_n_s_per_m;
    (falls_n_s_per_m > holds_n_s_per_m).then(|| SteepFall {
        axis: axis.name.clone(),
        falls_n_s_per_m,
        speed_m_per_s,
        holds_n_s_per_m,
    })
}

/// How fast the levels of a model fall at most with the speed, N s/m, and where, m/s.
fn steepest_fall(model: &Model) -> Option<(f64, f64)> {
    let level_n = model.level_n();
    let step_m_per_s = model.span_m_per_s / (model.factor.len() - 1) as f64;
    let of_step = |(place, pair): (usize, &[f64])| {
        let fall = level_n * (pair[0] - pair[1]) / step_m_per_s;
        (fall, step_m_per_s * (place as f64 + 0.5))
    };
    let steps = model.factor.windows(2).enumerate().map(of_step);
    let falls = steps.filter(|(fall, _)| fall.is_finite());
    falls.max_by(|one, other| one.0.total_cmp(&other.0))
}

impl SteepFall {
    /// One sentence: what, how much, what to do.
    #[must_use]
    pub fn sentence(&self) -> String {
        format!(
            "axis {}: at about {:.1} mm/s friction falls by {} N s/m, and the velocity loop holds {} N s/m against it: at slow feeds what a compensation misses grows, \
             and no model takes that away; a stiffer velocity loop helps, where the screw allows it, or another lubricant",
            self.axis,
            1.0e3 * self.speed_m_per_s,
            figures::error(self.falls_n_s_per_m),
            figures::error(self.holds_n_s_per_m)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Levels of 400 N that fall by 120 N within 1.6 mm/s, most of it in the second tenth.
    fn falling() -> Model {
        let mut model = Model {
            span_m_per_s: 1.6e-3,
            viscous_n_s_per_m: 2000.0,
            ..Model::OFF
        };
        model.level_n[..2].copy_from_slice(&[100.0, 300.0]);
        model.factor = [1.0; 17];
        model.factor[..2].copy_from_slice(&[1.3, 1.25]);
        model
    }

    fn told(model: &Model, spikes_um: [f64; 2], bandwidth_hz: f64) -> Vec<SteepFall> {
        let mut machine = Machine::reference();
        for axis in &mut machine.axes {
            axis.gains.velocity_bandwidth_hz = bandwidth_hz;
        }
        let own = AxisCompensation {
            reversal: Compensation::Model(Box::new(*model)),
            ..AxisCompensation::default()
        };
        let taken = [own, AxisCompensation::default()];
        of(&machine, &taken, &Feeds::with_spike(spikes_um))
    }

    #[test]
    fn a_loop_that_is_softer_than_the_fall_is_told_where_much_is_left() {
        let [own] = &told(&falling(), [10.0, 3.0], 30.0)[..] else {
            panic!("axis X alone");
        };
        assert_eq!(own.axis, "X");
        assert!((own.falls_n_s_per_m - 998_000.0).abs() < 1.0e-6, "{own:?}");
        assert!((own.speed_m_per_s - 0.15e-3).abs() < 1.0e-12, "{own:?}");
        let wanted = "at about 0.2 mm/s friction falls by 998000 N s/m";
        assert!(own.sentence().contains(wanted), "{}", own.sentence());
    }

    #[test]
    fn nothing_is_told_of_a_stiff_loop_of_a_lag_and_where_little_is_left() {
        assert_eq!(told(&falling(), [10.0, 3.0], 300.0), []);
        assert_eq!(told(&falling(), [10.0, 0.9], 30.0), []);
        assert_eq!(told(&falling(), [f64::NAN, 3.0], 30.0).len(), 1);
        let lagging = Model {
            lag_s: 0.1,
            ..falling()
        };
        assert_eq!(told(&lagging, [10.0, 3.0], 30.0), []);
        assert_eq!(told(&Model::OFF, [10.0, 3.0], 30.0), []);
    }
}
