//! The control law: the effort of a row from the setpoints and a measured position.
//!
//! Two forms, with the measured position q, the period T and the position error `Kp (r − q)`:
//! - *force*: `F = Kv (e + Ki Σ e T) + aff·a_ref`, `e = Kp (r − q) + v_ref − v_f`. The velocity v_f
//!   follows the difference quotient of the position by the share `velocity_filter` a row;
//!   setpoint velocity and acceleration: [`timing`](super::timing);
//!
//!   A drive with a load scale closes the position loop on the load, and often the velocity loop on
//!   the motor: then v_f is of the motor's position.
//! - *voltage*: `V = Kv (Kp (r − q) − v)`, with v from a two-sample mean of the position, then
//!   differenced: `v_n = (q_n − q_{n−2})/2T`.
//!
//! The limit of the effort acts last.

use crate::record::form::ControllerForm;
use crate::record::samples::Record;
use crate::simulate::controller::timing::{Setpoints, Timing};

/// Rows from which the integral at the start is estimated: their mean is what counts, so that
/// quantisation does not.
const START_ROWS: usize = 50;

/// Gains of a controller with a force at its output.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Gains {
    /// Kv, effort over velocity.
    pub velocity: f64,
    /// Ki, 1/s.
    pub integral_per_s: f64,
    /// Share of the new difference quotient in the velocity.
    pub filter: f64,
    /// Acceleration feedforward, mass.
    pub feedforward: f64,
}

/// Form and gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Form {
    /// A force at the output.
    Force {
        /// Gains.
        gains: Gains,
        /// When it takes its acceleration.
        timing: Timing,
    },
    /// A voltage at the output.
    Voltage {
        /// Kv, effort over velocity.
        gain: f64,
    },
}

/// A control law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Law {
    /// Form and gains.
    pub form: Form,
    /// Kp, 1/s.
    pub position_gain: f64,
    /// Limit of the effort.
    pub limit: Option<f64>,
    /// Whether it closes the position loop on the load.
    pub on_load: bool,
    /// Whether it takes the velocity of the load.
    pub velocity_of_load: bool,
    /// Rms of recorded − computed effort, as a share of the recorded one; zero where the load that
    /// it closes on was not recorded.
    pub misfit: f64,
}

/// State of a law.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Memory {
    /// Position of which the velocity is taken, one and two rows ago.
    before: [f64; 2],
    /// Filtered velocity.
    velocity: f64,
    /// Σ e T.
    sum: f64,
}

/// A row of a record with what the controller measures there.
#[derive(Clone, Copy)]
pub(crate) struct Measured {
    /// Row.
    pub row: usize,
    /// Position.
    pub position: f64,
    /// Position of which the velocity is taken.
    pub turned: f64,
}

impl Law {
    /// The law that a dataset describes; `None` where a gain is missing.
    #[must_use]
    pub(crate) fn described(form: &ControllerForm) -> Option<Self> {
        let force = form.velocity_gain_n_s_per_m.map(|velocity| Form::Force {
            gains: Gains {
                velocity,
                integral_per_s: form.integral_per_s.unwrap_or(0.0),
                filter: form.velocity_filter.unwrap_or(1.0),
                feedforward: form.acceleration_feedforward_kg.unwrap_or(0.0),
            },
            timing: Timing::Central,
        });
        let voltage = form.velocity_gain_v_s_per_m;
        let is_load = |sensor: &str| sensor == "load";
        let on_load = form.position_sensor.as_deref().is_some_and(is_load);
        Some(Self {
            form: force.or(voltage.map(|gain| Form::Voltage { gain }))?,
            position_gain: form.position_gain_per_s?,
            limit: form.force_limit_n,
            on_load,
            velocity_of_load: form.velocity_sensor.as_deref().map_or(on_load, is_load),
            misfit: 0.0,
        })
    }

