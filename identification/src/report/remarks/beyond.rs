//! A validation record that goes where the training record was not.

use crate::model::effects::Against;
use crate::model::inverse::Model;
use crate::record::dataset::Dataset;
use crate::report::figures;

/// More than this share of half the travel beyond its ends is elsewhere.
const BEYOND: f64 = 0.02;
/// Less than this share of the rows there is no remark worth.
const FEWEST_ROWS: f64 = 0.01;

/// Which effects over position are not known where the validation record moves.
pub(super) fn beyond_the_travel(dataset: &Dataset, model: &Model) -> Option<String> {
    let over_position = model.parts.iter();
    let over_position = over_position.filter(|part| part.effect.against() == Against::Position);
    let mut names: Vec<String> = over_position
        .map(|part| part.called().to_string())
        .collect();
    names.dedup();
    let share = share_beyond(&dataset.validate.position, dataset.travel());
    (!names.is_empty() && share > FEWEST_ROWS).then(|| {
        let (middle, half) = dataset.travel();
        let unit = dataset.kind.position_unit();
        format!(
            "{} is known from {} to {} {unit}, where the training record moved; {} % of the validation record lies beyond: record the whole travel",
            names.join(" and "),
            figures::error(middle - half),
            figures::error(middle + half),
            figures::error(100.0 * share),
        )
    })
}

/// Share of positions beyond a travel, given by its middle and half.
fn share_beyond(positions: &[f64], (middle, half): (f64, f64)) -> f64 {
    let is_beyond = |x: &&f64| (**x - middle).abs() > (1.0 + BEYOND) * half;
    positions.iter().filter(is_beyond).count() as f64 / positions.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{axis, found, model, usual};
    use axis_model::EffectName::{Coulomb, PositionDependentFriction};

    #[test]
    fn friction_over_position_is_not_known_where_the_axis_was_not() {
        let mut dataset = axis(usual).dataset;
        let over_position = model(&[Coulomb]).with(found(PositionDependentFriction, 2.0));
        dataset.validate = dataset.train.clone();
        assert_eq!(beyond_the_travel(&dataset, &over_position), None);
        let (_, half) = dataset.travel();
        for x in dataset.validate.position.iter_mut().take(1500) {
            *x += 3.0 * half;
        }
        let said = beyond_the_travel(&dataset, &over_position).expect("it went further");
        assert!(
            said.starts_with("position_dependent_friction is known from "),
            "{said}"
        );
        assert!(said.contains("25"), "{said}");
        assert_eq!(beyond_the_travel(&dataset, &model(&[Coulomb])), None);
    }
}
