//! Each effect that was found, against what it is best seen against.

use crate::evidence::findings::Findings;
use crate::fit::bench::Bench;
use crate::fit::fitted::Term;
use crate::model::effects::{Against, Stage};
use crate::model::inverse::Origin;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;
use crate::report::forms::EffectCurve;

/// Points of a picture, at most about twice as many.
const POINTS: usize = 2500;

/// The extended model on the training record.
struct Picture<'a> {
    dataset: &'a Dataset,
    bench: Bench<'a>,
    /// What the whole model leaves, low-passed.
    residual: Vec<f64>,
    /// The moving samples that are shown.
    shown: Vec<usize>,
}

/// The effects of the inverse model that were found, one picture each.
pub(crate) fn effects(findings: &Findings<'_>) -> Vec<EffectCurve> {
    let extended = &findings.models.extended;
    let motion = extended.motion(findings.motion);
    let bench = Bench::new(findings.dataset, &motion);
    let picture = Picture {
        dataset: findings.dataset,
        residual: bench.residual(&extended.fitted),
        bench,
        shown: thinned(&motion.moving),
    };
    let is_found = |term: &Term<'_>| {
        term.part.origin == Origin::Found && term.part.effect.stage() == Stage::Force
    };
    let found = extended.fitted.terms().filter(is_found);
    found.map(|term| picture.of(term)).collect()
}

/// Every so many of the samples inside a mask.
fn thinned(mask: &[bool]) -> Vec<usize> {
    let inside: Vec<usize> = (0..mask.len()).filter(|row| mask[*row]).collect();
    let stride = (inside.len() / POINTS).max(1);
    inside.into_iter().step_by(stride).collect()
}

impl Picture<'_> {
    fn of(&self, term: Term<'_>) -> EffectCurve {
        let effect = self.bench.predict_lp(&term.alone());
        let part = term.part;
        let against = values(part.effect.against(), part.parameter, self.bench.motion);
        let point = |row: &usize| {
            let without = self.residual[*row] + effect[*row];
            [against[*row], without, effect[*row]]
        };
        EffectCurve {
            effect: part.called().as_str(),
            equation: part.effect.equation(),
            against: label(part.effect.against(), self.dataset.kind.position_unit()),
            points: self.shown.iter().map(point).collect(),
        }
    }
}

fn values(against: Against, parameter: f64, motion: &Kinematics) -> Vec<f64> {
    match against {
        Against::Velocity => motion.velocity_lp.clone(),
        Against::Position => motion.position_lp.clone(),
        Against::Period => motion
            .position_lp
            .iter()
            .map(|x| (x * parameter).rem_euclid(1.0))
            .collect(),
        Against::Time => motion.time_s.clone(),
    }
}

fn label(against: Against, unit: &str) -> String {
    match against {
        Against::Velocity => format!("velocity, {unit}/s"),
        Against::Position => format!("position, {unit}"),
        Against::Period => "position within the period, periods".into(),
        Against::Time => "time, s".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_shows_samples_inside_the_mask_only_and_at_most_twice_its_points() {
        let mask: Vec<bool> = (0..30_000).map(|row| row % 3 != 0).collect();
        let shown = thinned(&mask);
        assert!(shown.iter().all(|row| row % 3 != 0));
        assert!(
            (POINTS..2 * POINTS).contains(&shown.len()),
            "{}",
            shown.len()
        );
    }

    #[test]
    fn a_short_record_is_shown_whole() {
        assert_eq!(thinned(&[true, false, true, true]), [0, 2, 3]);
    }

    #[test]
    fn what_an_effect_is_shown_against_has_its_unit() {
        assert_eq!(label(Against::Velocity, "rad"), "velocity, rad/s");
        assert_eq!(label(Against::Position, "m"), "position, m");
    }
}
