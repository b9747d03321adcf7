//! Records: CSV with a header, SI units in the column names, and `dataset.toml` beside it.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::error::IdentificationError;
use crate::record::bus_log::BusForm;
use crate::record::table::{Mapping, Table};

type Outcome<T> = Result<T, IdentificationError>;

/// Kind of axis: tells the units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AxisKind {
    /// Metres.
    #[default]
    Linear,
    /// Radians.
    Rotary,
}

impl AxisKind {
    /// Velocity above which a sample counts as moving: 1 mm/s or 0.1 rad/s.
    #[must_use]
    pub const fn moving_velocity(self) -> f64 {
        match self {
            Self::Linear => 1.0e-3,
            Self::Rotary => 0.1,
        }
    }

    /// Suffix of position columns.
    #[must_use]
    pub const fn position_unit(self) -> &'static str {
        match self {
            Self::Linear => "m",
            Self::Rotary => "rad",
        }
    }
}

/// Which effort was recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// `force_n`.
    Force,
    /// `torque_nm`.
    Torque,
    /// `current_a`.
    Current,
}

impl Effort {
    const ALL: [Self; 3] = [Self::Force, Self::Torque, Self::Current];

    /// Name of its column.
    #[must_use]
    pub const fn column(self) -> &'static str {
        match self {
            Self::Force => "force_n",
            Self::Torque => "torque_nm",
            Self::Current => "current_a",
        }
    }

    /// Its unit.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Force => "N",
            Self::Torque => "N m",
            Self::Current => "A",
        }
    }
}

/// When the effort of a row acts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EffortHold {
    /// At the time of its row.
    #[default]
    Instant,
    /// From the time of its row until that of the next.
    ZeroOrder,
}

/// What `time_s` counts from; it matters to what warms up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum TimeFrom {
    /// Every record starts cold.
    #[default]
    Record,
    /// The machine was switched on at zero.
    PowerOn,
}

/// A record on a uniform time base.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Sample period, s.
    pub period_s: f64,
    /// Motor position.
    pub position: Vec<f64>,
    /// Load position, if it was measured.
    pub load: Option<Vec<f64>>,
    /// Setpoint, if it was recorded.
    pub reference: Option<Vec<f64>>,
    /// Effort.
    pub effort: Vec<f64>,
    /// Time of each sample since the first row of the file (or since power-on, where the file
    /// counts from there), s.
    pub time_s: Vec<f64>,
    /// The rows of the file that this record was made from: time stamp and effort as they stand
    /// there.
    pub rows: Vec<(f64, f64)>,
    /// Whether the time stamps jittered, so that the samples were interpolated.
    pub jittered: bool,
    /// Samples that stand in a hole of the file and were interpolated; they are not fitted.
    pub interpolated: Vec<bool>,
}

impl Record {
    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// Whether there is nothing in it.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }

    /// A part of the record; time goes on from the whole.
    #[must_use]
    pub fn part(&self, range: std::ops::Range<usize>) -> Self {
        let cut = |values: &[f64]| values[range.clone()].to_vec();
        Self {
            period_s: self.period_s,
            position: cut(&self.position),
            load: self.load.as_deref().map(cut),
            reference: self.reference.as_deref().map(cut),
            effort: cut(&self.effort),
            time_s: cut(&self.time_s),
            rows: self.rows_between(range.start, range.end),
            interpolated: self.interpolated[range.clone()].to_vec(),
            jittered: self.jittered,
        }
    }

    /// Rows of the file that fall into a range of samples.
    fn rows_between(&self, from: usize, to: usize) -> Vec<(f64, f64)> {
        let origin = self.rows.first().map_or(0.0, |row| row.0)
            - self.time_s.first().copied().unwrap_or(0.0);
        let half = 0.5 * self.period_s;
        let low = self.time_s.get(from).map_or(f64::INFINITY, |t| t - half);
        let high = self.time_s.get(to).map_or(f64::INFINITY, |t| t - half);
        self.rows
            .iter()
            .copied()
            .filter(|(t, _)| (low..high).contains(&(t - origin)))
            .collect()
    }
}

#[derive(Clone, Debug, Default, Deserialize)]
struct DatasetForm {
    name: Option<String>,
    sample_period_s: Option<f64>,
    #[serde(default)]
    effort_hold: EffortHold,
    effort_lag_s: Option<f64>,
    #[serde(default)]
    time_from: TimeFrom,
    #[serde(default)]
    columns: Mapping,
    bus: Option<BusForm>,
    axis: Option<AxisForm>,
    controller: Option<ControllerForm>,
    declared: Option<DeclaredForm>,
}

