//! The controller of the recorded axis, as `dataset.toml` describes it.
//!
//! A law counts as known only where it gives the recorded effort from the recorded positions and
//! setpoints (a law on a load that was not recorded is believed). Two forms:
//! - force: `F = Kv (e + Ki Σ e T) + aff·a_ref`, `e = Kp (r − q) + v_ref − v_f`, where `v_f`
//!   follows the difference quotient of the position by the share `velocity_filter` a row; `v_ref`
//!   is the backward difference of the setpoint, `a_ref` the acceleration of the setpoint at the
//!   time that its controller means: it differs from drive to drive (`Timing`), no dataset says it,
//!   and the one that leaves least of the record is taken;
//! - voltage: `V = Kv (Kp (r − q) − v)`, v from a two-sample mean, then differenced; effort over
//!   voltage is found from the record.

use std::ops::Range;

use crate::record::dataset::Dataset;
use crate::record::form::ControllerForm;
use crate::record::samples::Record;
use crate::record::units::Effort;

/// A law fits where it leaves less than this share of the recorded effort (rms): the rest is noise
/// of the record.
const LARGEST_MISFIT: f64 = 0.10;
/// Rows at each end of a piece that say nothing: the setpoint beyond them is not known.
const EDGE_ROWS: usize = 3;
/// Correlation from which recorded and computed effort belong together.
const LEAST_CORRELATION: f64 = 0.7;
/// Rows from which the integral at the start is estimated.
const START_ROWS: usize = 50;

/// Where the acceleration feedforward takes its acceleration from, in rows of the record.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Timing {
    /// Central difference of the velocity, half a row back.
    Central,
    /// Second difference of the newest three setpoints: a drive without preview.
    Backward,
    /// Second difference about the row and 1.5 times its change: a drive that has the next setpoint
    /// and looks to the middle of the cycle in which its effort acts.
    Ahead,
}

/// Every timing.
const TIMINGS: [Timing; 3] = [Timing::Central, Timing::Backward, Timing::Ahead];
/// The reference stage's middle of the torque's cycle, rows after the newest second difference.
const ROWS_AHEAD: f64 = 1.5;

impl Timing {
    /// Acceleration from the second difference about a row.
    fn acceleration(self, row: usize, about: impl Fn(usize) -> f64) -> f64 {
        let (now, before) = (about(row), about(row.saturating_sub(1)));
        match self {
            Self::Central => 0.5 * (now + before),
            Self::Backward => before,
            Self::Ahead => now + ROWS_AHEAD * (now - before),
        }
    }
}

/// Form and gains.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    Force {
        velocity_gain: f64,
        integral_per_s: f64,
        filter: f64,
        feedforward: f64,
        timing: Timing,
    },
    Voltage {
        gain: f64,
    },
}

/// A controller that reproduces the recorded effort.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Law {
    form: Form,
    position_gain: f64,
    limit: Option<f64>,
    /// Whether it closes the position loop on the load.
    pub on_load: bool,
    /// Rms of recorded − computed effort, as a share of the recorded one; zero where the load that
    /// it closes on was not recorded.
    pub misfit: f64,
}

/// State of a law.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Memory {
    before: [f64; 2],
    velocity: f64,
    sum: f64,
}

impl Law {
    /// The law of a dataset, where it is described and fits its training record.
    #[must_use]
    pub(crate) fn of(dataset: &Dataset) -> Option<Self> {
        let form = dataset
            .controller
            .as_ref()
            .filter(|_| dataset.effort == Effort::Force)?;
        let record = &dataset.train;
        record.reference.as_ref()?;
        let mut law = Self::described(form)?;
        if let Form::Voltage { gain } = law.form {
            let computed = Self { limit: None, ..law }.teacher_forced(record, Self::start);
            let sums = computed.iter().zip(&record.effort);
            let (own, cross) = sums.fold((0.0, 0.0), |(own, cross), (c, e)| {
                (own + c * c, cross + c * e)
            });
            law.form = Form::Voltage {
                gain: gain * cross / f64::max(own, f64::MIN_POSITIVE),
            };
        }
        if law.on_load && record.load.is_none() {
            // Nothing to check it by: the load was not recorded.
            return Some(law);
        }
        law = law.timed(record);
        (law.misfit <= LARGEST_MISFIT).then_some(law)
    }

    /// The same law with the timing of the feedforward that leaves least of the record.
    fn timed(self, record: &Record) -> Self {
        let laws = TIMINGS.map(|timing| {
            let law = self.with(timing);
            Self {
                misfit: law.misfit_on(record),
                ..law
            }
        });
        laws.into_iter()
            .min_by(|one, other| one.misfit.total_cmp(&other.misfit))
            .unwrap_or(self)
    }

    fn with(self, timing: Timing) -> Self {
        let form = match self.form {
            Form::Force {
                velocity_gain,
                integral_per_s,
                filter,
                feedforward,
                timing: _,
            } => Form::Force {
                velocity_gain,
                integral_per_s,
                filter,
                feedforward,
                timing,
            },
            Form::Voltage { gain } => Form::Voltage { gain },
        };
        Self { form, ..self }
    }

