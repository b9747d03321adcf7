//! A record: the axis runs along its motion, and what a drive would log is written down.

use std::fmt::Write as _;
use std::io;
use std::path::Path;

use plant_sim::axis::{Axis, AxisParameters};

use super::axis::{self, LOAD_RESOLUTION_M, Measured, mass_kg, motor_resolution_m};
use super::control::{
    Controller, INTEGRAL_PER_S, POSITION_GAIN_PER_S, VELOCITY_FILTER, velocity_gain_n_s_per_m,
};
use super::draws::Draws;
use super::hidden::{foreign_n, logged_late_s};
use super::motion;
use super::plan::{Plan, Positions, Sensor};
use super::{LEAD_M, PERIOD_S};

/// Writes `train.csv`, `validate.csv` and `dataset.toml` of a plan into a folder.
///
/// # Errors
/// Where the folder cannot be written.
pub fn write(folder: &Path, plan: &Plan) -> io::Result<()> {
    let mut draws = Draws::of(plan.seed);
    let parameters = axis::parameters(plan, &mut draws);
    for name in ["train.csv", "validate.csv"] {
        let path = motion::path(plan.rows, &mut draws);
        let text = record(plan, &parameters, &path, &mut draws);
        std::fs::write(folder.join(name), text)?;
    }
    std::fs::write(
        folder.join("dataset.toml"),
        dataset(plan, mass_kg(&parameters)),
    )
}

/// Runs the axis along a path and writes the record.
fn record(plan: &Plan, parameters: &AxisParameters, path: &[f64], draws: &mut Draws) -> String {
    let seed = draws.between(0.0, 1.0e9) as u64;
    let mut axis = Axis::new(parameters.clone(), seed);
    let mut controller = Controller::new(mass_kg(parameters));
    let mut log = EffortLog::new(logged_late_s(&plan.hidden));
    let mut text = head(plan.positions);
    for row in 0..path.len() {
        let time_s = PERIOD_S * row as f64;
        let measured = Measured::of(&mut axis);
        let force_n = controller.step(path, row, measured.at(plan.closed_on));
        let recorded_n = log.shows(force_n) + plan.noise_n * draws.normal();
        let load = load_cell(plan.positions, measured.load_m);
        writeln!(
            text,
            "{time_s:.3},{:.9},{:.10}{load},{recorded_n:.2}",
            path[row], measured.motor_m
        )
        .expect("a String takes it");
        let foreign_n = foreign_n(&plan.hidden, *axis.motion(), time_s);
        axis.advance(force_n + foreign_n, PERIOD_S);
    }
    text
}

/// A log of the effort that may be late: it says what was held a time before, as the mean over a
/// cycle.
struct EffortLog {
    newest_first: Vec<f64>,
    share: f64,
}

impl EffortLog {
    fn new(late_s: f64) -> Self {
        let rows = late_s / PERIOD_S;
        Self {
            newest_first: vec![0.0; rows as usize + 2],
            share: rows.fract(),
        }
    }

    /// What stands in the row of a new effort.
    fn shows(&mut self, force_n: f64) -> f64 {
        self.newest_first.rotate_right(1);
        self.newest_first[0] = force_n;
        let oldest = self.newest_first.len() - 1;
        let (later, earlier) = (self.newest_first[oldest - 1], self.newest_first[oldest]);
        (1.0 - self.share) * later + self.share * earlier
    }
}

fn head(positions: Positions) -> String {
    let load = match positions {
        Positions::Motor => "",
        Positions::MotorAndLoad => ",load_position_m",
    };
    format!("time_s,reference_m,position_m{load},force_n\n")
}

fn load_cell(positions: Positions, load_m: f64) -> String {
    match positions {
        Positions::Motor => String::new(),
        Positions::MotorAndLoad => format!(",{load_m:.8}"),
    }
}

