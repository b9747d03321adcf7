//! Whether velocity and acceleration are sharpened: a question to a record as a whole, before
//! anything is sought in it.
//!
//! What differences lack of fast motion makes a mass too large and leaves the effort of fast motion
//! unexplained. Given back it is right, but noise of the positions grows with it. So the declared
//! model is fitted with either motion, and the sharpened one must leave less of the effort on
//! blocks that were held out. Where it is about the same, the plain one stays.

use std::borrow::Cow;

use crate::evidence::effort;
use crate::evidence::thresholds::SHARPENED_WORTH;
use crate::fit::bench::Bench;
use crate::fit::tuning::{self, Pair};
use crate::model::inverse::Model;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;
use crate::record::excerpt::{ExcerptSize, excerpt};

/// The dataset with the motion that is to be used.
pub(crate) fn decided(dataset: Cow<'_, Dataset>, size: ExcerptSize) -> Cow<'_, Dataset> {
    let excerpt = excerpt(&dataset, size);
    let is_worth_it = is_worth_it(excerpt.as_ref().unwrap_or(&dataset));
    match sharpened(&dataset).filter(|_| is_worth_it.unwrap_or(false)) {
        Some(sharpened) => Cow::Owned(sharpened),
        None => dataset,
    }
}

/// The same dataset with the sharpened motion; `None` where its motion is that, or lacks nothing:
/// an acceleration that is the slope of a measured velocity.
pub(crate) fn sharpened(dataset: &Dataset) -> Option<Dataset> {
    let lacks = !dataset.is_sharpened && dataset.train.velocity.is_none();
    lacks.then(|| Dataset {
        is_sharpened: true,
        ..dataset.clone()
    })
}

/// `None` where nothing is lacking, or the sample period leaves no room for the low-pass.
fn is_worth_it(plain: &Dataset) -> Option<bool> {
    let sharp = sharpened(plain)?;
    let low_hz = tuning::delay_cutoff_hz(plain.train.period_s);
    let motion = Kinematics::new(plain, &plain.train)?;
    let low = Kinematics::with_cutoff(plain, &plain.train, low_hz)?;
    let [bench, low] = [&motion, &low].map(|motion| Bench::new(plain, motion));
    let pair = Pair {
        bench: &bench,
        low: &low,
    };
    let mut model = effort::with_declared_load(&bench, &Model::declared(plain));
    tuning::prepare(pair, &mut model);
    let sharp_motion = Kinematics::new(&sharp, &sharp.train)?;
    let sharp = Bench::new(&sharp, &sharp_motion);
    let [plain, sharp] = [&bench, &sharp].map(|bench| {
        let held_out = bench.cross_validate(&model).held_out;
        held_out.iter().sum::<f64>()
    });
    Some(sharp <= SHARPENED_WORTH.powi(2) * plain)
}

#[cfg(test)]
mod tests {
    use axis_model::EffectName::{Coulomb, Inertia, Viscous};

    use super::*;
    use crate::record::excerpt::EXCERPT;
    use crate::record::samples::Record;
    use crate::record::units::EffortHold;
    use crate::simulate::made;

    /// 10 s of an axis of 5 kg that is shaken at 45 Hz beside its moves, at an instant; its encoder
    /// counts by so much.
    fn shaken(count: f64) -> Dataset {
        let time = |row: u32| 1.0e-3 * f64::from(row);
        let moves = |t: f64| [(0.02, 3.0), (2.0e-5, 283.0)].map(|(size, omega)| (size, omega, t));
        let path = |t: f64| -> f64 {
            let sum = moves(t).map(|(size, omega, t)| size * (omega * t).sin());
            sum.iter().sum()
        };
        let velocity = |t: f64| -> f64 {
            let sum = moves(t).map(|(size, omega, t)| size * omega * (omega * t).cos());
            sum.iter().sum()
        };
        let acceleration = |t: f64| -> f64 {
            let sum = moves(t).map(|(size, omega, t)| -size * omega * omega * (omega * t).sin());
            sum.iter().sum()
        };
        let times = || (0..10_000).map(time);
        let counted = times().map(|t| count * (path(t) / count).round()).collect();
        let effort =
            times().map(|t| 5.0 * acceleration(t) + 8.0 * velocity(t) + 2.0 * velocity(t).signum());
        let record = Record {
            effort: effort.collect(),
            ..made::record(1.0e-3, counted)
        };
        Dataset {
            hold: EffortHold::Instant,
            declared: vec![Inertia, Viscous, Coulomb],
            ..made::dataset(record, None)
        }
    }

    fn is_sharpened(dataset: &Dataset) -> bool {
        decided(Cow::Borrowed(dataset), EXCERPT).is_sharpened
    }

    #[test]
    fn fast_motion_is_sharpened_where_positions_are_fine_and_not_where_they_are_coarse() {
        assert!(is_sharpened(&shaken(1.0e-9)));
        assert!(!is_sharpened(&shaken(2.0e-5)));
    }

    #[test]
    fn a_motion_that_lacks_nothing_is_not_asked() {
        let fine = shaken(1.0e-9);
        assert!(sharpened(&sharpened(&fine).unwrap()).is_none());
        let measured = Record {
            velocity: Some(vec![0.0; fine.train.len()]),
            ..fine.train.clone()
        };
        let measured = fine.with_records(measured.clone(), measured);
        assert!(!is_sharpened(&measured));
    }
}