/// The controller of the recorded axis, where it is known.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
pub struct ControllerForm {
    /// Position gain, 1/s.
    pub position_gain_per_s: Option<f64>,
    /// Velocity gain, N·s/m.
    pub velocity_gain_n_s_per_m: Option<f64>,
    /// Velocity gain of a controller with a voltage at its output, V·s/m.
    pub velocity_gain_v_s_per_m: Option<f64>,
    /// Integral gain of the velocity loop, 1/s.
    pub integral_per_s: Option<f64>,
    /// Share of the new difference quotient in the velocity.
    pub velocity_filter: Option<f64>,
    /// Acceleration feedforward, kg.
    pub acceleration_feedforward_kg: Option<f64>,
    /// Limit of the force, N.
    pub force_limit_n: Option<f64>,
    /// `motor` or `load`.
    pub position_sensor: Option<String>,
}

#[derive(Clone, Debug, Default, Deserialize)]
struct AxisForm {
    #[serde(default)]
    kind: AxisKind,
    lead_m_per_rev: Option<f64>,
    encoder_resolution_m: Option<f64>,
    encoder_resolution_rad: Option<f64>,
    load_encoder_resolution_m: Option<f64>,
    load_encoder_resolution_rad: Option<f64>,
}

#[derive(Clone, Debug, Default, Deserialize)]
struct DeclaredForm {
    #[serde(default)]
    effects: Vec<String>,
}

/// A dataset: what is known of the axis, and its records.
#[derive(Clone, Debug, PartialEq)]
pub struct Dataset {
    /// Name.
    pub name: String,
    /// Kind of axis.
    pub kind: AxisKind,
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
    pub declared: Vec<String>,
    /// Training record.
    pub train: Record,
    /// Validation record.
    pub validate: Record,
    /// Whether the validation record is the last part of the training record's file.
    pub held_back: bool,
    /// What is odd in `dataset.toml` but no reason to refuse it.
    pub notes: Vec<String>,
}

/// Share of the time that is kept for validation where there is no record of its own.
pub(crate) const HELD_BACK: f64 = 0.3;
/// Fewest rows of a training record: the filter's ends (2 × 200) and a few blocks.
pub(crate) const FEWEST_ROWS: usize = 2000;

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
        if !folder.is_dir() {
            return Err(IdentificationError::new(format!(
                "{}: not a folder; a dataset is a folder with train.csv and dataset.toml",
                folder.display()
            )));
        }
        let (form, notes) = read_form(&folder.join("dataset.toml"))?;
        check_form(folder, &form)?;
        let axis = form.axis.clone().unwrap_or_default();
        let file = |stem: &str| {
            let extension = if form.bus.is_some() { "log" } else { "csv" };
            folder.join(stem).with_extension(extension)
        };
        let (whole, effort) = read_record(&file("train"), axis.kind, &form)?;
        let beside = file("validate");
        let other: Option<PathBuf> = validate
            .map(Path::to_path_buf)
            .or_else(|| beside.is_file().then_some(beside));
        let (mut train, mut validation, held_back) = match other {
            Some(path) => {
                let (validation, validation_effort) = read_record(&path, axis.kind, &form)?;
                check_pair(&path, &whole, effort, &validation, validation_effort)?;
                (whole, validation, false)
            }
            None => {
                let cut = whole.len() - (whole.len() as f64 * HELD_BACK).round() as usize;
                (whole.part(0..cut), whole.part(cut..whole.len()), true)
            }
        };
        if train.reference.is_none() || validation.reference.is_none() {
            // A setpoint in one of them only is of no use.
            (train.reference, validation.reference) = (None, None);
        }
        for (what, record) in [("training", &train), ("validation", &validation)] {
            check_motion(folder, what, record, axis.kind)?;
        }
        let stated_limit = form
            .controller
            .as_ref()
            .and_then(|c| c.force_limit_n)
            .filter(|_| effort == Effort::Force);
        let (resolution, load_resolution) = match axis.kind {
            AxisKind::Linear => (axis.encoder_resolution_m, axis.load_encoder_resolution_m),
            AxisKind::Rotary => (
                axis.encoder_resolution_rad,
                axis.load_encoder_resolution_rad,
            ),
        };
        Ok(Self {
            name: form.name.unwrap_or_else(|| folder.display().to_string()),
            kind: axis.kind,
            effort,
            hold: form.effort_hold,
            effort_lag_s: form.effort_lag_s.unwrap_or(0.0),
            lead_m_per_rev: axis.lead_m_per_rev,
            resolution: resolution.unwrap_or_else(|| smallest_step(&train.position)),
            load_resolution: load_resolution
                .unwrap_or_else(|| train.load.as_deref().map_or(0.0, smallest_step)),
            effort_limit: stated_limit.or_else(|| plateau(&train.effort)),
            controller: form.controller,
            declared: check_declared(
                folder,
                declared.or(form.declared.map(|declared| declared.effects)),
            )?,
            train,
            validate: validation,
            held_back,
            notes,
        })
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
        self.held_back.then(|| {
            let join = |a: &[f64], b: &[f64]| [a, b].concat();
            let both = |a: &Option<Vec<f64>>, b: &Option<Vec<f64>>| {
                a.as_deref().zip(b.as_deref()).map(|(a, b)| join(a, b))
            };
            Record {
                position: join(&self.train.position, &self.validate.position),
                load: both(&self.train.load, &self.validate.load),
                reference: both(&self.train.reference, &self.validate.reference),
                effort: join(&self.train.effort, &self.validate.effort),
                time_s: join(&self.train.time_s, &self.validate.time_s),
                rows: [&self.train.rows[..], &self.validate.rows[..]].concat(),
                interpolated: [
                    &self.train.interpolated[..],
                    &self.validate.interpolated[..],
                ]
                .concat(),
                ..self.train.clone()
            }
        })
    }
}

