//! The law that the load's own motion tells of its friction, in the place of that of the effort.
//!
//! The effort shows a law through its noise, the load's motion through a spring and some counts.
//! The columns of the effort are those of that law then: the form and the velocity of the fall, and
//! the bristle or the elements. Coefficients stay the effort's own. Friction of the motor's side is
//! one more element beside those of the load, or as many as it has of its own. A bristle of the
//! load beside such a friction, and a fall that the effort has not, are not put in.

use crate::evidence::difference::ByTheLoad;
use crate::evidence::inverse_dynamics::InverseDynamics;
use crate::evidence::reversal::bristle::Bristle;
use crate::evidence::reversal::slip::{Element, Elements, Fall};
use crate::fit::bench::Bench;
use crate::fit::fitted::Fitted;
use crate::fit::told;
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
        moving < 1.0 && moving * after.reversal_rms <= before.reversal_rms
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
    let (model, fall) = falling(&before.fitted, told);
    let elements = told.elements.clone().map(|elements| elements.under(fall));
    let bristle = match (elements, told.motor_side.is_some()) {
        (Some(elements), _) => Bristle::Slip(beside_the_motor(elements, told)),
        (None, false) => Bristle::Dahl(fall.at_rest() * told.deflection.value),
        (None, true) => return None,
    };
    let seen = bristle.motion(bench.motion);
    let bench = Bench::new(bench.dataset, &seen);
    Some(InverseDynamics {
        fitted: bench.fit(&told::of_the_others(&bench, model)),
        bristle: Some(bristle),
        by_the_load: Some(told.deflection),
        slips_at: None,
    })
}

/// A model whose friction falls as that of the load, where both fall, by direction where it did;
/// and the fall.
fn falling(fitted: &Fitted, told: &ByTheLoad) -> (Model, Fall) {
    let model = fitted.model();
    let mut falls = model.parts.iter();
    let place = falls.position(|part| part.effect.fall().is_some());
    let law = told.form().and_then(|form| Some((form, form.fall()?)));
    let Some((place, (form, law))) = place.zip(law) else {
        return (model.clone(), Fall::of(fitted));
    };
    let by_direction = form
        .by_direction()
        .filter(|_| model.parts[place].width() > 1);
    let model = model.with_form(place, by_direction.unwrap_or(form));
    let velocity = told.velocity.value;
    let rise = told.excess.value / told.coulomb.value;
    (
        model.with_parameter(place, velocity),
        Fall::by(rise, velocity, law),
    )
}

