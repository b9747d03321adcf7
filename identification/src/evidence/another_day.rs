//! What another record has of the same structure, but in another size.
//!
//! Friction changes with temperature and grease from day to day. A validation record that differs
//! only in linear coefficients contradicts no effect, but its errors are larger for it, and that
//! has to be told from a wrong model.

use axis_model::EffectName;

use crate::evidence::inverse_dynamics::InverseDynamics;
use crate::evidence::thresholds::OTHER_DAY_SHARE;
use crate::evidence::verdict::Reason;
use crate::fit::bench::Bench;
use crate::fit::fitted::Estimate;
use crate::model::effects::Effect;
use crate::model::effects::load_inertia::LoadInertia;
use crate::model::name::Called;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;

/// Another record knows a size as well as the first one where its interval is at most so many times
/// as wide.
const MOST_WIDER: f64 = 2.0;

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

impl Change {
    /// Whether it is friction whose whole interval has the other sign.
    fn turns(&self) -> bool {
        let friction = [
            EffectName::Coulomb,
            EffectName::Viscous,
            EffectName::Stribeck,
            EffectName::QuadraticDrag,
        ];
        let is_friction = friction.iter().any(|name| self.effect == *name);
        is_friction && self.share + self.half_width < -1.0
    }
}

/// The coefficients of a structure on two records.
pub(crate) struct OnBoth {
    first: Vec<Estimate>,
    other: Vec<Estimate>,
}

impl OnBoth {
    /// Of two records, the training record first.
    pub(crate) fn of(
        dataset: &Dataset,
        records: [&Kinematics; 2],
        model: &InverseDynamics,
    ) -> Self {
        let [first, other] = records.map(|motion| {
            let seen = model.motion(motion);
            let bench = Bench::new(dataset, &seen);
            bench.estimates_of_coefficients(&bench.fit(model.fitted.model()))
        });
        Self { first, other }
    }

    /// Those that differ by more than their intervals. A load that became heavier makes the axis as
    /// much heavier: where it does not, the motion of a record tells its part of the mass less well
    /// than it seems.
    pub(crate) fn changes(&self) -> Vec<Change> {
        let pairs = self.first.iter().zip(&self.other);
        let changes = pairs.filter_map(|(first, other)| change(first, other));
        let is_real = |one: &Change| one.effect != LoadInertia.called() || self.axis_follows();
        changes.filter(is_real).collect()
    }

    /// Whether the mass of the axis has changed as that of its load did, by both intervals.
    fn axis_follows(&self) -> bool {
        let [axis, load] = [EffectName::Inertia.into(), LoadInertia.called()].map(|called| {
            let mut pairs = self.first.iter().zip(&self.other);
            let pair = pairs.find(|(first, _)| first.part.called() == called);
            pair.map_or((0.0, 0.0), |(first, other)| {
                let ((before, half_before), (after, half_after)) = (first.own[0], other.own[0]);
                (after - before, half_before.hypot(half_after))
            })
        });
        (axis.0 - load.0).abs() <= axis.1.hypot(load.1)
    }

    /// Friction that has turned from one record to the other. Another day makes it more or less;
    /// what pushes where it braked is another effect, of which the first record saw a part.
    pub(crate) fn reason(&self) -> Option<Reason> {
        let changes = self.changes();
        let turned = changes.iter().find(|change| change.turns())?;
        Some(Reason::unexplained(format!(
            "{} of the other sign on the validation record ({:+.0} ± {:.0} %): it stands for \
             something else; record the motions of both in one",
            turned.effect,
            100.0 * turned.share,
            100.0 * turned.half_width
        )))
    }