fn read_form(path: &Path) -> Outcome<(DatasetForm, Vec<String>)> {
    let text = std::fs::read_to_string(path).map_err(|error| {
        IdentificationError::new(format!(
            "{}: {error}; a dataset needs this file",
            path.display()
        ))
    })?;
    let notes = slips(path, &text);
    let form: DatasetForm = toml::from_str(&text).map_err(|error| {
        let line = error.span().map_or(0, |span| {
            text.get(..span.start)
                .map_or(0, |before| before.matches('\n').count())
                + 1
        });
        IdentificationError::new(format!("{}:{line}: {}", path.display(), error.message()))
    })?;
    Ok((form, notes))
}

/// Keys that mean something; others are kept for people (source, licence, notes).
const KEYS: [(&str, &[&str]); 4] = [
    (
        "",
        &[
            "name",
            "sample_period_s",
            "effort_hold",
            "effort_lag_s",
            "time_from",
            "columns",
            "bus",
            "axis",
            "controller",
            "declared",
        ],
    ),
    (
        "axis",
        &[
            "kind",
            "lead_m_per_rev",
            "encoder_resolution_m",
            "encoder_resolution_rad",
            "load_encoder_resolution_m",
            "load_encoder_resolution_rad",
        ],
    ),
    (
        "controller",
        &[
            "position_gain_per_s",
            "velocity_gain_n_s_per_m",
            "velocity_gain_v_s_per_m",
            "integral_per_s",
            "velocity_filter",
            "acceleration_feedforward_kg",
            "force_limit_n",
            "position_sensor",
        ],
    ),
    ("declared", &["effects"]),
];
/// Edits between a key and one that was meant, and the shortest key that is asked: short words are
/// near each other (`note` and `name`).
const TYPO: usize = 2;
const SHORTEST_KEY: usize = 7;

/// Keys that are nearly one that we know: slips of the pen, which would be ignored without a word.
fn slips(path: &Path, text: &str) -> Vec<String> {
    let Ok(table) = text.parse::<toml::Table>() else {
        return Vec::new();
    };
    let mut notes = Vec::new();
    for (section, known) in KEYS {
        let part = if section.is_empty() {
            Some(&table)
        } else {
            table.get(section).and_then(toml::Value::as_table)
        };
        for key in part
            .into_iter()
            .flat_map(|part| part.keys())
            .filter(|key| !known.contains(&key.as_str()))
        {
            let near = |known: &&&str| strsim::damerau_levenshtein(key, known) <= TYPO;
            if let Some(meant) = known
                .iter()
                .filter(|_| key.len() >= SHORTEST_KEY)
                .find(near)
            {
                let line = text
                    .lines()
                    .position(|line| line.trim_start().starts_with(key.as_str()))
                    .map_or(0, |at| at + 1);
                notes.push(format!(
                    "{}:{line}: key {key} is not known and was ignored; did you mean {meant}?",
                    path.display()
                ));
            }
        }
    }
    notes
}

