//! What has probably happened to a record that does not fit: a sentence each.
//!
//! The witness is the rigid axis, `u = M a + B v + C sign v + F0` ([`rigid`]). What it leaves of
//! the effort becomes ten times less where the columns are put right: shifted, read with another
//! clock, averaged ([`times`]), taken as two parts ([`parts`]), or without
//! rows at which the log was cut off ([`limit`]). No effect of an axis does that.
//! Motor and load are asked whose motion comes first and which of them drives ([`load`]).
//!
//! A cause makes a record `unexplained`. What cannot be a record at all is refused before anything
//! is fitted ([`crate::evidence::plausibility`]).

use axis_model::EffectName;

use crate::fit::tuning;
use crate::motion::filter::fit_cutoff_hz;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;
use crate::record::samples::Record;

pub(crate) mod limit;
pub(crate) mod load;
pub(crate) mod parts;
pub(crate) mod rigid;
pub(crate) mod times;
pub(crate) mod worth;

use rigid::Rigid;
use times::Reading;
use worth::WORTH_A_CAUSE;

/// A rigid axis that leaves so much of the effort has nothing to do with it.
const STRANGE: f64 = 0.5;

/// The causes that both records show, `found` being the effects that were named, and `by_model` the
/// share of the effort's variance that the model with them leaves at the cut-off of the delay
/// search.
pub(crate) fn of(dataset: &Dataset, found: &[EffectName], by_model: f64) -> Vec<String> {
    let Some(motion) = slow_motion(dataset, &dataset.train) else {
        return Vec::new();
    };
    let rigid = Rigid::of(dataset, &motion);
    let mut causes: Vec<String> = load::cause(dataset, &motion).into_iter().collect();
    causes.extend(of_effort(dataset, &rigid, found, by_model));
    if causes.is_empty() && !dataset.held_back {
        let other = slow_motion(dataset, &dataset.validate);
        let other = other.map(|motion| Rigid::of(dataset, &motion));
        causes.extend(other.and_then(|other| parts::of_validation(dataset, &rigid, &other)));
    }
    causes
}

/// The motion below the cut-off of the delay search: noise and resonances lie above it.
fn slow_motion(dataset: &Dataset, record: &Record) -> Option<Kinematics> {
    let cutoff_hz = tuning::delay_cutoff_hz(record.period_s).min(fit_cutoff_hz(dataset, record));
    Kinematics::with_cutoff(dataset, record, cutoff_hz)
}

fn of_effort(
    dataset: &Dataset,
    rigid: &Rigid,
    found: &[EffectName],
    by_model: f64,
) -> Option<String> {
    let left = rigid.fit()?.left;
    if left < WORTH_A_CAUSE {
        return None;
    }
    let shifts = found.contains(&EffectName::Delay) || dataset.declares(EffectName::Delay);
    let column = dataset.effort.column();
    let mut readings = times::readings(rigid);
    // A bristle gives way before it slips, which is a lag too: where that explains more, it is
    // that.
    readings.retain(|reading| reading.left < by_model && !shifts);
    readings.extend(of_setpoint(dataset));
    limit::cause(rigid, &dataset.train.effort, column)
        .or_else(|| times::cause(readings, left, column))
        .or_else(|| parts::within(rigid, left, column))
        .or_else(|| (left >= STRANGE).then(|| strange(column, left)))
}

/// The effort beside the motion of the setpoint: what is recorded as position may be the setpoint.
fn of_setpoint(dataset: &Dataset) -> Option<Reading> {
    let record = Record {
        position: dataset.train.reference.clone()?,
        load: None,
        velocity: None,
        ..dataset.train.clone()
    };
    let motion = slow_motion(dataset, &record)?;
    let left = Rigid::of(dataset, &motion).fit()?.left;
    let unit = dataset.kind.position_unit();
    let words = format!(
        "goes with reference_{unit} and not with position_{unit} (are the two swapped, or is the position another axis'?)"
    );
    Some(Reading { words, left })
}

fn strange(column: &str, left: f64) -> String {
    format!(
        "{column} hardly goes with the motion ({:.0} % of its square is left); is it another axis' or another run's?",
        100.0 * left
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{Axis, axis, usual};

    /// Both records are the one.
    fn named(axis: &Axis, found: &[EffectName]) -> Vec<String> {
        let mut dataset = axis.dataset.clone();
        dataset.validate = dataset.train.clone();
        of(&dataset, found, 1.0)
    }

    fn causes(axis: &Axis) -> Vec<String> {
        named(axis, &[])
    }

    #[test]
    fn a_usual_axis_has_no_cause_of_anything() {
        assert!(causes(&axis(usual)).is_empty());
        let rippled = axis(|motion, row| {
            let ripple = 8.0 * (1.0e3 * motion.friction_position[row]).sin();
            usual(motion, row) + ripple
        });
        assert!(causes(&rippled).is_empty());
    }

    #[test]
    fn an_effort_that_does_not_go_with_the_motion_is_another_axis() {
        let strange = axis(|_, row| 30.0 * (0.021 * row as f64).sin());
        let said = causes(&strange);
        assert!(
            said.len() == 1 && said[0].contains("another axis"),
            "{said:?}"
        );
    }

    #[test]
    fn an_effort_that_goes_with_the_setpoint_has_its_columns_swapped() {
        let mut swapped = axis(usual);
        let train = &mut swapped.dataset.train;
        // The measured path is in the setpoint's column; the position is its mean over 201 rows.
        let path = train.position.clone();
        train.reference = Some(path.clone());
        let mean = |row: usize| path[row.saturating_sub(200)..=row].iter().sum::<f64>();
        let smooth = |row: usize| mean(row) / (row + 1).min(201) as f64;
        train.position = (0..path.len()).map(smooth).collect();
        let said = causes(&swapped);
        assert!(said[0].contains("goes with reference_m"), "{said:?}");
    }

    #[test]
    fn a_delay_that_is_named_is_no_cause_again() {
        let late = axis(|motion, row| usual(motion, row.saturating_sub(40)));
        assert!(
            causes(&late)[0].contains("40.0 rows late"),
            "{:?}",
            causes(&late)
        );
        assert!(named(&late, &[EffectName::Delay]).is_empty());
    }

    #[test]
    fn a_shift_that_leaves_more_than_the_model_does_is_no_cause() {
        let late = axis(|motion, row| usual(motion, row.saturating_sub(40)));
        let rigid = Rigid::of(&late.dataset, &late.motion);
        let readings = times::readings(&rigid).into_iter();
        let left = readings.map(|reading| reading.left).fold(1.0, f64::min);
        let causes = |by_model: f64| of_effort(&late.dataset, &rigid, &[], by_model);
        assert!(causes(1.1 * left).is_some() && causes(0.9 * left).is_none());
    }
}
