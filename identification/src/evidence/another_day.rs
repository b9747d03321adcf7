//! What another record has of the same structure, but in another size.
//!
//! Friction changes with temperature and grease from day to day. A validation record that differs
//! only in linear coefficients contradicts no effect, but its errors are larger for it, and that
//! has to be told from a wrong model.

use crate::evidence::inverse_dynamics::InverseDynamics;
use crate::evidence::thresholds::OTHER_DAY_SHARE;
use crate::fit::bench::Bench;
use crate::fit::fitted::Estimate;
use crate::model::name::Called;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;

/// A coefficient that another record has in another size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Change {
    /// Effect.
    pub effect: Called,
    /// Change over the first size.
    pub share: f64,
    /// Half width of its 95 % interval.
    pub half_width: f64,
}

/// The coefficients of a structure that differ between two records by more than their intervals.
pub(crate) fn changes(
    dataset: &Dataset,
    records: [&Kinematics; 2],
    model: &InverseDynamics,
) -> Vec<Change> {
    let [first, other] = records.map(|motion| {
        let seen = model.motion(motion);
        let bench = Bench::new(dataset, &seen);
        bench.estimates_of_coefficients(&bench.fit(model.fitted.model()))
    });
    let pairs = first.iter().zip(&other);
    pairs
        .filter_map(|(first, other)| change(first, other))
        .collect()
}

/// The change of an effect with one coefficient.
fn change(first: &Estimate, other: &Estimate) -> Option<Change> {
    let ([(before, half_before)], [(after, half_after)]) = (&first.own[..], &other.own[..]) else {
        return None;
    };
    let size = before.abs().max(f64::MIN_POSITIVE);
    let change = Change {
        effect: first.part.called(),
        share: (after - before) / before,
        half_width: half_before.hypot(*half_after) / size,
    };
    let is_known = *half_before < 0.5 * size && change.share.abs() > change.half_width;
    (is_known && change.share.abs() >= OTHER_DAY_SHARE).then_some(change)
}

#[cfg(test)]
mod tests {
    use axis_model::EffectName::{Coulomb, Inertia, Offset, Viscous};

    use super::*;
    use crate::fit::made::{axis, model};

    /// Changes from 90 kg, 200 N s/m, 25 N and −4 N to other ones.
    fn changes_to(other: [f64; 4]) -> Vec<Change> {
        let made = |[mass, viscous, coulomb, offset]: [f64; 4]| {
            axis(move |motion, row| {
                let friction = viscous * motion.velocity[row] + coulomb * motion.direction[row];
                mass * motion.acceleration[row] + friction + offset
            })
        };
        let (first, other) = (made([90.0, 200.0, 25.0, -4.0]), made(other));
        let fitted = InverseDynamics {
            fitted: first
                .bench()
                .fit(&model(&[Inertia, Viscous, Coulomb, Offset])),
            bristle: None,
        };
        changes(&first.dataset, [&first.motion, &other.motion], &fitted)
    }

    #[test]
    fn what_changed_is_told_with_its_share_and_nothing_else_is() {
        assert_eq!(changes_to([90.0, 200.0, 25.0, -4.0]), []);
        let changes = changes_to([90.0, 180.0, 28.75, -4.0]);
        let effects: Vec<Called> = changes.iter().map(|change| change.effect).collect();
        assert_eq!(effects, [Viscous, Coulomb]);
        assert!((changes[0].share + 0.10).abs() < 0.01, "{:?}", changes[0]);
        assert!((changes[1].share - 0.15).abs() < 0.01, "{:?}", changes[1]);
    }

    #[test]
    fn a_change_of_less_than_a_twentieth_is_not_told() {
        assert_eq!(changes_to([94.0, 200.0, 26.0, -4.0]), []);
    }
}
