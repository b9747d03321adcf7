//! From positions (or the drive's velocity) to velocity, acceleration, direction and masks, aligned
//! with the effort.
//!
//! Nonlinear columns are made from the low-passed velocity and position and then low-passed
//! themselves, linear ones from the raw derivatives. Each piece of a record that has joints is
//! worked on alone: no difference and no filter looks across a joint.

use std::ops::Range;

use crate::motion::bodies::{Bodies, minus};
use crate::motion::derivatives::Lacking;
use crate::motion::filter::{LowPass, fit_cutoff_hz};
use crate::motion::lag::acting_effort;
use crate::motion::mask;
use crate::record::dataset::Dataset;
use crate::record::samples::Record;

/// What a record says about motion.
#[derive(Clone, Debug)]
pub(crate) struct Kinematics {
    /// Sample period, s.
    pub period_s: f64,
    /// Time since the start of the record, s.
    pub time_s: Vec<f64>,
    /// Acceleration, raw.
    pub acceleration: Vec<f64>,
    /// Acceleration, low-passed with the cut-off of the fit whatever that of the others is: it goes
    /// into columns that are not linear in it, and those are low-passed in their turn.
    pub acceleration_lp: Vec<f64>,
    /// Velocity, raw.
    pub velocity: Vec<f64>,
    /// Load − motor acceleration, raw, where both were measured.
    pub load_acceleration: Option<Vec<f64>>,
    /// Low-passed position.
    pub position_lp: Vec<f64>,
    /// Low-passed velocity where friction acts: at the load scale if there is one, else at the
    /// motor.
    pub velocity_lp: Vec<f64>,
    /// Raw position where friction acts.
    pub friction_position: Vec<f64>,
    /// Direction, −1…1: the sign of the velocity, or the presliding state once that is accepted.
    pub direction: Vec<f64>,
    /// Acting effort, raw.
    pub effort: Vec<f64>,
    /// Low-passed effort.
    pub effort_lp: Vec<f64>,
    /// Motor − load, raw, where both were measured.
    pub difference: Option<Vec<f64>>,
    /// What the acceleration lacks of fast motion.
    pub lacking: Lacking,
    /// Moving samples: the ones that errors are defined on.
    pub moving: Vec<bool>,
    /// Moving samples, of motor and load, clear of rest, whose effort is known and not at its
    /// limit: the ones that are fitted.
    pub fitted: Vec<bool>,
    /// Samples about reversals and rests.
    pub slow: Vec<bool>,
    /// The contiguous pieces of the record.
    pub pieces: Vec<Range<usize>>,
    /// The low-pass.
    pub filter: LowPass,
    /// Duration, gaps between pieces included, s.
    pub duration_s: f64,
}

impl Kinematics {
    /// Kinematics of a record with the cut-off of its fit; `None` where the sample rate leaves no
    /// room for the low-pass.
    #[must_use]
    pub(crate) fn new(dataset: &Dataset, record: &Record) -> Option<Self> {
        Self::with_cutoff(dataset, record, fit_cutoff_hz(dataset, record))
    }

    /// The same with another cut-off.
    #[must_use]
    pub(crate) fn with_cutoff(dataset: &Dataset, record: &Record, cutoff: f64) -> Option<Self> {
        let filter = LowPass::new(record.period_s, cutoff)?;
        if record.joints.is_empty() {
            return Some(Self::of_piece(dataset, record, filter));
        }
        let of_piece = |piece| Self::of_piece(dataset, &record.part(piece), filter.clone());
        let mut whole = record
            .pieces()
            .into_iter()
            .map(of_piece)
            .reduce(Self::and)?;
        whole.duration_s = record.duration_s();
        Some(whole)
    }

