//! What comes out impossible: a mass, a friction or a damping below zero.
//!
//! A coefficient has the wrong sign where its whole 95 % interval has, and where its force matters:
//! below [`SMALLEST_PERCENT`] of the effort it may be what a neighbour left over. Such a model
//! predicts, but what it calls friction is none, so the record is `unexplained`. An effort of the
//! other sign turns all of them at once; that cause is told.

use axis_model::EffectName::{self, Coulomb, Inertia, Viscous, ViscousAsymmetry};

use crate::evidence::inverse_dynamics::InverseDynamics;
use crate::evidence::verdict::Reason;
use crate::fit::bench::Bench;
use crate::fit::fitted::Estimate;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;

/// Smallest force of an impossible coefficient, percent of the effort. Chosen: three times the
/// structure that counts in a residual, since a column takes from its neighbours as well.
const SMALLEST_PERCENT: f64 = 1.0;

/// A coefficient that cannot be below zero.
struct Positive {
    words: String,
    value: f64,
    half_width: f64,
    percent: f64,
}

impl Positive {
    fn is_impossible(&self) -> bool {
        self.value + self.half_width < 0.0 && self.percent >= SMALLEST_PERCENT
    }
}

/// What a model says that no axis has.
pub(crate) fn reasons(
    dataset: &Dataset,
    motion: &Kinematics,
    model: &InverseDynamics,
) -> Option<Reason> {
    let seen = model.motion(motion);
    let bench = Bench::new(dataset, &seen);
    let estimates = bench.estimates_of_coefficients(&model.fitted);
    reason(&positive(&bench, &estimates))
}

fn reason(all: &[Positive]) -> Option<Reason> {
    let impossible: Vec<&Positive> = all.iter().filter(|one| one.is_impossible()).collect();
    if impossible.is_empty() {
        return None;
    }
    let words: Vec<String> = impossible
        .iter()
        .map(|one| {
            format!(
                "{} below zero ({:.3} ± {:.3})",
                one.words, one.value, one.half_width
            )
        })
        .collect();
    let all_turned = all.iter().all(|one| one.value < 0.0);
    let cause = if all_turned {
        "all signs are turned: the effort has probably the other sign than the positions"
    } else {
        "no axis has that: a column is wrong, or an effect is missing that looks like it"
    };
    Some(Reason::unexplained(format!(
        "{}, {cause}",
        words.join(" and ")
    )))
}

/// The coefficients of a model that cannot be below zero.
fn positive(bench: &Bench<'_>, estimates: &[Estimate]) -> Vec<Positive> {
    let of = |name: EffectName| {
        let named = estimates.iter().find(|one| one.part.is(name))?;
        let (value, half_width) = *named.own.first()?;
        let percent = bench.percent_of_effort(&named.part, 0) * value.abs();
        Some(Positive {
            words: format!("{name}"),
            value,
            half_width,
            percent,
        })
    };
    let mut all: Vec<Positive> = [Inertia, Viscous, Coulomb]
        .into_iter()
        .filter_map(of)
        .collect();
    // The slower direction must keep some viscous friction: Fv − |c|.
    let of_direction = of(Viscous)
        .zip(of(ViscousAsymmetry))
        .map(|(viscous, asymmetry)| Positive {
            words: "viscous friction of one direction".into(),
            value: viscous.value - asymmetry.value.abs(),
            half_width: viscous.half_width + asymmetry.half_width,
            percent: asymmetry.percent,
        });
    all.extend(of_direction.filter(Positive::is_impossible));
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{Axis, axis, model, usual};

    fn words(axis: &Axis, names: &[EffectName]) -> String {
        let model = InverseDynamics {
            fitted: axis.bench().fit(&model(names)),
            bristle: None,
            by_the_load: None,
            slips_at: None,
        };
        let reason = reasons(&axis.dataset, &axis.motion, &model);
        assert!(reason.iter().all(|reason| reason.counts));
        reason.map_or(String::new(), |reason| reason.words)
    }

    const DECLARED: [EffectName; 4] = [Inertia, Viscous, Coulomb, EffectName::Offset];

    #[test]
    fn a_usual_axis_has_nothing_impossible() {
        assert_eq!(words(&axis(usual), &DECLARED), "");
    }

    #[test]
    fn friction_that_drives_is_impossible_and_named() {
        let drives = axis(|motion, row| usual(motion, row) - 60.0 * motion.direction[row]);
        let words = words(&drives, &DECLARED);
        assert!(words.starts_with("coulomb below zero (-35"), "{words}");
        assert!(words.contains("a column is wrong"), "{words}");
    }

    #[test]
    fn a_damping_below_zero_counts_where_its_force_matters() {
        let with = |more: f64| {
            let axis = axis(|motion, row| usual(motion, row) - more * motion.velocity[row]);
            words(&axis, &DECLARED)
        };
        assert!(
            with(400.0).starts_with("viscous below zero"),
            "{}",
            with(400.0)
        );
        // 200 − 203 N s/m at 0.1 m/s: a hundredth of the effort at most.
        assert_eq!(with(203.0), "");
    }

    #[test]
    fn an_asymmetry_above_the_viscous_friction_is_impossible_in_one_direction() {
        let with = |asymmetry: f64| {
            let law = |motion: &Kinematics, row: usize| {
                usual(motion, row) + asymmetry * motion.velocity[row].abs()
            };
            let names = [&DECLARED[..], &[ViscousAsymmetry]].concat();
            words(&axis(law), &names)
        };
        assert_eq!(with(-150.0), "");
        assert!(with(-300.0).starts_with("viscous friction of one direction below zero"));
    }

    #[test]
    fn an_effort_of_the_other_sign_turns_all_of_them_and_that_is_said() {
        let turned = axis(|motion, row| -usual(motion, row));
        let words = words(&turned, &DECLARED);
        assert!(words.contains("inertia below zero") && words.contains("coulomb below zero"));
        assert!(
            words.contains("the effort has probably the other sign"),
            "{words}"
        );
    }
}