fn check_form(folder: &Path, form: &DatasetForm) -> Outcome<()> {
    let axis = form.axis.clone().unwrap_or_default();
    let controller = form.controller.clone().unwrap_or_default();
    let positive = [
        ("sample_period_s", form.sample_period_s, 1.0e-6, 1.0),
        ("effort_lag_s", form.effort_lag_s, 0.0, 0.1),
        ("lead_m_per_rev", axis.lead_m_per_rev, 1.0e-5, 1.0),
        (
            "encoder_resolution_m",
            axis.encoder_resolution_m,
            0.0,
            1.0e-2,
        ),
        (
            "encoder_resolution_rad",
            axis.encoder_resolution_rad,
            0.0,
            1.0,
        ),
        (
            "load_encoder_resolution_m",
            axis.load_encoder_resolution_m,
            0.0,
            1.0e-2,
        ),
        (
            "load_encoder_resolution_rad",
            axis.load_encoder_resolution_rad,
            0.0,
            1.0,
        ),
        (
            "position_gain_per_s",
            controller.position_gain_per_s,
            0.0,
            1.0e6,
        ),
        (
            "velocity_gain_n_s_per_m",
            controller.velocity_gain_n_s_per_m,
            0.0,
            1.0e12,
        ),
        (
            "velocity_gain_v_s_per_m",
            controller.velocity_gain_v_s_per_m,
            0.0,
            1.0e12,
        ),
        ("integral_per_s", controller.integral_per_s, 0.0, 1.0e6),
        ("velocity_filter", controller.velocity_filter, 1.0e-6, 1.0),
        (
            "acceleration_feedforward_kg",
            controller.acceleration_feedforward_kg,
            0.0,
            1.0e9,
        ),
        ("force_limit_n", controller.force_limit_n, 1.0e-6, 1.0e9),
    ];
    for (key, value, low, high) in positive {
        if let Some(value) = value.filter(|value| !(low..=high).contains(value)) {
            return Err(IdentificationError::new(format!(
                "{}: {key} must be {low} to {high} in the unit of its name, got {value}",
                folder.join("dataset.toml").display()
            )));
        }
    }
    Ok(())
}

fn check_declared(folder: &Path, declared: Option<Vec<String>>) -> Outcome<Vec<String>> {
    let declared = declared.unwrap_or_else(|| {
        ["inertia", "viscous", "coulomb", "offset"]
            .map(String::from)
            .to_vec()
    });
    let mut declared: Vec<String> = declared.iter().map(|name| name.trim().to_owned()).collect();
    let mut seen = std::collections::BTreeSet::new();
    declared.retain(|name| seen.insert(name.clone()));
    match declared
        .iter()
        .find(|name| !crate::model::effects::is_known(name))
    {
        Some(name) => Err(IdentificationError::new(format!(
            "{}: unknown declared effect \"{name}\"; known: {}",
            folder.display(),
            crate::model::effects::known_names().join(", ")
        ))),
        None if declared.is_empty() => Err(IdentificationError::new(format!(
            "{}: no declared effects; give at least inertia",
            folder.display()
        ))),
        None => Ok(declared),
    }
}

fn read_record(path: &Path, kind: AxisKind, form: &DatasetForm) -> Outcome<(Record, Effort)> {
    let table = match &form.bus {
        Some(bus) if path.extension().is_some_and(|extension| extension == "log") => {
            crate::record::bus_log::read(path, bus, &form.columns, form.sample_period_s)?
        }
        _ => Table::read(path)?.mapped(&form.columns)?,
    };
    let unit = kind.position_unit();
    let time_s = table.required("time_s")?;
    if time_s.len() < FEWEST_ROWS {
        return Err(IdentificationError::new(format!(
            "{}: {} rows; identification needs at least {FEWEST_ROWS}, record longer",
            table.path,
            time_s.len()
        )));
    }
    check_time(&table.path, &time_s)?;
    check_period(&table.path, &time_s, form.sample_period_s)?;
    let (effort, which) = effort_column(&table)?;
    let raw = Record {
        period_s: 0.0,
        position: table.required(&format!("position_{unit}"))?,
        load: table.column(&format!("load_position_{unit}")),
        reference: table.column(&format!("reference_{unit}")),
        rows: time_s.iter().copied().zip(effort.iter().copied()).collect(),
        effort,
        interpolated: vec![false; time_s.len()],
        jittered: false,
        time_s,
    };
    check_effort(&table.path, which, &raw)?;
    let origin_s = match form.time_from {
        TimeFrom::Record => raw.time_s[0],
        TimeFrom::PowerOn => 0.0,
    };
    Ok((uniform(raw, form.sample_period_s, origin_s), which))
}