    fn of_piece(dataset: &Dataset, record: &Record, filter: LowPass) -> Self {
        let (period_s, hold) = (record.period_s, dataset.hold);
        let bodies = Bodies::of(dataset, record);
        let of_the_fit = LowPass::new(period_s, fit_cutoff_hz(dataset, record));
        let of_the_fit = of_the_fit.unwrap_or_else(|| filter.clone());
        let friction = bodies.with_friction();
        let effort = acting_effort(&record.effort, dataset.effort_lag_s, period_s, hold);
        let velocity_lp = filter.apply(&friction.velocity);
        let limit = dataset.moving_velocity;
        let motor_lp = filter.apply(&bodies.motor.velocity);
        let (moving, slow) = mask::moving_and_slow(&motor_lp, limit, period_s);
        let spoilt = mask::spoilt(record, dataset.effort_limit);
        // Where the motor crosses a gap the load may stand: no law of moving samples is seen there.
        // Nor is one where the low-pass has mixed in what holds the axis at rest.
        let (load_moves, _) = mask::moving_and_slow(&velocity_lp, limit, period_s);
        let clear = |moving: &[bool], velocity_lp: &[f64]| {
            mask::clear_of_rest(moving, velocity_lp, limit, period_s, filter.cutoff_hz)
        };
        let both_move = mask::both(
            &clear(&moving, &motor_lp),
            &clear(&load_moves, &velocity_lp),
        );
        Self {
            period_s,
            time_s: record.time_s.clone(),
            position_lp: filter.apply(&bodies.motor.position),
            direction: velocity_lp.iter().map(|v| v.signum()).collect(),
            friction_position: friction.position.clone(),
            velocity_lp,
            effort_lp: filter.apply(&effort),
            difference: record
                .load
                .as_deref()
                .map(|load| minus(&record.position, load)),
            lacking: Lacking::of(dataset),
            fitted: mask::without(&both_move, &spoilt),
            slow: mask::without(&slow, &spoilt),
            moving,
            pieces: record.pieces(),
            duration_s: record.duration_s(),
            load_acceleration: bodies.load_acceleration,
            acceleration_lp: of_the_fit.apply(&bodies.motor.acceleration),
            acceleration: bodies.motor.acceleration,
            velocity: bodies.motor.velocity,
            effort,
            filter,
        }
    }

    /// This piece and the next one.
    fn and(mut self, next: Self) -> Self {
        let start = self.len();
        let later = next.pieces.into_iter();
        self.pieces
            .extend(later.map(|piece| start + piece.start..start + piece.end));
        self.time_s.extend(next.time_s);
        self.acceleration.extend(next.acceleration);
        self.acceleration_lp.extend(next.acceleration_lp);
        self.velocity.extend(next.velocity);
        extend(&mut self.load_acceleration, next.load_acceleration);
        self.position_lp.extend(next.position_lp);
        self.velocity_lp.extend(next.velocity_lp);
        self.friction_position.extend(next.friction_position);
        self.direction.extend(next.direction);
        self.effort.extend(next.effort);
        self.effort_lp.extend(next.effort_lp);
        extend(&mut self.difference, next.difference);
        self.moving.extend(next.moving);
        self.fitted.extend(next.fitted);
        self.slow.extend(next.slow);
        self
    }

    /// Number of samples.
    #[must_use]
    pub(crate) fn len(&self) -> usize {
        self.effort.len()
    }

    /// A signal of this record through the low-pass of the fit, piece by piece.
    #[must_use]
    pub(crate) fn low_passed(&self, signal: &[f64]) -> Vec<f64> {
        match &self.pieces[..] {
            [_] => self.filter.apply(signal),
            pieces => pieces
                .iter()
                .flat_map(|piece| self.filter.apply(&signal[piece.clone()]))
                .collect(),
        }
    }

    /// The same for several signals.
    #[must_use]
    pub(crate) fn all_low_passed(&self, signals: &[Vec<f64>]) -> Vec<Vec<f64>> {
        signals.iter().map(|one| self.low_passed(one)).collect()
    }

    /// Whether a sample is away from the low-pass's ends in its piece.
    #[must_use]
    pub(crate) fn is_inside(&self, row: usize) -> bool {
        mask::is_inside(&self.pieces, row)
    }

    /// Range of positions over moving samples.
    #[must_use]
    pub(crate) fn span(&self) -> (f64, f64) {
        let rows = self.position_lp.iter().zip(&self.moving);
        let moving = rows.filter(|(_, moving)| **moving);
        moving.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (x, _)| {
            (low.min(*x), high.max(*x))
        })
    }

    /// The same where only what lies between two positions is fitted.
    #[must_use]
    pub(crate) fn within(&self, (low, high): (f64, f64)) -> Self {
        let rows = self.fitted.iter().zip(&self.position_lp);
        let inside = rows.map(|(fitted, x)| *fitted && (low..=high).contains(x));
        Self {
            fitted: inside.collect(),
            ..self.clone()
        }
    }

    /// Duration, s: what was left out between pieces is part of it.
    #[must_use]
    pub(crate) const fn duration_s(&self) -> f64 {
        self.duration_s
    }
}