/// What an identification is told of the record.
fn dataset(plan: &Plan, mass_kg: f64) -> String {
    let resolution_m = motor_resolution_m();
    let load = match plan.positions {
        Positions::Motor => String::new(),
        Positions::MotorAndLoad => {
            format!("load_encoder_resolution_m = {LOAD_RESOLUTION_M:e}\n")
        }
    };
    format!(
        "name = \"seed {}\"\nsample_period_s = {PERIOD_S}\neffort_hold = \"zero-order\"\n\
         [axis]\nkind = \"linear\"\nlead_m_per_rev = {LEAD_M}\n\
         encoder_resolution_m = {resolution_m:e}\n{load}{}\
         [declared]\neffects = [\"inertia\", \"viscous\", \"coulomb\", \"offset\"]\n",
        plan.seed,
        controller_table(plan, mass_kg)
    )
}

fn controller_table(plan: &Plan, mass_kg: f64) -> String {
    let gain = velocity_gain_n_s_per_m(mass_kg);
    let sensor = match plan.closed_on {
        Sensor::Motor => "motor",
        Sensor::Load => "load",
    };
    format!(
        "[controller]\nposition_gain_per_s = {POSITION_GAIN_PER_S}\n\
         velocity_gain_n_s_per_m = {gain}\nintegral_per_s = {INTEGRAL_PER_S}\n\
         velocity_filter = {VELOCITY_FILTER}\nacceleration_feedforward_kg = {mass_kg}\n\
         position_sensor = \"{sensor}\"\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a short record of a plan says.
    fn training(plan: &Plan) -> String {
        let plan = Plan {
            rows: 1000,
            ..plan.clone()
        };
        let mut draws = Draws::of(plan.seed);
        let parameters = axis::parameters(&plan, &mut draws);
        let path = motion::path(plan.rows, &mut draws);
        record(&plan, &parameters, &path, &mut draws)
    }

    #[test]
    fn a_late_log_shows_what_was_before_and_a_prompt_one_what_is() {
        let shown = |late_s: f64| {
            let mut log = EffortLog::new(late_s);
            [1.0, 2.0, 4.0, 8.0].map(|force_n| log.shows(force_n))
        };
        assert_eq!(shown(0.0), [1.0, 2.0, 4.0, 8.0]);
        assert_eq!(shown(2.0 * PERIOD_S), [0.0, 0.0, 1.0, 2.0]);
        assert_eq!(shown(1.5 * PERIOD_S), [0.0, 0.5, 1.5, 3.0]);
    }

    #[test]
    fn a_seed_is_a_record_and_another_seed_is_another() {
        let plan = Plan::default();
        let other = Plan {
            seed: 2,
            ..plan.clone()
        };
        assert_eq!(training(&plan), training(&plan));
        assert_ne!(training(&plan), training(&other));
    }

    #[test]
    fn the_load_stands_in_the_record_only_where_it_is_recorded() {
        let plan = Plan::default();
        let both = Plan {
            positions: Positions::MotorAndLoad,
            ..plan.clone()
        };
        for (plan, columns) in [(&plan, 4), (&both, 5)] {
            let text = training(plan);
            assert_eq!(text.lines().count(), 1001);
            assert!(text.lines().all(|line| line.split(',').count() == columns));
            let is_told = dataset(plan, 700.0).contains("load_encoder_resolution_m");
            assert_eq!(is_told, columns == 5);
        }
    }

    #[test]
    fn what_has_no_name_acts_on_the_axis_all_the_same() {
        use crate::records::{Foreign, Hidden};
        let plan = Plan::default();
        for foreign in [
            Foreign::Spring { n_per_m: 400.0 },
            Foreign::Hum {
                amplitude_n: 12.0,
                hz: 0.7,
            },
            Foreign::CubicDrag { n_s3_per_m3: 1.2e4 },
        ] {
            let hidden = vec![Hidden::Foreign(foreign)];
            let disturbed = Plan {
                hidden,
                ..plan.clone()
            };
            assert_ne!(training(&disturbed), training(&plan), "{foreign:?}");
        }
    }
}
