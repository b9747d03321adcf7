//! Whether the controller of a record is known.
//!
//! A described law counts as known where it gives the recorded effort from the recorded positions
//! and setpoints. Two things no dataset says are found from the record: the time at which a drive
//! takes its acceleration (the one that leaves least of the record is taken), and the effort over
//! the voltage of a controller that has a voltage at its output. A law on a load that was not
//! recorded cannot be checked: it is believed.

use std::ops::Range;

use crate::record::dataset::Dataset;
use crate::record::samples::Record;
use crate::record::units::Effort;
use crate::simulate::controller::law::{Form, Law, Memory};
use crate::simulate::controller::timing::{Setpoints, TIMINGS, Timing};

/// A law fits where it leaves less than this share of the recorded effort (rms): the rest is noise
/// of the record.
pub(crate) const LARGEST_MISFIT: f64 = 0.10;
/// Rows at each end of a piece that say nothing: the setpoint beyond them is not known.
const EDGE_ROWS: usize = 3;
/// Correlation from which recorded and computed effort belong together.
const LEAST_CORRELATION: f64 = 0.7;

/// Sums over computed and recorded efforts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Products {
    computed: f64,
    cross: f64,
    recorded: f64,
}

impl Products {
    fn of(computed: &[f64], recorded: &[f64]) -> Self {
        let pairs = computed.iter().zip(recorded);
        pairs.fold(Self::default(), |sums, (c, r)| Self {
            computed: sums.computed + c * c,
            cross: sums.cross + c * r,
            recorded: sums.recorded + r * r,
        })
    }

    /// Recorded over computed.
    fn ratio(&self) -> f64 {
        self.cross / f64::max(self.computed, f64::MIN_POSITIVE)
    }

    /// The ratio, where recorded and computed effort belong together.
    fn ratio_where_related(&self) -> Option<f64> {
        (self.correlation().abs() > LEAST_CORRELATION).then(|| self.ratio())
    }

    fn correlation(&self) -> f64 {
        let both = (self.computed * self.recorded).sqrt();
        self.cross / f64::max(both, f64::MIN_POSITIVE)
    }
}

/// What is known of the controller of a dataset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Controller {
    /// The law gives the recorded effort.
    Known(Law),
    /// No law is described in full, or there are no setpoints or forces to hold it against.
    NotDescribed,
    /// What the law leaves, as a share of the recorded effort (rms), goes from row to row like
    /// noise of the record: neither known nor refuted.
    Hidden(f64),
    /// The law leaves a share of the recorded effort (rms) that no noise makes.
    Refuted(f64),
}

/// The law that a dataset describes in forces, where its training record has setpoints.
fn described(dataset: &Dataset) -> Option<Law> {
    let in_forces = dataset.effort == Effort::Force;
    let form = dataset.controller.as_ref().filter(|_| in_forces)?;
    dataset.train.reference.as_ref()?;
    Law::described(form)
}

impl Law {
    /// Recorded over computed effort where the law is described in forces and the load it closes
    /// on, if any, was recorded; `None` where they have nothing to do with each other.
    #[must_use]
    pub(crate) fn effort_over_computed(dataset: &Dataset) -> Option<f64> {
        let record = &dataset.train;
        let law = described(dataset)?.unlimited();
        if matches!(law.form, Form::Voltage { .. }) || !law.is_checkable(record) {
            return None;
        }
        let products = Products::of(&law.teacher_forced(record, Self::at_first), &record.effort);
        products.ratio_where_related()
    }

    /// Whether what it closes on was recorded.
    fn is_checkable(&self, record: &Record) -> bool {
        !(self.on_load || self.velocity_of_load) || record.load.is_some()
    }

    fn unlimited(self) -> Self {
        Self {
            limit: None,
            ..self
        }
    }

