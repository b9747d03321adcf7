//! How much structure is left in a residual, and what it goes with.
//!
//! Rows are correlated, so no row-wise whiteness test is honest. Judged instead by the share of the
//! residual's variance that [`features`](crate::evidence::features) of motion explain on held-out
//! blocks, one family at a time: all at once they over-fit on clean records into negative shares.
//! What the model itself spans, and a small shift in time of either sign, is taken from residual
//! and features first. So a feature is judged by what it adds, and a record whose effort is an
//! eighth of a millisecond early is not called an effect. And what counts must be there at the
//! lower cut-off too, that of the delay search: a controller gives back what an encoder rounds and
//! a drive shakes, as effort that goes with the measured motion, its rate above all.
//!
//! Three things count. Structure is `unexplained` where it is a large share of the residual and
//! large beside the effort of motion (the effort without its mean: gravity is not motion). Whatever
//! is left is `unexplained` where it is more than noise can be: much of that effort, and slower
//! than the low-pass makes noise. And so is a candidate of the library that would remove much and
//! was not certain enough for a name.

use axis_model::EffectName;

use crate::evidence::amount::{Amount, about_mean};
use crate::evidence::features::{FAMILIES, Family, Scene, rate};
use crate::evidence::inverse_dynamics::{Compared, InverseDynamics};
use crate::evidence::reversal::rms;
use crate::evidence::selection::{Scored, Vetoed, is_certain};
use crate::evidence::thresholds::{
    FED_BACK_PERCENT, SHAPE_PART, SHIFT_S, UNEXPLAINED_PERCENT, UNEXPLAINED_SHARE, UNEXPLAINED_T,
    WHITE_SHARE,
};
use crate::evidence::verdict::Reason;
use crate::fit::bench::Bench;
use crate::fit::blocks::{Blocks, Gain};
use crate::fit::fitted::Fitted;
use crate::fit::side_by_side::side_by_side;
use crate::fit::span::Span;
use crate::model::name::Called;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;
use crate::record::rounding;

/// Structure over features of one family.
#[derive(Clone, Copy)]
pub(crate) struct Structure {
    /// The family.
    pub family: &'static Family,
    /// What it removes from the residual on held-out blocks; its size in percent of the effort of
    /// motion.
    pub gain: Gain,
    /// Up to here it does not count, percent of the same: another shape of an effect that the model
    /// has, or a shift in time that is only told.
    pub allowed_percent: f64,
}

/// What a model leaves of a record.
#[derive(Clone)]
pub(crate) struct Remainder {
    /// Structure by family, the largest share first.
    pub structures: Vec<Structure>,
    /// Time by which the effort is later than the model has it, s; negative where it is earlier.
    pub late_s: f64,
    /// What that shift removes from the residual on held-out blocks; its size as for a structure.
    pub shift: Gain,
    /// How much is left, and how slow it is.
    pub amount: Amount,
    /// Rms of what the rounding of the effort may leave, percent of the same.
    pub rounding_percent: f64,
    /// Rms of the effort over that without its mean.
    pub whole: f64,
}

impl Remainder {
    /// What a model leaves of a motion.
    fn of_model(dataset: &Dataset, motion: &Kinematics, model: &InverseDynamics) -> Self {
        let seen = model.motion(motion);
        let bench = Bench::new(dataset, &seen);
        let plain = Bench::new(dataset, motion);
        let bristle_rms = model.bristle.as_ref().map_or(0.0, |_| {
            let without = plain.residual(&plain.fit(model.fitted.model()));
            let [without, with] = [&without, &bench.residual(&model.fitted)]
                .map(|residual| rms(residual, &motion.fitted).powi(2));
            (without - with).max(0.0).sqrt()
        });
        Self::of(&bench, &model.fitted, bristle_rms)
    }