    /// Recorded over computed effort where the law is described in forces and the load it closes
    /// on, if any, was recorded; `None` where they have nothing to do with each other.
    #[must_use]
    pub(crate) fn effort_over_computed(dataset: &Dataset) -> Option<f64> {
        let form = dataset
            .controller
            .as_ref()
            .filter(|_| dataset.effort == Effort::Force)?;
        let record = &dataset.train;
        record.reference.as_ref()?;
        let law = Self {
            limit: None,
            ..Self::described(form)?
        };
        if matches!(law.form, Form::Voltage { .. }) || (law.on_load && record.load.is_none()) {
            return None;
        }
        let computed = law.teacher_forced(record, Self::at_first);
        let sums = computed.iter().zip(&record.effort);
        let (cc, ce, ee) = sums.fold((0.0, 0.0, 0.0), |(cc, ce, ee), (c, e)| {
            (cc + c * c, ce + c * e, ee + e * e)
        });
        let correlation = ce / f64::max((cc * ee).sqrt(), f64::MIN_POSITIVE);
        (correlation.abs() > LEAST_CORRELATION).then_some(ce / f64::max(cc, f64::MIN_POSITIVE))
    }

    fn described(form: &ControllerForm) -> Option<Self> {
        let kind = match (form.velocity_gain_n_s_per_m, form.velocity_gain_v_s_per_m) {
            (Some(velocity_gain), _) => Form::Force {
                velocity_gain,
                integral_per_s: form.integral_per_s.unwrap_or(0.0),
                filter: form.velocity_filter.unwrap_or(1.0),
                feedforward: form.acceleration_feedforward_kg.unwrap_or(0.0),
                timing: Timing::Central,
            },
            (None, Some(gain)) => Form::Voltage { gain },
            (None, None) => return None,
        };
        Some(Self {
            form: kind,
            position_gain: form.position_gain_per_s?,
            limit: form.force_limit_n,
            on_load: form.position_sensor.as_deref() == Some("load"),
            misfit: 0.0,
        })
    }

    fn measured<'a>(&self, record: &'a Record) -> &'a [f64] {
        if self.on_load {
            record.load.as_deref().unwrap_or(&record.position)
        } else {
            &record.position
        }
    }

    /// The effort from recorded positions; each piece begins with a state of its own.
    fn teacher_forced(&self, record: &Record, start: fn(&Self, &Record) -> Memory) -> Vec<f64> {
        if record.joints.is_empty() {
            return self.teacher_forced_piece(record, start(self, record));
        }
        let pieces = record.pieces().into_iter();
        let parts = pieces.map(|piece| record.part(piece));
        parts
            .flat_map(|part| self.teacher_forced_piece(&part, start(self, &part)))
            .collect()
    }

    fn teacher_forced_piece(&self, record: &Record, mut memory: Memory) -> Vec<f64> {
        let positions = self.measured(record);
        (0..record.len())
            .map(|row| self.step(record, &mut memory, row, positions[row]))
            .collect()
    }

    fn misfit_on(&self, record: &Record) -> f64 {
        let computed = self.teacher_forced(record, Self::start);
        let inside =
            |piece: Range<usize>| piece.start + EDGE_ROWS..piece.end.saturating_sub(EDGE_ROWS);
        let rows = record.pieces().into_iter().flat_map(inside);
        let pairs = rows.map(|row| (computed[row], record.effort[row]));
        let (error, all) = pairs.fold((0.0, 0.0), |(error, all), (c, e)| {
            (error + (c - e).powi(2), all + e * e)
        });
        (error / f64::max(all, f64::MIN_POSITIVE)).sqrt()
    }

    /// State at the first row, with nothing in the integral.
    fn at_first(&self, record: &Record) -> Memory {
        let positions = self.measured(record);
        let first = positions.first().copied().unwrap_or(0.0);
        let step = positions.get(1).map_or(0.0, |second| second - first);
        Memory {
            before: [first - step, first - 2.0 * step],
            velocity: step / record.period_s,
            sum: 0.0,
        }
    }

    /// State at the start of a record: the integral is what its first efforts show.
    #[must_use]
    pub(crate) fn start(&self, record: &Record) -> Memory {
        let positions = self.measured(record);
        let start = self.at_first(record);
        let Form::Force {
            velocity_gain,
            integral_per_s,
            ..
        } = self.form
        else {
            return start;
        };
        if integral_per_s == 0.0 {
            return start;
        }
        let rows = START_ROWS.min(record.len());
        let mut memory = start;
        let missing: f64 = (0..rows)
            .map(|row| record.effort[row] - self.step(record, &mut memory, row, positions[row]))
            .sum();
        Memory {
            sum: missing / (rows as f64 * velocity_gain * integral_per_s),
            ..start
        }
    }

    /// The effort of a row for a measured position.
    pub(crate) fn step(
        &self,
        record: &Record,
        memory: &mut Memory,
        row: usize,
        position: f64,
    ) -> f64 {
        let period_s = record.period_s;
        let reference = record.reference.as_deref().unwrap_or(&[]);
        let at = |row: usize| {
            reference
                .get(row)
                .or(reference.last())
                .copied()
                .unwrap_or(0.0)
        };
        let error = self.position_gain * (at(row) - position);
        let [one, two] = memory.before;
        memory.before = [position, one];
        let effort = match self.form {
            Form::Voltage { gain } => gain * (error - (position - two) / (2.0 * period_s)),
            Form::Force {
                velocity_gain,
                integral_per_s,
                filter,
                feedforward,
                timing,
            } => {
                memory.velocity += filter * ((position - one) / period_s - memory.velocity);
                // Beyond both ends the setpoint goes on as it was.
                let last = reference.len().saturating_sub(1).max(1);
                let slope =
                    |row: usize| (at(row.clamp(1, last)) - at(row.clamp(1, last) - 1)) / period_s;
                let acceleration =
                    timing.acceleration(row, |row| (slope(row + 1) - slope(row)) / period_s);
                let error = error + slope(row) - memory.velocity;
                memory.sum += error * period_s;
                velocity_gain * (error + integral_per_s * memory.sum) + feedforward * acceleration
            }
        };
        self.limit
            .map_or(effort, |limit| effort.clamp(-limit, limit))
    }
}