fn effort_column(table: &Table) -> Outcome<(Vec<f64>, Effort)> {
    let present: Vec<Effort> = Effort::ALL
        .into_iter()
        .filter(|effort| table.header.iter().any(|name| name == effort.column()))
        .collect();
    match present[..] {
        [effort] => Ok((table.required(effort.column())?, effort)),
        [] => Err(IdentificationError::new(format!(
            "{}:1: no effort column; give force_n, torque_nm or current_a (the header has {})",
            table.path,
            table.header.join(", ")
        ))),
        _ => Err(IdentificationError::new(format!(
            "{}:1: more than one effort column; keep one of force_n, torque_nm, current_a",
            table.path
        ))),
    }
}

fn check_time(path: &str, time_s: &[f64]) -> Outcome<()> {
    let back = time_s.windows(2).position(|pair| pair[1] <= pair[0]);
    if let Some(row) = back {
        return Err(IdentificationError::new(format!(
            "{path}:{}: time_s does not increase ({} after {}); sort the rows or remove doubles",
            row + 3,
            time_s[row + 1],
            time_s[row]
        )));
    }
    let period = median_step(time_s);
    let gap = time_s
        .windows(2)
        .position(|pair| pair[1] - pair[0] > 50.0 * period);
    match gap {
        Some(row) => Err(IdentificationError::new(format!(
            "{path}:{}: {:.3} s are missing (the median step is {period:.6} s); split the record there",
            row + 3,
            time_s[row + 1] - time_s[row]
        ))),
        None => Ok(()),
    }
}

/// The stated sample period against the rows.
fn check_period(path: &str, time_s: &[f64], stated: Option<f64>) -> Outcome<()> {
    let median = median_step(time_s);
    match stated {
        Some(period) if !(0.01..100.0).contains(&(median / period)) => {
            Err(IdentificationError::new(format!(
                "{path}: time_s steps by {median} s, dataset.toml says sample_period_s = {period}; is one of them in another unit?"
            )))
        }
        _ => Ok(()),
    }
}

fn check_effort(path: &str, which: Effort, record: &Record) -> Outcome<()> {
    let (low, high) = range(&record.effort);
    if high - low <= 0.0 {
        return Err(IdentificationError::new(format!(
            "{path}: column {} is constant ({low}); was the effort recorded?",
            which.column()
        )));
    }
    Ok(())
}

fn check_motion(folder: &Path, what: &str, record: &Record, kind: AxisKind) -> Outcome<()> {
    let limit = kind.moving_velocity() * record.period_s * 5.0;
    let moving = record
        .position
        .windows(6)
        .filter(|w| (w[5] - w[0]).abs() > limit)
        .count();
    if moving * 20 < record.len() {
        return Err(IdentificationError::new(format!(
            "{}: the axis hardly moves in the {what} record ({moving} of {} rows above {} {}/s); record motion, or check the unit of the position",
            folder.display(),
            record.len(),
            kind.moving_velocity(),
            kind.position_unit()
        )));
    }
    Ok(())
}

fn check_pair(
    path: &Path,
    train: &Record,
    effort: Effort,
    other: &Record,
    other_effort: Effort,
) -> Outcome<()> {
    if effort != other_effort {
        return Err(IdentificationError::new(format!(
            "{}: effort is {}, the training record has {}; record both the same way",
            path.display(),
            other_effort.column(),
            effort.column()
        )));
    }
    if train.load.is_some() != other.load.is_some() {
        return Err(IdentificationError::new(format!(
            "{}: one record has a load position and the other has not; record both the same way",
            path.display()
        )));
    }
    let ratio = other.period_s / train.period_s;
    if !(0.99..=1.01).contains(&ratio) {
        return Err(IdentificationError::new(format!(
            "{}: sample period {} s, the training record has {} s; record both at the same rate",
            path.display(),
            other.period_s,
            train.period_s
        )));
    }
    Ok(())
}