    /// What a fitted model leaves on its bench. What a bristle in place of the sign takes away is
    /// the size of that effect.
    fn of(bench: &Bench<'_>, fitted: &Fitted, bristle_rms: f64) -> Self {
        let motion = bench.motion;
        let (force, residual) = (bench.predict_lp(fitted), bench.residual(fitted));
        let mut span = Span::of(bench.design(fitted.model()).into_columns(), &motion.fitted);
        let rate = rate(motion, &force);
        let shift = one(motion, &span.outside(&residual), &[&span.outside(&rate)]);
        span.add(&rate);
        let rest = span.outside(&residual);
        let scene = Scene::of(bench, &force);
        let moved = about_mean(&motion.effort_lp, &motion.fitted).max(f64::MIN_POSITIVE);
        let amount = Amount::of(motion, &residual);
        let shift_rms = SHIFT_S * rms(&rate, &motion.fitted);
        let judged = |family: &&'static Family| {
            let gain = in_family(motion, &span, &rest, &scene.columns(family));
            let parts_rms = effect_rms(bench, fitted, family.shapes);
            Structure {
                family,
                gain: sized(gain, amount.percent),
                allowed_percent: 100.0 / moved * allowed(family, parts_rms, bristle_rms, shift_rms),
            }
        };
        let families: Vec<&'static Family> = FAMILIES.iter().collect();
        let mut structures = side_by_side(&families, judged);
        structures.sort_by(|a, b| b.gain.share.total_cmp(&a.gain.share));
        let rounding = rounding::rms(rounding::step(&bench.dataset.train.effort));
        Self {
            structures,
            late_s: -shift.1,
            shift: sized(shift.0, amount.percent),
            amount,
            whole: rms(&motion.effort_lp, &motion.fitted) / moved,
            rounding_percent: 100.0 * rounding / moved,
        }
    }

    /// The same, but with every structure only as far as it is there at a lower cut-off too, unless
    /// it is larger than what a controller gives back.
    fn slow_too(mut self, low: &Self) -> Self {
        for one in &mut self.structures {
            let is_same = |other: &&Structure| std::ptr::eq(other.family, one.family);
            if let Some(other) = low.structures.iter().find(is_same) {
                one.gain = smaller(one.gain, &other.gain);
            }
        }
        self.structures
            .sort_by(|a, b| b.gain.share.total_cmp(&a.gain.share));
        self.shift = smaller(self.shift, &low.shift);
        self
    }

    /// Whether anything of it counts.
    fn has_structure(&self) -> bool {
        let gains = self.structures.iter().map(|one| &one.gain);
        gains.chain([&self.shift]).any(|gain| self.matters(gain))
    }

    /// Up to which size, percent of the effort of motion, an effect that the model does not have
    /// may be another shape of one that it has.
    fn allowed_to(&self, effect: Called) -> f64 {
        let of_its_kind = |one: &&Structure| match effect {
            Called::Effect(name) => one.family.shapes.contains(&name),
            Called::Structure(words) => one.family.nameless.contains(&words),
        };
        let allowed = self.structures.iter().filter(of_its_kind);
        allowed.fold(0.0, |most, one| one.allowed_percent.max(most))
    }

    /// Whether a structure matters, and is more than may be left of its kind.
    fn counts(&self, one: &Structure) -> bool {
        self.matters(&one.gain) && one.gain.percent >= one.allowed_percent
    }

    /// The largest share of the residual that a family or the shift explains; none is negative.
    fn share(&self) -> f64 {
        let first = self.structures.first().map_or(0.0, |one| one.gain.share);
        first.max(self.shift.share).max(0.0)
    }

    /// Whether a gain on the residual is a large share of it, large beside the motion and beside
    /// the rounding of the effort, and not plain chance.
    fn matters(&self, gain: &Gain) -> bool {
        gain.share >= UNEXPLAINED_SHARE
            && gain.percent >= UNEXPLAINED_PERCENT.max(self.rounding_percent)
            && gain.t >= UNEXPLAINED_T
    }

    fn reasons(&self, has_gap: bool) -> Vec<Reason> {
        let counts = |one: &Structure| self.counts(one) && !has_gap;
        let is_seen = |one: &Structure| one.gain.share >= WHITE_SHARE && is_certain(&one.gain);
        let seen = self.structures.iter();
        let seen = seen.filter(|one| is_seen(one) || counts(one));
        let mut reasons: Vec<Reason> = self.of_the_shift(has_gap).into_iter().collect();
        // The largest that counts, else the largest that is seen.
        let first = seen
            .clone()
            .find(|one| counts(one))
            .or_else(|| seen.clone().next());
        reasons.extend(first.map(|one| one.reason(counts(one))));
        reasons.extend(self.amount.reason("of the effort of motion is left"));
        reasons
    }

    fn of_the_shift(&self, has_gap: bool) -> Option<Reason> {
        let is_seen = self.shift.share >= WHITE_SHARE && is_certain(&self.shift);
        let side = if self.late_s > 0.0 { "late" } else { "early" };
        let words = format!(
            "effort that is {:.2} ms {side} against the motion ({:.0} % of the residual)",
            1.0e3 * self.late_s.abs(),
            100.0 * self.shift.share
        );
        is_seen.then(|| {
            if self.late_s.abs() >= SHIFT_S && self.matters(&self.shift) && !has_gap {
                Reason::unexplained(words + ": check how the columns were recorded")
            } else {
                Reason::told(words)
            }
        })
    }
}

