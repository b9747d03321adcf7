//! The law that the load's own motion tells of its friction, in the place of that of the effort.
//!
//! The effort shows a law through its noise, the load's motion through a spring and some counts.
//! The columns of the effort are those of that law then: the form and the velocity of the fall, and
//! the bristle or the elements. Coefficients stay the effort's own. Friction of the motor's side is
//! one more element beside those of the load.

use crate::evidence::difference::ByTheLoad;
use crate::evidence::inverse_dynamics::InverseDynamics;
use crate::evidence::reversal::bristle::Bristle;
use crate::evidence::reversal::slip::{Element, Elements, Fall};
use crate::fit::bench::Bench;
use crate::model::inverse::Model;

/// Deflection of a friction of the motor's side that turns over at once, in those of the load's.
const AT_ONCE: f64 = 1.0e-3;

/// A structure with the law that the load's motion tells, where that leaves less of moving samples
/// of both records, and about reversals less, or more by less than that.
pub(crate) fn or_by_the_load(
    before: InverseDynamics,
    [own, other]: [&Bench<'_>; 2],
    told: Option<&ByTheLoad>,
) -> InverseDynamics {
    let Some(changed) = told.and_then(|told| by_the_load(&before, own, told)) else {
        return before;
    };
    let leaves_less = |bench: &Bench<'_>| {
        let (dataset, motion) = (bench.dataset, bench.motion);
        let structures = [&before, &changed];
        let left = structures.map(|own| own.refitted(dataset, motion).on(dataset, motion));
        let [before, after] = left;
        let moving = after.force_percent / before.force_percent;
        moving < 1.0 && moving * after.reversal_rms < before.reversal_rms
    };
    if leaves_less(own) && leaves_less(other) {
        changed
    } else {
        before
    }
}

/// The same with that law; `None` where nothing bends before it slips, and where a bristle of the
/// load stands beside a friction of the motor's side.
fn by_the_load(
    before: &InverseDynamics,
    bench: &Bench<'_>,
    told: &ByTheLoad,
) -> Option<InverseDynamics> {
    before.bristle.as_ref()?;
    let (model, fall) = falling(before.fitted.model(), told);
    let elements = told.elements.clone().map(|elements| elements.under(fall));
    let bristle = match (elements, told.motor_side.is_some()) {
        (Some(elements), _) => Bristle::Slip(beside_the_motor(elements, told)),
        (None, false) => Bristle::Dahl(told.deflection.value),
        (None, true) => return None,
    };
    let seen = bristle.motion(bench.motion);
    Some(InverseDynamics {
        fitted: Bench::new(bench.dataset, &seen).fit(&model),
        bristle: Some(bristle),
    })
}

/// A model whose friction falls as that of the load, where both fall; and the fall.
fn falling(model: &Model, told: &ByTheLoad) -> (Model, Fall) {
    let mut falls = model.parts.iter();
    let place = falls.position(|part| part.effect.fall().is_some());
    let Some((place, form)) = place.zip(told.form()) else {
        return (model.clone(), Fall::default());
    };
    let velocity = told.velocity.value;
    let rise = told.excess.value / told.coulomb.value;
    let fall = form.fall().map(|law| Fall::by(rise, velocity, law));
    let model = model.with_form(place, form);
    (
        model.with_parameter(place, velocity),
        fall.unwrap_or_default(),
    )
}

/// Elements of a load beside the friction of the motor's side, where there is one.
fn beside_the_motor(elements: Elements, told: &ByTheLoad) -> Elements {
    let Some(motor) = told.motor_side else {
        return elements;
    };
    let at_once = AT_ONCE * told.deflection.value;
    elements.beside(Element {
        deflection: motor.deflection.map_or(at_once, |known| known.value),
        share: motor.coulomb.value / told.coulomb.value,
    })
}

#[cfg(test)]
mod tests {
    use axis_model::EffectName::Coulomb;

    use super::*;
    use crate::evidence::difference::{Known, MotorSide};
    use crate::evidence::inverse_dynamics::tests::{DEFLECTION_M, declared, record_with};
    use crate::evidence::reversal::slip::tests::elements;
    use crate::motion::kinematics::Kinematics;

    /// What a record of such elements becomes where the load's motion tells others, and friction of
    /// the motor's side.
    fn with(of_load: &[(f64, f64)], motor: Option<f64>) -> InverseDynamics {
        let whole = [(0.001, 0.2), (0.3, 0.4), (1.2, 0.4)];
        let whole = Bristle::Slip(elements(DEFLECTION_M, &whole));
        let dataset = declared(record_with(Some(&whole)));
        let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
        let bench = Bench::new(&dataset, &motion);
        let dahl = Bristle::Dahl(0.5 * DEFLECTION_M);
        let seen = dahl.motion(&motion);
        let before = InverseDynamics {
            fitted: Bench::new(&dataset, &seen).fit(&Model::declared(&dataset)),
            bristle: Some(dahl),
        };
        let mut told = ByTheLoad::of_elements(elements(DEFLECTION_M, of_load));
        told.coulomb = Known::new(300.0, 1.0);
        told.motor_side = motor.map(|coulomb| MotorSide {
            coulomb: Known::new(coulomb, 1.0),
            deflection: None,
        });
        or_by_the_load(before, [&bench, &bench], Some(&told))
    }

    #[test]
    fn the_law_of_the_load_stands_beside_the_motors_friction_where_it_leaves_less() {
        let right = with(&[(0.3, 0.5), (1.2, 0.5)], Some(60.0));
        let Some(Bristle::Slip(own)) = &right.bristle else {
            panic!("elements");
        };
        assert_eq!(own.elements().len(), 3);
        let coulomb = right.fitted.of(Coulomb).unwrap()[0];
        assert!((coulomb / 300.0 - 1.0).abs() < 0.002, "{coulomb}");
        // Ten times as deep they leave more than a bristle.
        let wrong = with(&[(3.0, 0.5), (12.0, 0.5)], None);
        assert!(matches!(wrong.bristle, Some(Bristle::Dahl(_))));
    }
}