pub(crate) fn range(values: &[f64]) -> (f64, f64) {
    values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(*v), high.max(*v))
        })
}

/// So many equal largest efforts in a row are a limit.
const PLATEAU_ROWS: usize = 5;

/// The largest effort, where it stands for several rows: the drive was at its limit.
fn plateau(effort: &[f64]) -> Option<f64> {
    let most = effort
        .iter()
        .fold(0.0_f64, |most, effort| most.max(effort.abs()));
    let at_most = |effort: &f64| effort.abs() >= most * (1.0 - 1.0e-9);
    effort
        .windows(PLATEAU_ROWS)
        .any(|rows| rows.iter().all(at_most))
        .then_some(most)
}

fn median_step(time_s: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    steps[steps.len() / 2]
}

/// Smallest step between two rows, the rounding of an encoder whose resolution was not stated.
fn smallest_step(values: &[f64]) -> f64 {
    let steps = values
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .filter(|step| *step > 0.0);
    let smallest = steps.fold(f64::INFINITY, f64::min);
    if smallest.is_finite() { smallest } else { 0.0 }
}

/// Brings a record with jittered time stamps onto a uniform base by linear interpolation; leaves a
/// uniform one as it is.
fn uniform(raw: Record, period_s: Option<f64>, origin_s: f64) -> Record {
    let median = median_step(&raw.time_s);
    let period_s = period_s
        .filter(|period| (period / median - 1.0).abs() < 0.2)
        .unwrap_or(median);
    let start = raw.time_s[0];
    let even = raw
        .time_s
        .iter()
        .enumerate()
        .all(|(i, t)| (t - start - period_s * i as f64).abs() < 0.1 * period_s);
    if even {
        let time_s = raw.time_s.iter().map(|t| t - origin_s).collect();
        return Record {
            period_s,
            time_s,
            ..raw
        };
    }
    let duration = raw.time_s[raw.time_s.len() - 1] - start;
    let rows = (duration / period_s).floor() as usize + 1;
    let at: Vec<f64> = (0..rows).map(|i| start + period_s * i as f64).collect();
    let on_base = |values: &[f64]| interpolate(&raw.time_s, values, &at);
    Record {
        period_s,
        position: on_base(&raw.position),
        load: raw.load.as_deref().map(on_base),
        reference: raw.reference.as_deref().map(on_base),
        effort: on_base(&raw.effort),
        time_s: at.iter().map(|t| t - origin_s).collect(),
        jittered: jitters(&raw.time_s, median),
        interpolated: in_holes(&raw.time_s, &at, HOLE_PERIODS * median),
        rows: raw.rows,
    }
}

/// Rows further apart than so many median steps leave a hole; less is jitter.
const HOLE_PERIODS: f64 = 10.0;

/// Share of rows whose distance from the last one is off by more than a tenth, from which a clock
/// jitters; fewer are missing rows.
const JITTERY_SHARE: f64 = 0.02;

fn jitters(time_s: &[f64], period_s: f64) -> bool {
    let off = |step: f64| ((step / period_s).round() - step / period_s).abs() > 0.1;
    let count = time_s
        .windows(2)
        .filter(|pair| off(pair[1] - pair[0]))
        .count();
    count as f64 > JITTERY_SHARE * time_s.len() as f64
}

/// Which times stand between two rows that are further apart than a hole.
fn in_holes(time_s: &[f64], at: &[f64], hole_s: f64) -> Vec<bool> {
    let mut right = 1;
    at.iter()
        .map(|t| {
            while right + 1 < time_s.len() && time_s[right] < *t {
                right += 1;
            }
            time_s[right] - time_s[right - 1] > hole_s
                && *t > time_s[right - 1]
                && *t < time_s[right]
        })
        .collect()
}

/// Values on a uniform base, seen at other times.
#[must_use]
pub(crate) fn interpolate(time_s: &[f64], values: &[f64], at: &[f64]) -> Vec<f64> {
    let mut right = 1;
    at.iter()
        .map(|t| {
            while right + 1 < time_s.len() && time_s[right] < *t {
                right += 1;
            }
            let (t0, t1) = (time_s[right - 1], time_s[right]);
            let share = ((t - t0) / (t1 - t0)).clamp(0.0, 1.0);
            values[right - 1] + share * (values[right] - values[right - 1])
        })
        .collect()
}