impl Structure {
    fn reason(&self, counts: bool) -> Reason {
        let Family {
            over, looks_like, ..
        } = self.family;
        let percent = 100.0 * self.gain.share;
        let words = format!("structure over {over} ({percent:.0} % of the residual)");
        if counts {
            Reason::unexplained(format!("{words}: {looks_like}"))
        } else {
            Reason::told(words)
        }
    }
}

/// Structure in the residual of moving samples.
#[derive(Clone)]
pub(crate) struct ResidualStructure {
    /// What the models leave.
    pub left: Compared<Remainder>,
    /// The best candidate that was not accepted, of the last round.
    candidate: Option<Scored>,
    /// Share of the residual that features or a candidate explain.
    pub share: Compared<f64>,
}

impl ResidualStructure {
    /// What the declared and the extended model leave of the training record.
    pub(crate) fn of(
        dataset: &Dataset,
        [motion, low]: [&Kinematics; 2],
        models: &Compared<InverseDynamics>,
        scored: &[Scored],
    ) -> Self {
        let remainder = |motion, model| Remainder::of_model(dataset, motion, model);
        let left = models.each(|model| {
            let left = remainder(motion, model);
            if left.has_structure() {
                left.slow_too(&remainder(low, model))
            } else {
                left
            }
        });
        let last = scored.iter().map(|scored| scored.round).max().unwrap_or(0);
        let share = |remainder: &Remainder, round: usize| {
            let best = best_of_round(scored, round);
            remainder
                .share()
                .max(best.map_or(0.0, |best| best.gain.share))
        };
        Self {
            share: Compared {
                declared: share(&left.declared, 0),
                extended: share(&left.extended, last),
            },
            candidate: best_of_round(scored, last)
                .filter(|one| !one.accepted)
                .cloned(),
            left,
        }
    }

    /// What it says of the extended model. A gap excuses structure: its impacts come where the path
    /// turns, so they go with position and time as well, and no column has their force.
    pub(crate) fn reasons(&self, has_gap: bool) -> Vec<Reason> {
        let left = &self.left.extended;
        let mut reasons = left.reasons(has_gap);
        let candidate = self.candidate.as_ref();
        let matters = |one: &&Scored| {
            let gain = sized(one.gain, left.amount.percent);
            let allowed = left.allowed_to(one.effect);
            left.matters(&gain) && gain.percent >= allowed
        };
        let counts = candidate.filter(|one| matters(one) && !has_gap);
        reasons.extend(counts.map(|one| {
            let percent = 100.0 * one.gain.share;
            let effect = one.effect.as_str();
            Reason::unexplained(format!(
                "what {effect} would explain ({percent:.0} % of the residual)"
            ))
        }));
        reasons
    }

    /// What a veto says: an effect that one record shows and another contradicts. It counts where
    /// it is large, and no other shape of an effect that stayed.
    pub(crate) fn of_a_veto(&self, vetoed: &Vetoed) -> Reason {
        let gain = &vetoed.gain;
        let words = format!(
            "{} on the training record ({:.0} % of the residual), which the validation record contradicts",
            vetoed.effect.as_str(),
            100.0 * gain.share
        );
        let left = &self.left.extended;
        let allowed = left.allowed_to(vetoed.effect);
        let limit = UNEXPLAINED_PERCENT.max(allowed);
        if gain.share >= UNEXPLAINED_SHARE && gain.percent * left.whole >= limit {
            Reason::unexplained(words + ": record both again in one state of the axis")
        } else {
            Reason::told(words)
        }
    }

    /// Whether too little is left to speak of.
    pub(crate) fn is_white(&self) -> Compared<bool> {
        self.share.each(|share| *share < WHITE_SHARE)
    }
}

/// The candidate of a round that removes most, of those that can be their effect: what the others
/// would explain goes with features, or with a shift.
fn best_of_round(scored: &[Scored], round: usize) -> Option<&Scored> {
    let of_round = scored
        .iter()
        .filter(|one| one.round == round && one.physical);
    of_round.max_by(|a, b| a.gain.share.total_cmp(&b.gain.share))
}