    /// The law with an effort at its output: a voltage is scaled to the recorded effort.
    fn in_efforts(self, record: &Record) -> Self {
        let Form::Voltage { gain } = self.form else {
            return self;
        };
        let computed = self.unlimited().teacher_forced(record, Self::start);
        let products = Products::of(&computed, &record.effort);
        let gain = gain * products.cross / f64::max(products.computed, f64::MIN_POSITIVE);
        Self {
            form: Form::Voltage { gain },
            ..self
        }
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
            Form::Force { gains, .. } => Form::Force { gains, timing },
            Form::Voltage { gain } => Form::Voltage { gain },
        };
        Self { form, ..self }
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
        let setpoints = Setpoints::of(record);
        let rows = 0..record.len();
        rows.map(|row| self.effort(&setpoints, &mut memory, self.measured(record, row)))
            .collect()
    }

    /// What the law leaves of the effort of a record, row by row; nothing at the ends of a piece,
    /// where the setpoint beyond is not known.
    pub(crate) fn leaves_of(&self, record: &Record) -> Vec<f64> {
        let computed = self.teacher_forced(record, Self::start);
        let pairs = record.effort.iter().zip(computed);
        let mut left: Vec<f64> = pairs.map(|(effort, computed)| effort - computed).collect();
        for piece in record.pieces() {
            let inside = piece.start + EDGE_ROWS..piece.end.saturating_sub(EDGE_ROWS);
            let ends = piece.filter(|row| !inside.contains(row));
            ends.for_each(|row| left[row] = 0.0);
        }
        left
    }

    fn misfit_on(&self, record: &Record) -> f64 {
        self.misfits_on(record).whole
    }

    fn misfits_on(&self, record: &Record) -> Misfits {
        let computed = self.teacher_forced(record, Self::start);
        let inside =
            |piece: Range<usize>| piece.start + EDGE_ROWS..piece.end.saturating_sub(EDGE_ROWS);
        let rows = record.pieces().into_iter().flat_map(inside);
        let rows: Vec<usize> = rows.collect();
        let error = |row: usize| computed[row] - record.effort[row];
        let sum = |of: &dyn Fn(usize) -> f64| rows.iter().map(|row| of(*row)).sum::<f64>();
        let all = sum(&|row| record.effort[row].powi(2)).max(f64::MIN_POSITIVE);
        let share = |square: f64| (square.max(0.0) / all).sqrt();
        Misfits {
            whole: share(sum(&|row| error(row).powi(2))),
            lasting: share(sum(&|row| error(row) * error(row - 1))),
        }
    }
}

/// What a law leaves of the recorded effort, rms, as shares of it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Misfits {
    /// All of it.
    whole: f64,
    /// What goes on from one row to the next, by the product of neighbours: white noise of the
    /// record has none of that.
    lasting: f64,
}

impl Controller {
    /// What the training record says of the law that a dataset describes.
    #[must_use]
    pub(crate) fn of(dataset: &Dataset) -> Self {
        let record = &dataset.train;
        let Some(law) = described(dataset).map(|law| law.in_efforts(record)) else {
            return Self::NotDescribed;
        };
        if !law.is_checkable(record) {
            return Self::Known(law);
        }
        let law = law.timed(record);
        let lasting = law.misfits_on(record).lasting;
        match law.misfit <= LARGEST_MISFIT {
            true => Self::Known(law),
            false if lasting <= LARGEST_MISFIT => Self::Hidden(law.misfit),
            false => Self::Refuted(law.misfit),
        }
    }