    /// Intervals of the coefficients of the first record with half of what the other one says
    /// otherwise: two records of one axis are off by different parts of what a model lacks. What
    /// the other one knows much less of counts for nothing, nor does what has changed from day to
    /// day.
    pub(crate) fn widen(&self, estimates: &mut [Estimate]) {
        let pairs = self.first.iter().zip(&self.other);
        for (estimate, (first, other)) in estimates.iter_mut().zip(pairs) {
            let pairs = first.own.iter().zip(&other.own);
            for ((_, half_width), (first, other)) in estimate.own.iter_mut().zip(pairs) {
                let ((here, half_here), (there, half_there)) = (first, other);
                let apart = (there - here).abs();
                let is_same = apart < OTHER_DAY_SHARE * here.abs();
                if is_same && *half_there <= MOST_WIDER * half_here {
                    *half_width = half_width.hypot(0.5 * apart);
                }
            }
        }
    }
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
    use crate::evidence::verdict::Verdict;
    use crate::fit::made::{axis, model};
    use crate::model::inverse::Part;

    /// 90 kg, 200 N s/m, 25 N and −4 N, and other ones.
    fn on_both(other: [f64; 4]) -> OnBoth {
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
            by_the_load: None,
            slips_at: None,
        };
        OnBoth::of(&first.dataset, [&first.motion, &other.motion], &fitted)
    }

    fn changes_to(other: [f64; 4]) -> Vec<Change> {
        on_both(other).changes()
    }

    #[test]
    fn an_interval_has_half_of_what_another_record_says_otherwise_in_it() {
        let both = on_both([92.0, 200.0, 40.0, -4.0]);
        let mut estimates = both.first.clone();
        // Both know it as well as noise that there is not lets them.
        for one in &mut estimates {
            one.own[0].1 = 0.5;
        }
        let same = OnBoth {
            first: estimates.clone(),
            other: both.other.clone(),
        };
        same.widen(&mut estimates);
        let halves: Vec<f64> = estimates.iter().map(|one| one.own[0].1).collect();
        assert!((halves[0] - 0.5_f64.hypot(1.0)).abs() < 0.05, "{halves:?}");
        // 15 N more is another day, and the rest is the same.
        assert!(halves[1..].iter().all(|half| (half - 0.5).abs() < 0.01));
        let mut unknown = both.other.clone();
        for one in &mut unknown {
            one.own[0].1 = 1.1;
        }
        let other = OnBoth {
            first: same.first.clone(),
            other: unknown,
        };
        let mut estimates = same.first.clone();
        other.widen(&mut estimates);
        assert!(estimates.iter().all(|one| one.own[0].1 == 0.5));
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
    fn friction_that_turns_is_none_and_less_of_it_is_another_day() {
        let said = |viscous: f64| {
            let reason = on_both([90.0, viscous, 25.0, -4.0]).reason();
            reason.map(|reason| Verdict::of(vec![reason]).looks_like)
        };
        assert_eq!(said(20.0), None);
        let turned = said(-60.0).unwrap();
        assert!(turned.starts_with("viscous of the other sign"), "{turned}");
        assert!(turned.contains("(-130 ± "), "{turned}");
    }

    #[test]
    fn a_load_is_not_heavier_on_an_axis_that_is_as_heavy_as_before() {
        let both = on_both([90.0, 200.0, 25.0, -4.0]);
        let with_load = |estimates: &[Estimate], axis: f64, load: f64| {
            let mut estimates = estimates.to_vec();
            let mut of_load = estimates[0].clone();
            (of_load.part, of_load.own) = (Part::found(&LoadInertia, 0.0), vec![(load, 1.0)]);
            estimates[0].own[0].0 *= axis;
            estimates.push(of_load);
            estimates
        };
        let told = |axis: f64, load: f64| {
            let both = OnBoth {
                first: with_load(&both.first, 1.0, 40.0),
                other: with_load(&both.other, axis, load),
            };
            let changes = both.changes().into_iter();
            changes.map(|one| one.effect).collect::<Vec<_>>()
        };
        assert!(told(1.0, 50.0).is_empty());
        // 3 kg of 90, and of 40: told of the load alone.
        assert_eq!(told(93.0 / 90.0, 43.0), [LoadInertia.called()]);
        let axis: Called = EffectName::Inertia.into();
        assert_eq!(told(100.0 / 90.0, 50.0), [axis, LoadInertia.called()]);
    }

    #[test]
    fn a_change_of_less_than_a_twentieth_is_not_told() {
        assert_eq!(changes_to([94.0, 200.0, 26.0, -4.0]), []);
    }
}
