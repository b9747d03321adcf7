//! Each effect that was found, against what it is best seen against.

use crate::fit::bench::{Bench, Model};
use crate::identify::Findings;
use crate::model::effects::Against;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;
use crate::report::forms::EffectCurve;

/// Points of a picture.
const POINTS: usize = 2500;

/// The effects of the inverse model that were found, one picture each.
pub(crate) fn effects(findings: &Findings<'_>) -> Vec<EffectCurve> {
    let Findings {
        dataset,
        extended,
        declared,
        ..
    } = findings;
    let motion = extended.motion(findings.motion);
    let bench = Bench::new(dataset, &motion);
    let residual = bench.residual(&extended.model, &extended.coefficients);
    let mut place = 0;
    let mut curves = Vec::new();
    for (index, term) in extended.model.terms.iter().enumerate() {
        let width = term.effect.width(term.parameter);
        if index >= declared.model.terms.len() {
            let alone = Model {
                terms: vec![*term],
                ..Model::default()
            };
            let effect = bench.predict_lp(&alone, &extended.coefficients[place..place + width]);
            let against = values(term.effect.against(), term.parameter, &motion);
            let rows: Vec<usize> = (0..motion.len())
                .filter(|row| motion.moving[*row])
                .collect();
            let stride = (rows.len() / POINTS).max(1);
            let point = |row: &usize| [against[*row], residual[*row] + effect[*row], effect[*row]];
            curves.push(EffectCurve {
                effect: term.effect.name(),
                equation: term.effect.equation(),
                against: label(term.effect.against(), dataset),
                points: rows.iter().step_by(stride).map(point).collect(),
            });
        }
        place += width;
    }
    curves
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

fn label(against: Against, dataset: &Dataset) -> String {
    let unit = dataset.kind.position_unit();
    match against {
        Against::Velocity => format!("velocity, {unit}/s"),
        Against::Position => format!("position, {unit}"),
        Against::Period => "position within the period, periods".into(),
        Against::Time => "time, s".into(),
    }
}