    /// The law, where it is known.
    #[must_use]
    pub(crate) const fn law(self) -> Option<Law> {
        match self {
            Self::Known(law) => Some(law),
            Self::NotDescribed | Self::Hidden(_) | Self::Refuted(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::form::ControllerForm;
    use crate::simulate::made;

    /// 40 /s, 14 kN s/m, 80 kg.
    fn controller() -> ControllerForm {
        ControllerForm {
            position_gain_per_s: Some(40.0),
            velocity_gain_n_s_per_m: Some(14_000.0),
            acceleration_feedforward_kg: Some(80.0),
            ..ControllerForm::default()
        }
    }

    /// The same gains with a voltage at the output, without feedforward.
    fn voltage(gain: f64) -> ControllerForm {
        ControllerForm {
            velocity_gain_n_s_per_m: None,
            velocity_gain_v_s_per_m: Some(gain),
            ..controller()
        }
    }

    /// A position that follows two sines a row late.
    fn late() -> Record {
        let path = made::two_sines(2000);
        let position = std::iter::once(path[0]).chain(path.iter().copied());
        Record {
            reference: Some(path.clone()),
            ..made::record(1.0e-3, position.take(path.len()).collect())
        }
    }

    /// What the described controller does, times a factor.
    fn recorded(form: &ControllerForm, factor: f64) -> Dataset {
        let (law, mut record) = (Law::described(form).unwrap(), late());
        let efforts = law.teacher_forced(&record, Law::at_first);
        record.effort = efforts.iter().map(|effort| factor * effort).collect();
        made::dataset(record, Some(form.clone()))
    }

    /// What a drive does whose feedforward weighs the rows' second differences by `acceleration`.
    fn recorded_with(acceleration: impl Fn(f64, f64) -> f64) -> Dataset {
        let mut record = late();
        let (x, period_s) = (record.reference.clone().unwrap(), record.period_s);
        let difference = |path: &[f64], row: usize| (path[row] - path[row.max(1) - 1]) / period_s;
        for row in 3..x.len() - 1 {
            let about = |row: usize| (x[row + 1] - 2.0 * x[row] + x[row - 1]) / period_s / period_s;
            let velocity = difference(&x, row) - difference(&record.position, row);
            let error = 40.0 * (x[row] - record.position[row]) + velocity;
            record.effort[row] = 14_000.0 * error + 80.0 * acceleration(about(row), about(row - 1));
        }
        made::dataset(record, Some(controller()))
    }

    #[test]
    fn whenever_the_drive_takes_its_acceleration_the_law_is_known() {
        // Shares of the newest second difference and of the one before it.
        for (timing, now, before) in [
            (Timing::Central, 0.5, 0.5),
            (Timing::Backward, 0.0, 1.0),
            (Timing::Ahead, 2.5, -1.5),
        ] {
            let dataset = recorded_with(|newest, older| now * newest + before * older);
            let law = Controller::of(&dataset).law().unwrap();
            assert!(law.misfit < 1.0e-9, "{timing:?}: {}", law.misfit);
            assert!(matches!(law.form, Form::Force { timing: found, .. } if found == timing));
        }
    }

    #[test]
    fn a_law_is_known_up_to_a_tenth_of_the_effort() {
        let form = ControllerForm {
            acceleration_feedforward_kg: None,
            ..controller()
        };
        for (factor, known) in [(0.91, true), (0.90, false), (1.11, true), (1.12, false)] {
            let law = Controller::of(&recorded(&form, factor)).law();
            assert_eq!(law.is_some(), known, "{factor} times");
            let misfit = law.map_or(0.0, |law| law.misfit);
            let wanted = if known {
                (1.0 / factor - 1.0).abs()
            } else {
                0.0
            };
            assert!((misfit - wanted).abs() < 1.0e-3, "{factor}: {misfit}");
        }
    }

    #[test]
    fn the_ends_of_a_record_say_nothing() {
        let mut dataset = recorded(&controller(), 1.0);
        let last = dataset.train.len() - 1;
        for row in [0, 1, 2, last - 2, last - 1, last] {
            dataset.train.effort[row] += 1.0e3;
        }
        assert!(Controller::of(&dataset).law().unwrap().misfit < 1.0e-9);
        for row in [3, last - 3] {
            let mut dataset = dataset.clone();
            dataset.train.effort[row] += 1.0e3;
            let law = Controller::of(&dataset).law();
            assert!(law.is_none_or(|law| law.misfit > 1.0e-3), "row {row}");
        }
    }

    #[test]
    fn what_a_law_leaves_refutes_it_unless_it_goes_from_row_to_row_like_noise() {
        let off_by = |share: f64, wave: fn(usize) -> f64| {
            let mut dataset = recorded(&controller(), 1.0);
            let efforts = &mut dataset.train.effort;
            let inside = &efforts[10..1990];
            let square = inside.iter().map(|effort| effort * effort).sum::<f64>();
            let size = share * (square / 1980.0).sqrt();
            let off = efforts.iter_mut().enumerate();
            off.for_each(|(row, effort)| *effort += size * wave(row));
            Controller::of(&dataset)
        };
        let (slow, noise) = (
            |row: usize| (0.01 * row as f64).sin(),
            |row: usize| (1.7 * (row * row % 1013) as f64).sin(),
        );
        // A wave of 1 has an rms of 0.71.
        assert!(matches!(off_by(0.13, slow), Controller::Known(law) if law.misfit > 0.08));
        assert!(matches!(off_by(0.15, slow), Controller::Refuted(share) if share < 0.12));
        assert!(matches!(off_by(0.15, noise), Controller::Hidden(share) if share > 0.1));
        assert!(matches!(off_by(0.8, noise), Controller::Hidden(share) if share > 0.4));
    }

    #[test]
    fn each_piece_of_a_record_begins_with_a_state_and_ends_of_its_own() {
        let law = Law::described(&controller()).unwrap();
        let windows = late().windows(&[0..700, 900..2000]);
        let efforts = law.teacher_forced(&windows, Law::at_first);
        let second = law.teacher_forced(&windows.part(700..1800), Law::at_first);
        assert_eq!(efforts.len(), 1800);
        assert_eq!(efforts[700..], second);
        let mut record = windows;
        record.effort = efforts;
        for row in [697, 698, 699, 700, 701, 702] {
            record.effort[row] += 1.0e3;
        }
        assert!(law.misfit_on(&record) < 1.0e-9);
        for row in [696, 703] {
            let mut record = record.clone();
            record.effort[row] += 1.0e3;
            assert!(law.misfit_on(&record) > 1.0e-3, "row {row}");
        }
    }

    #[test]
    fn a_voltage_is_scaled_to_the_recorded_effort() {
        let law = Controller::of(&recorded(&voltage(7.0), 3.0)).law().unwrap();
        assert!(matches!(law.form, Form::Voltage { gain } if (gain - 21.0).abs() < 1.0e-9));
        assert!(law.misfit < 1.0e-9);
    }

    #[test]
    fn a_law_on_a_load_that_was_not_recorded_is_believed() {
        let form = ControllerForm {
            position_sensor: Some("load".into()),
            ..controller()
        };
        let mut dataset = recorded(&controller(), 5.0);
        assert_eq!(Controller::of(&dataset).law(), None);
        dataset.controller = Some(form);
        assert_eq!(
            Controller::of(&dataset).law().map(|law| law.misfit),
            Some(0.0)
        );
        assert_eq!(Law::effort_over_computed(&dataset), None);
        dataset.train.load = Some(dataset.train.position.clone());
        assert_eq!(
            Controller::of(&dataset).law(),
            None,
            "now it can be checked"
        );
        assert!(Law::effort_over_computed(&dataset).is_some());
    }

    #[test]
    fn without_setpoints_forces_or_a_description_there_is_no_law() {
        let whole = recorded(&controller(), 1.0);
        assert!(Controller::of(&whole).law().is_some());
        let (mut silent, mut in_amperes, mut blind) = (whole.clone(), whole.clone(), whole);
        silent.controller = None;
        in_amperes.effort = Effort::Current;
        blind.train.reference = None;
        for dataset in [silent, in_amperes, blind] {
            assert_eq!(Controller::of(&dataset).law(), None);
            assert_eq!(Law::effort_over_computed(&dataset), None);
        }
    }

    #[test]
    fn the_ratio_of_recorded_to_computed_effort_shows_units_and_signs() {
        for factor in [-1.0, 0.001, 4.5] {
            let ratio = Law::effort_over_computed(&recorded(&controller(), factor)).unwrap();
            assert!(
                (ratio / factor - 1.0).abs() < 1.0e-9,
                "{ratio}, not {factor}"
            );
        }
        let limited = ControllerForm {
            force_limit_n: Some(1.0),
            ..controller()
        };
        let mut dataset = recorded(&controller(), 2.0);
        dataset.controller = Some(limited);
        let ratio = Law::effort_over_computed(&dataset).unwrap();
        assert!((ratio - 2.0).abs() < 1.0e-9, "the limit is left out");
        assert_eq!(
            Law::effort_over_computed(&recorded(&voltage(7.0), 2.0)),
            None
        );
    }

    #[test]
    fn efforts_that_hardly_go_together_have_no_ratio() {
        // Correlations 1/√(1 + w²) of a wave with itself and w times another one.
        let products = |w: f64| Products {
            computed: 2.0,
            cross: 2.0,
            recorded: 2.0 + 2.0 * w * w,
        };
        for (w, correlation) in [(0.0, 1.0), (1.0, 0.5_f64.sqrt()), (2.0, 0.2_f64.sqrt())] {
            assert!((products(w).correlation() - correlation).abs() < 1.0e-15);
        }
        // 1/√(1 + 1.01²) = 0.7036, 1/√(1 + 1.03²) = 0.6966.
        assert_eq!(products(1.01).ratio_where_related(), Some(1.0));
        assert_eq!(products(1.03).ratio_where_related(), None);
        let swapped = Products {
            cross: -2.0,
            ..products(0.5)
        };
        assert_eq!(swapped.ratio_where_related(), Some(-1.0));
        let sums = Products::of(&[1.0, 2.0], &[3.0, -5.0]);
        assert_eq!(
            (sums.computed, sums.cross, sums.recorded),
            (5.0, -7.0, 34.0)
        );
        assert_eq!(sums.ratio(), -1.4);
    }
}