/// Gain of a family over what the model leaves.
fn in_family(motion: &Kinematics, span: &Span<'_>, rest: &[f64], columns: &[Vec<f64>]) -> Gain {
    let (mut wider, known) = (span.clone(), span.dimension());
    for column in columns {
        wider.add(column);
    }
    one(motion, rest, &wider.beyond(known)).0
}

/// Up to where a structure is another shape of an effect that is there, or a shift that is told.
fn allowed(family: &Family, parts_rms: f64, bristle_rms: f64, shift_rms: f64) -> f64 {
    let has_bristle = family.shapes.contains(&EffectName::Presliding);
    let effect_rms = parts_rms.max(if has_bristle { bristle_rms } else { 0.0 });
    let shift_rms = if family.is_shift { shift_rms } else { 0.0 };
    shift_rms.max(SHAPE_PART * effect_rms)
}

/// Rms of the largest of some effects that a fit has, as far as its other parts cannot take its
/// place.
fn effect_rms(bench: &Bench<'_>, fitted: &Fitted, effects: &[EffectName]) -> f64 {
    let model = fitted.model();
    let parts = model.parts.iter();
    let parts = parts.filter(|part| effects.iter().any(|name| part.is(*name)));
    let rows = bench.motion.fitted.iter().filter(|inside| **inside);
    let rows = rows.count().max(1) as f64;
    parts
        .map(|part| (bench.adds(fitted, &model.without(part)) / rows).sqrt())
        .fold(0.0, f64::max)
}

/// Gain of columns over nothing on held-out blocks, and the first coefficient.
fn one(motion: &Kinematics, rest: &[f64], columns: &[&[f64]]) -> (Gain, f64) {
    let blocks = Blocks::new(columns, rest, &motion.fitted, motion.period_s);
    let nothing = blocks.nothing();
    let fit = if columns.is_empty() {
        nothing.clone()
    } else {
        blocks.cross_validate()
    };
    let first = fit.coefficients.first().copied().unwrap_or(0.0);
    (Gain::of(&nothing, &fit), first)
}

/// A gain on a residual with its size, by that of the residual.
fn sized(gain: Gain, residual_percent: f64) -> Gain {
    let percent = residual_percent * gain.share.max(0.0).sqrt();
    Gain { percent, ..gain }
}

