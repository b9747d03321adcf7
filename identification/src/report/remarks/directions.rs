//! An offset: a constant force, or friction that differs by direction.

use axis_model::EffectName::{self, Coulomb, CoulombAsymmetry, Offset, Stribeck};

use crate::fit::fitted::Fitted;
use crate::record::dataset::Dataset;

/// Level and fall differ by direction alike where their shares are within this factor.
const ALIKE: f64 = 1.5;

const SAME_FORCE: &str = "offset and coulomb_asymmetry are the same force (a constant one, at rest \
                          as in motion): no record tells them apart, and offset stands for both";

/// What an offset may be: only friction that falls by direction tells an asymmetry from a force.
pub(super) fn of_an_offset(
    dataset: &Dataset,
    found: &[EffectName],
    fitted: &Fitted,
) -> Option<String> {
    let has = |name: EffectName| found.contains(&name) || dataset.declares(name);
    if !has(Offset) && !has(CoulombAsymmetry) {
        return None;
    }
    let Some(&[excess, by_direction]) = fitted.of(Stribeck) else {
        return Some(SAME_FORCE.to_owned());
    };
    let first = |name| fitted.of(name).and_then(<[f64]>::first).copied();
    let level = first(Offset)? / first(Coulomb)?;
    let fall = by_direction / excess;
    let is_alike = (1.0 / ALIKE..ALIKE).contains(&(level / fall));
    let what = if is_alike {
        "offset is coulomb_asymmetry"
    } else {
        "offset is coulomb_asymmetry and a constant force"
    };
    let [level, fall] = [level, fall].map(|share| 100.0 * share);
    Some(format!(
        "{what}: the Stribeck fall differs by direction by {fall:+.0} % of its size, the friction in motion by {level:+.0} %"
    ))
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
        of_an_offset(&dataset, &[Offset], &fitted)
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
