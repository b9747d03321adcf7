//! What another record contradicts.

use crate::evidence::effort::prune;
use crate::evidence::selection::{Selection, Vetoed};
use crate::evidence::thresholds::{EFFORT_SHARE, VETO_PART, VETO_RATIO};
use crate::fit::bench::Bench;
use crate::fit::blocks::Gain;
use crate::model::effects::Against;
use crate::model::inverse::{Model, Origin, Part};

/// Drops what another record contradicts: what holds on one record only is no effect of the axis.
///
/// Only the structure is asked. Coefficients are those of one half of the other record, judged on
/// its other half, and the other way round: friction of another day is no contradiction. What half
/// a record does not tell stays as it is on the first one. An effect goes where it makes that error
/// larger by more than a little, and where it should have shown, by the size that it has on the
/// first record, but does not.
///
/// A model with an effect over the position is asked where the first record was: beyond that it is
/// not known, nor what goes with it there.
pub(crate) fn veto(bench: &Bench<'_>, other: &Bench<'_>, selection: &mut Selection) {
    let before = selection.model.clone();
    let inside = other.motion.within(bench.motion.span());
    let inside = Bench::new(other.dataset, &inside);
    prune(&mut selection.model, &without_all, &|full, without, _| {
        let other = if is_placed(full) { &inside } else { other };
        let fits = [full, without].map(|model| bench.fit(model));
        let left = fits.each_ref().map(|fitted| other.left_on_halves(fitted));
        holds(left) && shows(left, other.adds(&fits[0], without))
    });
    let stays = |part: &&Part| {
        selection
            .model
            .parts
            .iter()
            .any(|other| other.is_same(part))
    };
    let gone = before.parts.iter().filter(|part| !stays(part));
    let vetoed = gone.map(|part| Vetoed {
        effect: part.called(),
        parameter: part.parameter,
        gain: Gain::of(
            &bench.cross_validate(&before.without(part)),
            &bench.cross_validate(&before),
        ),
    });
    selection.vetoed = vetoed.collect();
}

/// Whether a model has an effect over the position.
fn is_placed(model: &Model) -> bool {
    let mut parts = model.parts.iter();
    parts.any(|part| part.effect.against() == Against::Position)
}

/// The model without a part; what comes and goes is asked at all its times together.
fn without_all(model: &Model, part: &Part) -> Model {
    if !part.effect.comes_and_goes() {
        return model.without(part);
    }
    let mut without = model.clone();
    let is_one = |other: &Part| other.origin == Origin::Found && other.called() == part.called();
    without.parts.retain(|other| !is_one(other));
    without
}

/// Whether an effect may stay, by what is left of another record (sums of squares) with it and
/// without it.
fn holds([with, without]: [f64; 2]) -> bool {
    with.sqrt() <= VETO_RATIO * without.sqrt()
}

/// Whether an effect shows on another record as far as it should: its size on the first record
/// would remove `expected` there.
fn shows([with, without]: [f64; 2], expected: f64) -> bool {
    expected < EFFORT_SHARE * without || without - with >= VETO_PART * expected
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{Axis, axis, found, model, on, usual};
    use crate::motion::kinematics::Kinematics;
    use axis_model::EffectName::{
        self, Coulomb, Inertia, LoadDependentFriction, Offset, PositionDependentFriction, Viscous,
        ViscousAsymmetry,
    };

    const DECLARED: [EffectName; 4] = [Inertia, Viscous, Coulomb, Offset];

    /// An axis with 60 N s/m more in one direction than in the other.
    fn asymmetric() -> Axis {
        axis(|motion, row| usual(motion, row) + 60.0 * motion.velocity[row].abs())
    }

    #[test]
    fn what_another_record_contradicts_is_vetoed() {
        let (axis, same, other) = (asymmetric(), asymmetric(), self::axis(usual));
        let full = model(&DECLARED).with(found(ViscousAsymmetry, 0.0));
        let left_after = |other: &Axis| {
            let mut selection = Selection {
                model: full.clone(),
                ..Selection::default()
            };
            veto(&axis.bench(), &other.bench(), &mut selection);
            assert_eq!(selection.vetoed.len(), 1 - selection.found().len());
            let gains = selection.vetoed.iter().map(|vetoed| vetoed.gain.share);
            assert!(gains.into_iter().all(|share| share > 0.9));
            selection.found().len()
        };
        assert_eq!((left_after(&same), left_after(&other)), (1, 0));
        // Half of it, beside other friction, is another day of the same effect.
        let other_day =
            self::axis(|motion, row| 1.2 * usual(motion, row) + 30.0 * motion.velocity[row].abs());
        assert_eq!(left_after(&other_day), 1);
    }

    #[test]
    fn what_lies_beyond_the_travel_contradicts_nothing() {
        let (middle, half) = axis(usual).dataset.travel();
        let u = |motion: &Kinematics, row: usize| (motion.position_lp[row] - middle) / half;
        let worn = |motion: &Kinematics, row: usize| {
            usual(motion, row) + 8.0 * u(motion, row) * motion.direction[row]
        };
        let train = axis(worn);
        let full = model(&DECLARED).with(found(PositionDependentFriction, 1.0));
        let stays = |other: &Axis| {
            let mut selection = Selection {
                model: full.clone(),
                ..Selection::default()
            };
            veto(&train.bench(), &other.bench(), &mut selection);
            selection.vetoed.is_empty()
        };
        // The other record goes to three times the travel, where the way is worn no more.
        let mut record = train.dataset.train.clone();
        for x in &mut record.position {
            *x = middle + 3.0 * (*x - middle);
        }
        let mut far = on(record);
        far.put(|motion, row| {
            let u = u(motion, row);
            let worn = if u.abs() < 1.0 { u } else { -u };
            usual(motion, row) + 8.0 * worn * motion.direction[row]
        });
        assert!(stays(&far));
        let mut even = far;
        even.put(usual);
        assert!(!stays(&even));
    }

    #[test]
    fn what_another_record_cannot_tell_apart_contradicts_nothing() {
        let loaded = |motion: &Kinematics, row: usize| {
            let force = usual(motion, row);
            force + 0.15 * force.abs() * motion.direction[row]
        };
        let train = axis(loaded);
        let full = model(&DECLARED).with(found(LoadDependentFriction, 0.0));
        let stays = |other: &Axis| {
            let mut selection = Selection {
                model: full.clone(),
                ..Selection::default()
            };
            veto(&train.bench(), &other.bench(), &mut selection);
            selection.vetoed.is_empty()
        };
        // So slow that the motor hardly brakes: its column is nearly a sum of the usual ones.
        let mut record = train.dataset.train.clone();
        for x in &mut record.position {
            *x *= 0.15;
        }
        let mut slow = on(record);
        slow.put(loaded);
        assert!(stays(&slow));
        assert!(!stays(&axis(usual)));
    }

    #[test]
    fn an_effect_may_make_the_error_on_another_record_larger_by_a_twentieth() {
        let holds = |with: f64, without: f64| holds([with.powi(2), without.powi(2)]);
        assert!(holds(1.05, 1.0) && !holds(1.051, 1.0));
        assert!(holds(2.1, 2.0) && !holds(2.11, 2.0));
    }

    #[test]
    fn an_effect_shows_on_another_record_with_a_third_of_its_size_or_where_it_could_not_show() {
        assert!(shows([90.0, 100.0], 100.0) && !shows([90.1, 100.0], 100.0));
        assert!(shows([100.0, 100.0], 4.9) && !shows([100.0, 100.0], 5.0));
    }
}
