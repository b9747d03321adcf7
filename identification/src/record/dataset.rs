//! A dataset: what is known of an axis (`dataset.toml`), and its records beside that file.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use axis_model::EffectName;

use crate::error::IdentificationError;
use crate::record::checks::{self, Purpose};
use crate::record::extent::{plateau, range, smallest_step};
use crate::record::form::{self, ControllerForm, DatasetForm};
use crate::record::reading::{self, Reading};
use crate::record::samples::Record;
use crate::record::scale_error::ScaleError;
use crate::record::units::{AxisKind, Effort, EffortHold};

type Outcome<T> = Result<T, IdentificationError>;

/// A dataset.
#[derive(Clone, Debug, PartialEq)]
pub struct Dataset {
    /// Name.
    pub name: String,
    /// Kind of axis.
    pub kind: AxisKind,
    /// Velocity above which a sample counts as moving: 1 mm/s or 0.1 rad/s where nothing is stated.
    pub moving_velocity: f64,
    /// Which effort was recorded.
    pub effort: Effort,
    /// When the effort of a row acts.
    pub hold: EffortHold,
    /// Known first-order lag between the recorded and the acting effort, s.
    pub effort_lag_s: f64,
    /// Travel per motor revolution, where it is known, m.
    pub lead_m_per_rev: Option<f64>,
    /// Resolution of the motor encoder.
    pub resolution: f64,
    /// Resolution of the load scale.
    pub load_resolution: f64,
    /// Limit of the effort: stated, or seen as a plateau of its largest value.
    pub effort_limit: Option<f64>,
    /// Controller, where it is known.
    pub controller: Option<ControllerForm>,
    /// Declared effects.
    pub declared: Vec<EffectName>,
    /// Training record.
    pub train: Record,
    /// Validation record.
    pub validate: Record,
    /// Whether the validation record is the last part of the training record's file.
    pub held_back: bool,
    /// Whether a record with a jittered clock is fitted with the low-pass of the errors all the
    /// same: the drive's velocity showed that the jitter does no harm there.
    pub full_band: bool,
    /// Whether velocity and acceleration are given back what differences lack of fast motion: the
    /// record showed that this is worth the noise that it adds.
    pub is_sharpened: bool,
    /// What the load's scale is off by, where that is a force of the size of an effect. The load's
    /// acceleration is without it, its position is as it was recorded.
    pub(crate) scale_errors: Vec<ScaleError>,
    /// What is odd in `dataset.toml` or in the records but no reason to refuse them.
    pub notes: Vec<String>,
}

/// Share of the time that is kept for validation where there is no record of its own.
const HELD_BACK: f64 = 0.3;
/// The declared model where none is given.
const USUALLY_DECLARED: [EffectName; 4] = [
    EffectName::Inertia,
    EffectName::Viscous,
    EffectName::Coulomb,
    EffectName::Offset,
];

impl Dataset {
    /// Reads a dataset folder; `validate` and `declared` replace what the folder says.
    ///
    /// # Errors
    /// What is wrong with which file, in one line.
    pub fn read(
        folder: &Path,
        validate: Option<&Path>,
        declared: Option<Vec<String>>,
    ) -> Outcome<Self> {
        check_folder(folder)?;
        let (form, mut notes) = form::read(&folder.join("dataset.toml"))?;
        let records = Records::read(folder, validate, &form)?;
        notes.extend_from_slice(&records.notes);
        for (what, record) in [
            ("training", &records.train),
            ("validation", &records.validate),
        ] {
            checks::motion(folder, what, record, &form.axis)?;
        }
        let wanted = declared.or(form.declared.as_ref().map(|d| d.effects.clone()));
        let declared = declared_effects(folder, wanted)?;
        Ok(Self::of(folder, form, records, declared, notes))
    }