fn extend(values: &mut Option<Vec<f64>>, more: Option<Vec<f64>>) {
    if let (Some(values), Some(more)) = (values, more) {
        values.extend(more);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::units::{AxisKind, Effort, EffortHold};

    /// 6000 rows at 1 kHz along 10 mm · sin(3 t), with a load 0.1 mm behind.
    fn dataset() -> Dataset {
        let time_s: Vec<f64> = (0..6000).map(|row| 1.0e-3 * f64::from(row)).collect();
        let position: Vec<f64> = time_s.iter().map(|t| 0.01 * (3.0 * t).sin()).collect();
        let record = Record {
            period_s: 1.0e-3,
            load: Some(position.iter().map(|x| x - 1.0e-4).collect()),
            position,
            velocity: None,
            reference: None,
            effort: time_s.iter().map(|t| (3.0 * t).cos()).collect(),
            rows: Vec::new(),
            jittered: false,
            joints: Vec::new(),
            interpolated: vec![false; time_s.len()],
            time_s,
        };
        Dataset {
            name: "made".into(),
            kind: AxisKind::Linear,
            moving_velocity: 1.0e-3,
            effort: Effort::Force,
            hold: EffortHold::ZeroOrder,
            effort_lag_s: 2.0e-3,
            lead_m_per_rev: None,
            resolution: 1.0e-9,
            load_resolution: 0.0,
            effort_limit: None,
            controller: None,
            declared: Vec::new(),
            train: record.clone(),
            validate: record,
            held_back: false,
            full_band: false,
            is_sharpened: false,
            scale_errors: Vec::new(),
            notes: Vec::new(),
        }
    }

    #[test]
    fn a_record_of_pieces_is_the_same_motion_away_from_their_ends() {
        let dataset = dataset();
        let whole = Kinematics::new(&dataset, &dataset.train).unwrap();
        let windows = dataset.train.windows(&[0..2000, 3000..5000]);
        let pieces = Kinematics::new(&dataset, &windows).unwrap();
        assert_eq!(pieces.pieces, [0..2000, 2000..4000]);
        let columns = |motion: &Kinematics, row: usize| {
            [
                motion.acceleration[row] / 0.1,
                motion.velocity_lp[row] / 0.03,
                motion.position_lp[row] / 0.01,
                motion.effort_lp[row],
                motion.low_passed(&motion.acceleration)[row] / 0.1,
            ]
        };
        for (row, at) in [(500, 500), (1790, 1790), (2210, 3210), (3500, 4500)] {
            let pairs = columns(&pieces, row).into_iter().zip(columns(&whole, at));
            for (piece, whole) in pairs {
                assert!((piece - whole).abs() < 1.0e-6, "row {row}: {piece} {whole}");
            }
        }
    }

    #[test]
    fn a_joint_leaves_no_spike_and_no_sample_about_it_counts() {
        let dataset = dataset();
        let windows = dataset.train.windows(&[0..2000, 3000..5000]);
        let motion = Kinematics::new(&dataset, &windows).unwrap();
        assert!((1800..2200).all(|row| !motion.moving[row] && !motion.slow[row]));
        assert!(motion.moving[2200..3800].contains(&true));
        // 10 mm at 3 rad/s: 0.09 m/s² at most.
        assert!(motion.acceleration.iter().all(|a| a.abs() < 0.1));
        assert!((motion.duration_s() - 5.0).abs() < 1.0e-9);
    }

    #[test]
    fn friction_is_seen_at_the_load_scale() {
        let dataset = dataset();
        let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
        let difference = motion.difference.as_ref().unwrap();
        assert!((difference[100] - 1.0e-4).abs() < 1.0e-12);
        let behind = motion.position_lp[3000] - motion.friction_position[3000];
        assert!((behind - 1.0e-4).abs() < 1.0e-7, "{behind}");
    }

    #[test]
    fn acceleration_for_what_is_not_linear_in_it_has_the_cutoff_of_the_fit() {
        let dataset = dataset();
        let of = |motion: Kinematics| (motion.acceleration_lp, motion.velocity_lp);
        let (fit, velocity) = of(Kinematics::new(&dataset, &dataset.train).unwrap());
        let slow = Kinematics::with_cutoff(&dataset, &dataset.train, 5.0).unwrap();
        let (same, slower) = of(slow);
        assert_eq!(fit, same);
        assert_ne!(velocity, slower);
    }
}
