//! An offset: a constant force, or friction that differs by direction.

use axis_model::EffectName::{self, Coulomb, CoulombAsymmetry, FrictionDrift, Offset, Stribeck};

use crate::fit::fitted::Fitted;
use crate::record::dataset::Dataset;

/// Level and fall differ by direction alike where their shares are within this factor.
const ALIKE: f64 = 1.5;

const SAME_FORCE: &str = "offset and coulomb_asymmetry are the same force (a constant one, at rest \
                          as in motion): nothing in this record tells them apart, and offset \
                          stands for both";

/// What an offset may be: only friction that falls or drifts by direction tells an asymmetry from a
/// force, and the motion of a load, which says how large it is.
pub(super) fn of_an_offset(
    dataset: &Dataset,
    found: &[EffectName],
    fitted: &Fitted,
    by_the_load: Option<f64>,
) -> Option<String> {
    let has = |name: EffectName| found.contains(&name) || dataset.declares(name);
    if !has(Offset) && !has(CoulombAsymmetry) {
        return None;
    }
    let by_the_load = by_the_load.map(|share| ("load's friction about reversals", share));
    let Some((what_differs, share)) = by_the_load.or_else(|| share_by_direction(fitted)) else {
        return Some(SAME_FORCE.to_owned());
    };
    let first = |name| fitted.of(name).and_then(<[f64]>::first).copied();
    let level = first(Offset)? / first(Coulomb)?;
    let is_alike = (1.0 / ALIKE..ALIKE).contains(&(level / share));
    let what = if is_alike {
        "offset is coulomb_asymmetry"
    } else {
        "offset is coulomb_asymmetry and a constant force"
    };
    let [level, share] = [level, share].map(|share| 100.0 * share);
    Some(format!(
        "{what}: the {what_differs} differs by direction by {share:+.0} % of its size, the friction in motion by {level:+.0} %"
    ))
}

/// What differs by direction and is friction alone, and by which share of its size.
fn share_by_direction(fitted: &Fitted) -> Option<(&'static str, f64)> {
    if let Some(&[excess, by_direction]) = fitted.of(Stribeck) {
        return Some(("Stribeck fall", by_direction / excess));
    }
    let &[drift, _, by_direction] = fitted.of(FrictionDrift)? else {
        return None;
    };
    Some(("friction drift", by_direction / drift))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{axis, found, model, usual};
    use crate::model::effects::find;

    /// What is said of an offset beside 100 N, and of a fall of 50 N.
    fn said(offset: f64, by_direction: Option<f64>) -> Option<String> {
        let dataset = axis(usual).dataset;
        let usual = model(&[Coulomb, Offset]).with(found(Stribeck, 0.01));
        let fitted = match by_direction {
            None => Fitted::new(usual, &[100.0, offset, 50.0]),
            Some(size) => {
                let form = find(Stribeck).unwrap().by_direction().unwrap();
                Fitted::new(usual.with_form(2, form), &[100.0, offset, 50.0, size])
            }
        };
        of_an_offset(&dataset, &[Offset], &fitted, None)
    }

    #[test]
    fn a_drift_by_direction_tells_an_asymmetry_as_a_fall_does() {
        let dataset = axis(usual).dataset;
        let drift = find(FrictionDrift).unwrap().by_direction().unwrap();
        let model = model(&[Coulomb, Offset])
            .with(found(FrictionDrift, 3.0))
            .with_form(2, drift);
        let fitted = Fitted::new(model, &[100.0, 25.0, -40.0, 1.0, -10.0]);
        let said = of_an_offset(&dataset, &[Offset], &fitted, None).unwrap();
        assert!(
            said.starts_with("offset is coulomb_asymmetry: the friction drift"),
            "{said}"
        );
    }

    #[test]
    fn a_load_that_turns_over_otherwise_each_way_tells_an_asymmetry() {
        let dataset = axis(usual).dataset;
        let fitted = Fitted::new(model(&[Coulomb, Offset]), &[100.0, 12.0]);
        let said = of_an_offset(&dataset, &[Offset], &fitted, Some(0.11)).unwrap();
        assert!(
            said.starts_with("offset is coulomb_asymmetry: the load's friction about reversals")
                && said.contains("+11 %")
                && said.contains("+12 %"),
            "{said}"
        );
    }

    #[test]
    fn only_a_fall_by_direction_tells_an_asymmetry_from_a_force() {
        assert_eq!(said(-20.0, None).as_deref(), Some(SAME_FORCE));
        let alike = said(-20.0, Some(-11.0)).unwrap();
        assert!(
            alike.starts_with("offset is coulomb_asymmetry: ")
                && alike.contains("-22 %")
                && alike.contains("-20 %"),
            "{alike}"
        );
        let more = said(60.0, Some(-11.0)).unwrap();
        assert!(more.contains("and a constant force"), "{more}");
    }
}