    fn of(
        folder: &Path,
        form: DatasetForm,
        records: Records,
        declared: Vec<EffectName>,
        notes: Vec<String>,
    ) -> Self {
        let stated_limit = form.controller.as_ref().and_then(|c| c.force_limit_n);
        let stated_limit = stated_limit.filter(|_| records.effort == Effort::Force);
        let (resolution, load_resolution) = form.axis.resolutions();
        let train = &records.train;
        let seen_at_load = || train.load.as_deref().map_or(0.0, smallest_step);
        Self {
            name: form.name.unwrap_or_else(|| folder.display().to_string()),
            kind: form.axis.kind,
            moving_velocity: form.axis.moving_velocity(),
            effort: records.effort,
            hold: form.effort_hold,
            effort_lag_s: form.effort_lag_s.unwrap_or(0.0),
            lead_m_per_rev: form.axis.lead_m_per_rev,
            resolution: resolution.unwrap_or_else(|| smallest_step(&train.position)),
            load_resolution: load_resolution.unwrap_or_else(seen_at_load),
            effort_limit: stated_limit.or_else(|| plateau(&train.effort)),
            controller: form.controller,
            declared,
            train: records.train,
            validate: records.validate,
            held_back: records.held_back,
            full_band: false,
            is_sharpened: false,
            scale_errors: Vec::new(),
            notes,
        }
    }

    /// Way of a revolution, where it is known: of the motor on a linear axis, of the axis itself on
    /// a rotary one.
    #[must_use]
    pub(crate) const fn revolution(&self) -> Option<f64> {
        match self.kind {
            AxisKind::Linear => self.lead_m_per_rev,
            AxisKind::Rotary => Some(TAU),
        }
    }

    /// Whether an effect is declared.
    #[must_use]
    pub fn declares(&self, effect: EffectName) -> bool {
        self.declared.contains(&effect)
    }

    /// The same axis with other records.
    #[must_use]
    pub(crate) fn with_records(&self, train: Record, validate: Record) -> Self {
        Self {
            name: self.name.clone(),
            controller: self.controller.clone(),
            declared: self.declared.clone(),
            scale_errors: self.scale_errors.clone(),
            notes: self.notes.clone(),
            train,
            validate,
            ..*self
        }
    }

    /// The same axis without the drive's velocity.
    #[must_use]
    pub(crate) fn without_velocity(self) -> Self {
        let without = |record: Record| Record {
            velocity: None,
            ..record
        };
        Self {
            train: without(self.train),
            validate: without(self.validate),
            ..self
        }
    }

    /// The same axis with a remark more.
    #[must_use]
    pub(crate) fn with_note(mut self, note: String) -> Self {
        self.notes.push(note);
        self
    }

    /// Middle and half of the travel of the training record.
    #[must_use]
    pub fn travel(&self) -> (f64, f64) {
        let (low, high) = range(&self.train.position);
        (0.5 * (low + high), 0.5 * (high - low))
    }

    /// The training record with the held-back part, where they are one file.
    #[must_use]
    pub fn whole(&self) -> Option<Record> {
        self.held_back
            .then(|| self.train.followed_by(&self.validate))
    }
}

/// The two records of a folder.
struct Records {
    train: Record,
    validate: Record,
    effort: Effort,
    held_back: bool,
    /// What was left out of them.
    notes: Vec<String>,
}

impl Records {
    fn read(folder: &Path, validate: Option<&Path>, form: &DatasetForm) -> Outcome<Self> {
        let extension = if form.bus.is_some() { "log" } else { "csv" };
        let file = |stem: &str| folder.join(stem).with_extension(extension);
        let Reading {
            record: whole,
            effort,
            outliers,
        } = reading::read(&file("train"), form, Purpose::Training)?;
        let mut notes: Vec<String> = outliers.iter().map(|one| one.words("training")).collect();
        let beside = Some(file("validate")).filter(|path| path.is_file());
        let other: Option<PathBuf> = validate.map(Path::to_path_buf).or(beside);
        let (train, validate) = match &other {
            Some(path) => {
                let other = reading::read(path, form, Purpose::Validation)?;
                checks::alike(path, (&whole, effort), (&other.record, other.effort))?;
                notes.extend(other.outliers.iter().map(|one| one.words("validation")));
                (whole, other.record)
            }
            None => held_back(whole),
        };
        let (train, validate) = same_columns(train, validate);
        Ok(Self {
            train,
            validate,
            effort,
            held_back: other.is_none(),
            notes,
        })
    }
}