    /// What it measures of a motor and a load in a row.
    #[inline]
    #[must_use]
    pub(crate) const fn sees(&self, row: usize, motor: f64, load: f64) -> Measured {
        Measured {
            row,
            position: if self.on_load { load } else { motor },
            turned: if self.velocity_of_load { load } else { motor },
        }
    }

    /// What it measured in a row of a record.
    #[must_use]
    pub(crate) fn measured(&self, record: &Record, row: usize) -> Measured {
        let motor = record.position[row];
        let load = record.load.as_ref().map_or(motor, |load| load[row]);
        self.sees(row, motor, load)
    }

    /// State at the first row, with nothing in the integral: the axis came at the velocity that it
    /// goes on with.
    #[must_use]
    pub(crate) fn at_first(&self, record: &Record) -> Memory {
        if record.len() < 2 {
            return Memory::default();
        }
        let [first, second] = [0, 1].map(|row| self.measured(record, row).turned);
        let step = second - first;
        Memory {
            before: [first - step, first - 2.0 * step],
            velocity: step / record.period_s,
            sum: 0.0,
        }
    }

    /// State at the start of a record: the integral is what its first efforts show.
    #[must_use]
    pub(crate) fn start(&self, record: &Record) -> Memory {
        let start = self.at_first(record);
        let Form::Force { gains, .. } = self.form else {
            return start;
        };
        if gains.integral_per_s == 0.0 {
            return start;
        }
        let rows = START_ROWS.min(record.len());
        let missing = self.missing(record, rows, start);
        Memory {
            sum: missing / (rows as f64 * gains.velocity * gains.integral_per_s),
            ..start
        }
    }

    /// Sum of the recorded effort that it does not give in the first rows.
    fn missing(&self, record: &Record, rows: usize, mut memory: Memory) -> f64 {
        let setpoints = Setpoints::of(record);
        let mut missing = |row: usize| {
            let seen = self.measured(record, row);
            record.effort[row] - self.effort(&setpoints, &mut memory, seen)
        };
        (0..rows).map(&mut missing).sum()
    }

    /// The effort of a row.
    #[inline]
    pub(crate) fn effort(
        &self,
        setpoints: &Setpoints<'_>,
        memory: &mut Memory,
        now: Measured,
    ) -> f64 {
        let error = self.position_gain * (setpoints.position(now.row) - now.position);
        let effort = match self.form {
            Form::Voltage { gain } => {
                let velocity = (now.turned - memory.before[1]) / (2.0 * setpoints.period_s());
                gain * (error - velocity)
            }
            Form::Force { gains, timing } => {
                let error = memory.velocity_error(&gains, setpoints, now, error);
                let acceleration = setpoints.acceleration(timing, now.row);
                let inner = error + gains.integral_per_s * memory.sum;
                gains.velocity * inner + gains.feedforward * acceleration
            }
        };
        memory.before = [now.turned, memory.before[0]];
        self.limit
            .map_or(effort, |limit| effort.clamp(-limit, limit))
    }
}