/// Elements of a load beside the friction of the motor's side, where there is one.
fn beside_the_motor(elements: Elements, told: &ByTheLoad) -> Elements {
    let Some(motor) = told.motor_side else {
        return elements;
    };
    let at_once = AT_ONCE * told.deflection.value;
    let alone = (motor.deflection.map_or(at_once, |known| known.value), 1.0);
    let mut own = motor.elements();
    if own.is_empty() {
        own.push(alone);
    }
    let motor_share = motor.coulomb.value / told.coulomb.value;
    let element = |(deflection, share): (f64, f64)| Element {
        deflection,
        share: motor_share * share,
    };
    elements.beside(&own.into_iter().map(element).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use axis_model::EffectName::Coulomb;

    use super::*;
    use crate::evidence::difference::{Known, MotorSide};
    use crate::evidence::inverse_dynamics::tests::{
        DEFLECTION_M, LAG_S, declared, lagging, record_with,
    };
    use crate::evidence::reversal::slip::tests::elements;
    use crate::motion::kinematics::Kinematics;
    use crate::record::dataset::Dataset;

    /// What a dataset becomes from a bristle half as deep as its own and such a model, where the
    /// load's motion tells this.
    fn with(dataset: &Dataset, model: &Model, told: &ByTheLoad) -> InverseDynamics {
        let motion = Kinematics::new(dataset, &dataset.train).unwrap();
        let bench = Bench::new(dataset, &motion);
        let dahl = Bristle::Dahl(0.5 * DEFLECTION_M);
        let seen = dahl.motion(&motion);
        let before = InverseDynamics {
            fitted: Bench::new(dataset, &seen).fit(model),
            bristle: Some(dahl),
            by_the_load: None,
            slips_at: None,
        };
        or_by_the_load(before, [&bench, &bench], Some(told))
    }

    /// What a record of elements and friction of the motor becomes where the load's motion tells
    /// others, and as much friction of the motor's side.
    fn of_elements(of_load: &[(f64, f64)], motor: Option<f64>) -> InverseDynamics {
        let whole = [(0.001, 0.2), (0.3, 0.4), (1.2, 0.4)];
        let whole = Bristle::Slip(elements(DEFLECTION_M, &whole));
        let dataset = declared(record_with(Some(&whole)));
        let mut told = ByTheLoad::of_elements(elements(DEFLECTION_M, of_load));
        told.coulomb = Known::new(300.0, 1.0);
        told.motor_side = motor.map(|coulomb| MotorSide {
            coulomb: Known::new(coulomb, 1.0),
            deflection: None,
            law: None,
        });
        with(&dataset, &Model::declared(&dataset), &told)
    }

    /// A load's bristle under a fall that lags, as deep as the Coulomb level says.
    fn lagging_bristle() -> ByTheLoad {
        let at = DEFLECTION_M * 300.0 / 500.0;
        let mut told = ByTheLoad::of_elements(elements(at, &[(1.0, 1.0)]));
        told.elements = None;
        told.coulomb = Known::new(300.0, 1.0);
        told.excess = Known::new(200.0, 1.0);
        told.velocity = Known::new(0.01, 1.0e-4);
        told.lag = Some(Known::new(LAG_S, 1.0e-4));
        told
    }

    #[test]
    fn a_bristle_of_the_load_turns_over_by_the_level_at_rest_and_falls_by_direction_where_it_did() {
        let (dataset, told) = (lagging(), lagging_bristle());
        let plain = Model::declared(&dataset);
        let by_direction = plain.parts[3].effect.by_direction().unwrap();
        for (model, sizes) in [(plain.clone(), 1), (plain.with_form(3, by_direction), 2)] {
            let found = with(&dataset, &model, &told);
            assert_eq!(found.by_the_load, Some(told.deflection));
            let deflection = found.bristle.as_ref().unwrap().deflection();
            assert!((deflection / DEFLECTION_M - 1.0).abs() < 1.0e-9);
            let fall = found.fitted.terms().last().unwrap();
            assert_eq!(fall.own.len(), sizes);
            assert!((fall.own[0] - 200.0).abs() < 0.2, "{:?}", fall.own);
            let coulomb = found.fitted.of(Coulomb).unwrap()[0];
            assert!((coulomb - 300.0).abs() < 0.3, "{coulomb}");
        }
    }

    #[test]
    fn a_bristle_of_the_load_beside_friction_of_the_motor_is_not_put_in() {
        let (dataset, mut told) = (lagging(), lagging_bristle());
        told.motor_side = Some(MotorSide {
            coulomb: Known::new(60.0, 1.0),
            deflection: None,
            law: None,
        });
        let found = with(&dataset, &Model::declared(&dataset), &told);
        assert_eq!(found.by_the_load, None);
    }

    #[test]
    fn the_law_of_the_load_stands_beside_the_motors_friction_where_it_leaves_less() {
        let right = of_elements(&[(0.3, 0.5), (1.2, 0.5)], Some(60.0));
        let Some(Bristle::Slip(own)) = &right.bristle else {
            panic!("elements");
        };
        assert_eq!(own.elements().len(), 3);
        let coulomb = right.fitted.of(Coulomb).unwrap()[0];
        assert!((coulomb / 300.0 - 1.0).abs() < 0.002, "{coulomb}");
        // Ten times as deep they leave more than a bristle.
        let wrong = of_elements(&[(3.0, 0.5), (12.0, 0.5)], None);
        assert_eq!(wrong.by_the_load, None);
    }
}