fn held_back(whole: Record) -> (Record, Record) {
    let kept = (whole.len() as f64 * HELD_BACK).round() as usize;
    let cut = whole.len() - kept;
    whole.split_at(cut)
}

/// A setpoint in one of two records only is of no use.
fn same_columns(mut train: Record, mut validate: Record) -> (Record, Record) {
    if train.reference.is_none() || validate.reference.is_none() {
        (train.reference, validate.reference) = (None, None);
    }
    (train, validate)
}

fn check_folder(folder: &Path) -> Outcome<()> {
    if folder.is_dir() {
        return Ok(());
    }
    Err(IdentificationError::new(format!(
        "{}: not a folder; a dataset is a folder with train.csv and dataset.toml",
        folder.display()
    )))
}

/// The declared effects, once each.
fn declared_effects(folder: &Path, wanted: Option<Vec<String>>) -> Outcome<Vec<EffectName>> {
    let refused = |why: String| IdentificationError::new(format!("{}: {why}", folder.display()));
    let Some(wanted) = wanted else {
        return Ok(USUALLY_DECLARED.to_vec());
    };
    let mut declared = Vec::new();
    for word in &wanted {
        let name = word.trim().parse::<EffectName>();
        let name = name.map_err(|unknown| refused(format!("declared: {unknown}")))?;
        if !declared.contains(&name) {
            declared.push(name);
        }
    }
    if declared.is_empty() {
        return Err(refused("no declared effects; give at least inertia".into()));
    }
    Ok(declared)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder with an axis on a sine of 10 mm at 1 kHz, 4000 rows.
    fn folder(form: &str, files: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        let mut text = String::from("time_s,position_m,reference_m,force_n\n");
        for row in 0..4000 {
            let t = 1.0e-3 * f64::from(row);
            let x = 0.01 * (3.0 * t).sin();
            text.push_str(&format!("{t},{x},{x},{}\n", (3.0 * t).cos()));
        }
        std::fs::write(folder.path().join("dataset.toml"), form).unwrap();
        for file in files {
            std::fs::write(folder.path().join(file), &text).unwrap();
        }
        folder
    }

    #[test]
    fn the_last_three_tenths_validate_where_there_is_no_record_of_its_own() {
        let alone = folder("", &["train.csv"]);
        let dataset = Dataset::read(alone.path(), None, None).unwrap();
        assert_eq!((dataset.train.len(), dataset.validate.len()), (2800, 1200));
        assert!((dataset.validate.time_s[0] - 2.8).abs() < 1.0e-9);
        assert_eq!(dataset.whole().unwrap().len(), 4000);
        let two = folder("", &["train.csv", "validate.csv"]);
        let dataset = Dataset::read(two.path(), None, None).unwrap();
        assert_eq!((dataset.train.len(), dataset.validate.len()), (4000, 4000));
        assert!(dataset.whole().is_none());
    }

    #[test]
    fn the_travel_is_half_way_to_either_end() {
        let alone = folder("", &["train.csv"]);
        let dataset = Dataset::read(alone.path(), None, None).unwrap();
        let (middle, half) = dataset.travel();
        assert!(middle.abs() < 1.0e-4 && (half - 0.01).abs() < 1.0e-4);
    }

    #[test]
    fn declared_effects_are_known_and_come_once() {
        let alone = folder(
            "[declared]\neffects = [\"inertia\", \" inertia\"]\n",
            &["train.csv"],
        );
        let read = |declared: Option<Vec<String>>| Dataset::read(alone.path(), None, declared);
        assert_eq!(read(None).unwrap().declared, [EffectName::Inertia]);
        let error = read(Some(vec!["magic".into()])).unwrap_err().to_string();
        assert!(
            error.contains("declared: unknown effect \"magic\"; known: "),
            "{error}"
        );
        let error = read(Some(Vec::new())).unwrap_err().to_string();
        assert!(error.contains("no declared effects"), "{error}");
    }

    #[test]
    fn a_stated_limit_is_one_of_the_force() {
        let form = "[controller]\nforce_limit_n = 80\n";
        let alone = folder(form, &["train.csv"]);
        let dataset = Dataset::read(alone.path(), None, None).unwrap();
        assert_eq!(dataset.effort_limit, Some(80.0));
    }
}