impl Memory {
    /// Filters the velocity, and gives the error of the velocity loop; the integral follows it.
    #[inline]
    fn velocity_error(
        &mut self,
        gains: &Gains,
        setpoints: &Setpoints<'_>,
        now: Measured,
        position_error: f64,
    ) -> f64 {
        let period_s = setpoints.period_s();
        let quotient = (now.turned - self.before[0]) / period_s;
        self.velocity += gains.filter * (quotient - self.velocity);
        let error = position_error + setpoints.velocity(now.row) - self.velocity;
        self.sum += error * period_s;
        error
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::made;

    /// Rows of 0.5 s.
    fn record(reference: &[f64], position: &[f64], effort: f64) -> Record {
        Record {
            reference: Some(reference.to_vec()),
            effort: vec![effort; position.len()],
            ..made::record(0.5, position.to_vec())
        }
    }

    fn law(form: Form) -> Law {
        Law {
            form,
            position_gain: 4.0,
            limit: None,
            on_load: false,
            velocity_of_load: false,
            misfit: 0.0,
        }
    }

    fn force(gains: Gains) -> Law {
        law(Form::Force {
            gains,
            timing: Timing::Backward,
        })
    }

    /// Efforts along the positions of a record.
    fn efforts(law: &Law, record: &Record) -> Vec<f64> {
        let (setpoints, mut memory) = (Setpoints::of(record), law.at_first(record));
        let rows = 0..record.len();
        rows.map(|row| law.effort(&setpoints, &mut memory, law.measured(record, row)))
            .collect()
    }

    const FORCE: Gains = Gains {
        velocity: 10.0,
        integral_per_s: 0.0,
        filter: 1.0,
        feedforward: 0.0,
    };

    #[test]
    fn the_velocity_loop_gets_position_error_setpoint_velocity_and_velocity() {
        let record = record(&[1.0, 2.0, 4.0], &[0.0, 1.0, 1.5], 0.0);
        // 4 (r − q) + v_ref − v: 4 + 2 − 2, 4 + 2 − 2, 10 + 4 − 1.
        assert_eq!(efforts(&force(FORCE), &record), [40.0, 40.0, 130.0]);
    }

    #[test]
    fn the_velocity_follows_its_filter() {
        let gains = Gains {
            filter: 0.25,
            ..FORCE
        };
        let record = record(&[0.0; 3], &[0.0, 1.0, 1.5], 0.0);
        // v_f: 2, 2, 2 + 0.25 (1 − 2).
        assert_eq!(efforts(&force(gains), &record), [-20.0, -60.0, -77.5]);
    }

    #[test]
    fn the_integral_holds_the_present_error_too() {
        let gains = Gains {
            integral_per_s: 0.2,
            ..FORCE
        };
        let record = record(&[1.0; 3], &[0.0, 0.0, 0.5], 0.0);
        // e: 4, 4, 2 − 1; Σ e T: 2, 4, 4.5.
        assert_eq!(efforts(&force(gains), &record), [44.0, 48.0, 19.0]);
    }

    #[test]
    fn the_feedforward_is_mass_times_acceleration_in_every_row() {
        let gains = Gains {
            velocity: 0.0,
            feedforward: 3.0,
            ..FORCE
        };
        // Second differences 0, 8, 16 about rows 0, 1, 2; backward: a row later.
        let record = record(&[0.0, 1.0, 4.0, 11.0], &[0.0; 4], 0.0);
        assert_eq!(efforts(&force(gains), &record), [0.0, 0.0, 24.0, 48.0]);
    }

    #[test]
    fn a_voltage_law_takes_its_velocity_over_two_rows() {
        let record = record(&[1.0; 4], &[0.0, 0.0, 1.0, 3.0], 0.0);
        let law = law(Form::Voltage { gain: 10.0 });
        // 4 (1 − q) − (q_n − q_{n−2})/1 s.
        assert_eq!(efforts(&law, &record), [40.0, 40.0, -10.0, -110.0]);
    }

    #[test]
    fn the_limit_acts_on_both_sides() {
        let record = record(&[1.0, -1.0, 0.0], &[0.0; 3], 0.0);
        let law = Law {
            limit: Some(15.0),
            ..law(Form::Voltage { gain: 10.0 })
        };
        assert_eq!(efforts(&law, &record), [15.0, -15.0, 0.0]);
    }

    #[test]
    fn at_the_first_row_the_axis_came_as_it_goes_on() {
        let memory = force(FORCE).at_first(&record(&[0.0; 2], &[3.0, 4.0], 0.0));
        let wanted = Memory {
            before: [2.0, 1.0],
            velocity: 2.0,
            sum: 0.0,
        };
        assert_eq!(memory, wanted);
    }

    #[test]
    fn the_integral_at_the_start_is_the_effort_that_nothing_else_gives() {
        let gains = Gains {
            integral_per_s: 0.2,
            ..FORCE
        };
        // At rest on the setpoint, 6 of effort: Σ e T = 6/(10·0.2).
        let still = |rows: usize, effort| record(&vec![1.0; rows], &vec![1.0; rows], effort);
        for rows in [2, 50, 80] {
            let start = force(gains).start(&still(rows, 6.0));
            assert!(
                (start.sum - 3.0).abs() < 1.0e-12,
                "{rows} rows: {}",
                start.sum
            );
        }
        // Only the first fifty rows count.
        let mut late = still(80, 6.0);
        late.effort[50..].fill(600.0);
        assert!((force(gains).start(&late).sum - 3.0).abs() < 1.0e-12);
        late.effort[49] = 600.0;
        assert!(force(gains).start(&late).sum > 3.1);
    }

    #[test]
    fn a_law_without_an_integral_starts_with_nothing_in_it() {
        let record = record(&[1.0; 60], &[1.0; 60], 6.0);
        for law in [force(FORCE), law(Form::Voltage { gain: 10.0 })] {
            assert_eq!(law.start(&record), law.at_first(&record));
        }
    }

    #[test]
    fn a_law_on_the_load_measures_the_load_where_it_was_recorded() {
        let mut record = record(&[0.0; 2], &[3.0, 4.0], 0.0);
        record.load = Some(vec![5.0, 6.0]);
        let on_load = Law {
            on_load: true,
            ..force(FORCE)
        };
        let seen = |law: &Law, record: &Record| {
            let Measured {
                position, turned, ..
            } = law.measured(record, 1);
            (position, turned)
        };
        let both = Law {
            velocity_of_load: true,
            ..on_load
        };
        assert_eq!(seen(&both, &record), (6.0, 6.0));
        assert_eq!(seen(&on_load, &record), (6.0, 4.0));
        assert_eq!(seen(&force(FORCE), &record), (4.0, 4.0));
        record.load = None;
        assert_eq!(seen(&both, &record), (4.0, 4.0));
    }

    #[test]
    fn the_velocity_is_that_of_the_position_sensor_unless_another_is_described() {
        let law = |position: Option<&str>, velocity: Option<&str>| {
            let law = Law::described(&ControllerForm {
                position_gain_per_s: Some(4.0),
                velocity_gain_n_s_per_m: Some(10.0),
                position_sensor: position.map(String::from),
                velocity_sensor: velocity.map(String::from),
                ..ControllerForm::default()
            });
            law.map(|law| (law.on_load, law.velocity_of_load)).unwrap()
        };
        assert_eq!(law(None, None), (false, false));
        assert_eq!(law(Some("load"), None), (true, true));
        assert_eq!(law(Some("load"), Some("motor")), (true, false));
        assert_eq!(law(Some("motor"), Some("load")), (false, true));
    }

    #[test]
    fn a_described_law_has_what_the_form_says_and_the_usual_rest() {
        let form = ControllerForm {
            position_gain_per_s: Some(4.0),
            velocity_gain_n_s_per_m: Some(10.0),
            ..ControllerForm::default()
        };
        let described = Law::described(&form).unwrap();
        let usual = Form::Force {
            gains: FORCE,
            timing: Timing::Central,
        };
        assert_eq!(described, law(usual));
        let voltage = ControllerForm {
            velocity_gain_n_s_per_m: None,
            velocity_gain_v_s_per_m: Some(7.0),
            force_limit_n: Some(9.0),
            position_sensor: Some("load".into()),
            ..form.clone()
        };
        let wanted = Law {
            limit: Some(9.0),
            on_load: true,
            velocity_of_load: true,
            ..law(Form::Voltage { gain: 7.0 })
        };
        assert_eq!(Law::described(&voltage), Some(wanted));
    }

    #[test]
    fn without_a_gain_there_is_no_law() {
        let none = ControllerForm::default();
        let half = ControllerForm {
            velocity_gain_n_s_per_m: Some(10.0),
            ..ControllerForm::default()
        };
        assert_eq!((Law::described(&none), Law::described(&half)), (None, None));
    }
}