/// A gain as far as another one is there too, where it may be fed back.
fn smaller(gain: Gain, other: &Gain) -> Gain {
    if gain.percent >= FED_BACK_PERCENT {
        return gain;
    }
    let percent = gain.percent.min(other.percent);
    Gain {
        percent,
        ..gain.smaller(other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{Axis, axis, found, model, usual};
    use EffectName::{Coulomb, Inertia, Offset, Viscous, ViscousAsymmetry};

    const DECLARED: [EffectName; 4] = [Inertia, Viscous, Coulomb, Offset];

    fn left_of(axis: &Axis) -> Remainder {
        let bench = axis.bench();
        Remainder::of(&bench, &bench.fit(&model(&DECLARED)), 0.0)
    }

    /// What is left of an axis with a force more than the usual ones.
    fn left(force: impl Fn(&Kinematics, usize) -> f64) -> Remainder {
        left_of(&axis(|motion, row| usual(motion, row) + force(motion, row)))
    }

    fn first(left: &Remainder) -> (&'static str, f64) {
        let first = &left.structures[0];
        (first.family.over, first.gain.share)
    }

    #[test]
    fn a_force_goes_most_with_the_family_that_it_is_of() {
        let half = 0.02;
        let over = |force: &dyn Fn(&Kinematics, usize) -> f64| {
            let left = left(force);
            assert!(first(&left).1 > 0.8, "{:?}", first(&left));
            first(&left).0
        };
        let load = |m: &Kinematics, row: usize| 90.0 * m.acceleration[row];
        assert_eq!(
            over(&|m, row| 0.3 * load(m, row) * m.position_lp[row] / half),
            "acceleration times position"
        );
        assert_eq!(
            over(&|m, row| if m.time_s[row] > 3.0 {
                0.2 * load(m, row)
            } else {
                0.0
            }),
            "acceleration times time"
        );
        assert_eq!(
            over(&|m, row| 5.0 * m.direction[row] * (m.time_s[row] - 3.0)),
            "direction times time"
        );
        assert_eq!(over(&|m, row| 5.0 * (m.time_s[row] - 3.0).powi(2)), "time");
    }

    #[test]
    fn noise_goes_with_nothing_and_is_as_fast_as_the_low_pass_lets_it_be() {
        let left = left(|_, row| 8.0 * (1.7 * (row * row % 1013) as f64).sin());
        assert!(first(&left).1 < 0.05, "{:?}", first(&left));
        assert!(
            (0.5..1.5).contains(&left.amount.slowness),
            "{}",
            left.amount.slowness
        );
        assert!(left.reasons(false).is_empty());
    }

    #[test]
    fn the_percentage_left_is_of_the_effort_without_its_mean() {
        let percent = |gravity: f64| {
            left(move |m, row| gravity + 10.0 * (61.0 * m.time_s[row]).sin())
                .amount
                .percent
        };
        let (level, hanging) = (percent(0.0), percent(5000.0));
        assert!((hanging / level - 1.0).abs() < 0.02, "{level} {hanging}");
    }

    /// The effort of another time: the same force, so many rows later.
    fn shifted(rows: isize) -> Remainder {
        let usual_axis = axis(usual);
        let effort = usual_axis.motion.effort.clone();
        let last = effort.len() as isize - 1;
        left_of(&axis(|_, row| {
            effort[(row as isize - rows).clamp(0, last) as usize]
        }))
    }

    #[test]
    fn a_shift_is_told_with_its_sign_and_is_no_structure_of_another_kind() {
        for (rows, side) in [(2, "late"), (-2, "early")] {
            let left = shifted(rows);
            assert!(
                (1.0e3 * left.late_s - rows as f64).abs() < 0.2,
                "{}",
                left.late_s
            );
            assert!(left.shift.share > 0.9, "{:?}", left.shift);
            let reason = left.of_the_shift(false).unwrap();
            assert!(reason.counts && reason.words.contains(side), "{reason:?}");
        }
    }

    #[test]
    fn a_shift_below_a_sixth_of_a_row_is_told_only() {
        let counts = |late_s| {
            let left = Remainder {
                late_s,
                ..shifted(2)
            };
            left.of_the_shift(false).unwrap().counts
        };
        assert!(counts(0.15e-3) && counts(-0.15e-3) && !counts(0.149e-3) && !counts(-0.149e-3));
    }

    #[test]
    fn a_structure_counts_from_its_limits_on_and_a_gap_excuses_it() {
        let counts = |share: f64, percent: f64, has_gap: bool| {
            let gain = Gain {
                removed: 1.0,
                share,
                percent,
                t: 9.0,
            };
            let left = Remainder {
                structures: vec![Structure {
                    family: &FAMILIES[0],
                    gain,
                    allowed_percent: 0.0,
                }],
                ..left(|_, _| 0.0)
            };
            let reasons = left.reasons(has_gap);
            reasons.iter().any(|reason| reason.counts)
        };
        assert!(counts(0.15, 9.0, false) && !counts(0.149, 9.0, false));
        assert!(counts(0.25, 0.3, false) && !counts(0.25, 0.299, false));
        assert!(!counts(0.5, 9.0, true));
        let late = shifted(2);
        let counts = |has_gap| late.of_the_shift(has_gap).unwrap().counts;
        assert!(counts(false) && !counts(true));
    }

    #[test]
    fn another_shape_of_an_effect_that_is_there_is_allowed_a_sixth_of_its_size() {
        let force = |m: &Kinematics, row: usize| {
            let v = m.velocity[row];
            usual(m, row) + 60.0 * v.abs() + 15.0 * (40.0 * v).sin().abs()
        };
        let axis = axis(force);
        let bench = axis.bench();
        let with = model(&DECLARED).with(found(ViscousAsymmetry, 0.0));
        let left = Remainder::of(&bench, &bench.fit(&with), 0.0);
        let one = left.structures[0];
        assert_eq!(one.family.over, "velocity by direction");
        assert!(left.matters(&one.gain) && one.allowed_percent > 0.0);
        let size = effect_rms(&bench, &bench.fit(&with), &[ViscousAsymmetry]);
        let moved = about_mean(&axis.motion.effort_lp, &axis.motion.fitted);
        assert!((one.allowed_percent / (100.0 * SHAPE_PART * size / moved) - 1.0).abs() < 1.0e-9);
        let counts = |times: f64| {
            left.counts(&Structure {
                allowed_percent: times * one.gain.percent,
                ..one
            })
        };
        assert!(counts(0.999) && !counts(1.001));
        // Without the effect there is nothing that it could be a shape of; a shift is always told.
        let without = left_of(&self::axis(force));
        for one in &without.structures {
            assert_eq!(one.allowed_percent > 0.0, one.family.is_shift);
        }
    }

    #[test]
    fn a_bristle_has_other_shapes_over_force_and_velocity_and_not_over_position() {
        let of = |over: &str| {
            let family = FAMILIES.iter().find(|family| family.over == over).unwrap();
            allowed(family, 0.0, 6.0, 0.5)
        };
        let force = of("the transmitted force by direction");
        assert!((force / (6.0 * SHAPE_PART) - 1.0).abs() < 1.0e-12);
        assert_eq!(of("velocity by direction"), force);
        assert_eq!(of("the rate of the acceleration"), force);
        assert_eq!(of("position"), 0.0);
        let rate = FAMILIES.iter().find(|family| family.is_shift).unwrap();
        assert_eq!(allowed(rate, 0.0, 0.0, 0.5), 0.5);
    }

    #[test]
    fn a_structure_below_the_rounding_of_the_effort_does_not_count() {
        let matters = |rounding_percent: f64| {
            let left = Remainder {
                rounding_percent,
                ..left(|_, _| 0.0)
            };
            left.matters(&Gain {
                removed: 1.0,
                share: 0.25,
                percent: 2.0,
                t: 9.0,
            })
        };
        assert!(matters(2.0) && !matters(2.01));
    }

    #[test]
    fn a_structure_is_as_large_as_it_is_at_both_cutoffs() {
        let whole = left(|m, row| 0.5 * m.direction[row] * (m.time_s[row] - 3.0));
        let kept = whole.clone().slow_too(&whole);
        let gains = |left: &Remainder| {
            left.structures
                .iter()
                .map(|one| one.gain)
                .collect::<Vec<_>>()
        };
        assert_eq!(gains(&kept), gains(&whole));
        assert!(kept.has_structure());
        let mut half = whole.clone();
        let percent = whole.structures[0].gain.percent;
        half.structures[0].gain.percent = 0.5 * percent;
        let lost = whole.clone().slow_too(&half);
        let first = |left: &Remainder| left.structures[0].gain;
        assert_eq!(first(&lost).percent, 0.5 * percent);
        assert_eq!(first(&lost).share, first(&whole).share);
        let nothing = left(|_, _| 0.0);
        assert!(!whole.clone().slow_too(&nothing).has_structure());
        // What is larger than anything that is fed back counts as it is.
        let mut large = whole;
        large.structures[0].gain.percent = FED_BACK_PERCENT;
        assert!(large.slow_too(&nothing).has_structure());
    }

    fn scored(round: usize, share: f64, physical: bool) -> Scored {
        Scored {
            effect: EffectName::Delay.into(),
            parameter: 1.0e-3,
            gain: Gain {
                removed: 1.0,
                share,
                percent: 1.0,
                t: 5.0,
            },
            physical,
            accepted: false,
            round,
        }
    }

    #[test]
    fn the_best_candidate_of_a_round_is_the_largest_that_can_be_its_effect() {
        let list = [
            scored(0, 0.4, true),
            scored(0, 0.7, true),
            scored(0, 0.9, false),
            scored(1, 0.2, true),
        ];
        let best = [0, 1, 2].map(|round| best_of_round(&list, round).map(|one| one.gain.share));
        assert_eq!(best, [Some(0.7), Some(0.2), None]);
    }

    #[test]
    fn what_a_record_shows_and_another_contradicts_counts_where_it_is_large() {
        let vetoed = |effect: EffectName, share, percent| Vetoed {
            effect: effect.into(),
            parameter: 0.0,
            gain: Gain {
                removed: 1.0,
                share,
                percent,
                t: 9.0,
            },
        };
        // An effect of 3 % over velocity by direction has other shapes of half a percent.
        let mut left = Remainder {
            whole: 2.0,
            ..left(|_, _| 0.0)
        };
        let is_friction = |one: &&mut Structure| one.family.over == "velocity by direction";
        let one = left.structures.iter_mut().find(is_friction).unwrap();
        one.allowed_percent = SHAPE_PART * 3.0;
        let residual = ResidualStructure {
            left: Compared {
                declared: left.clone(),
                extended: left,
            },
            candidate: None,
            share: Compared::default(),
        };
        let counts =
            |effect, share, percent| residual.of_a_veto(&vetoed(effect, share, percent)).counts;
        let payload = |share, percent| counts(EffectName::Payload, share, percent);
        assert!(payload(0.15, 0.15) && !payload(0.149, 9.0) && !payload(0.9, 0.149));
        let stribeck = |percent| counts(EffectName::Stribeck, 0.5, percent);
        assert!(stribeck(0.251) && !stribeck(0.249));
    }
}
