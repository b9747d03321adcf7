//! The parameters of the extended model, with intervals, by name.
//!
//! Each comes from the output that shows it best: columns, delay and saturation from the effort,
//! deflection and gap from the free run where that decided, gap, stiffness and pitch error from
//! motor − load where there is a load scale.

use std::borrow::Cow;
use std::collections::BTreeMap;

use axis_model::EffectName::{self, TorqueRipple};
use axis_model::vocabulary::{Backlash, Compliance, PitchError, Presliding};
use axis_model::{Effect, Estimate};

use crate::evidence::counted_mass;
use crate::evidence::difference::{ByTheLoad, Difference, Known, More};
use crate::evidence::findings::Findings;
use crate::evidence::reversal::bristle::Bristle;
use crate::evidence::slow_ripple::OrderAtReversals;
use crate::evidence::thresholds::WRONG_IN_FORM;
use crate::fit::primes::without_primes;
use crate::model::effects::{Named, Naming};
use crate::model::inverse::{Model, Part};
use crate::model::name::Called;
use crate::report::ranking;

/// What the vocabulary calls the deflection of a bristle.
pub(crate) const DEFLECTION: &str = "presliding_deflection";

/// What the vocabulary calls Coulomb friction by direction.
pub(crate) const COULOMB_ASYMMETRY: &str = "coulomb_asymmetry";

/// What falls with the speed, in the table.
const EXCESS: &str = "stribeck_excess";

/// A parameter with its name.
type Entry = (String, Estimate);

/// The parameters of an identification: each once, with the output that it comes from.
pub(crate) struct Parameters {
    /// Values and intervals.
    pub estimates: BTreeMap<String, Estimate>,
    /// Outputs.
    pub from: BTreeMap<String, &'static str>,
}

/// The table of an identification.
pub(crate) fn parameters(findings: &Findings<'_>) -> Parameters {
    let stages = &findings.stages;
    let difference = stages.difference.iter();
    let between = difference.flat_map(|difference| of_the_difference(findings, difference));
    let orders = stages.ripple.iter().flat_map(|ripple| &ripple.orders);
    let of_outputs = [
        (ranking::EFFORT, entries(of_the_inverse_model(findings))),
        of_the_shape(findings),
        (
            ranking::DIFFERENCE,
            between.flat_map(|effect| of_an_effect(&effect)).collect(),
        ),
        (
            ranking::ABOUT_FAST_REVERSALS,
            orders.map(|order| of_an_order(findings, order)).collect(),
        ),
    ];
    let mut parameters = table(of_outputs);
    parameters.count_the_mass_of_the_load(findings);
    let told = by_the_load(findings);
    if let Some(told) = told {
        parameters.without_shape_of_fall(told);
        // What the motor's side has of a fall the effort alone shows, beside the law of the load.
        let has_both = findings.models.extended.by_the_load.is_some() && told.motor_side.is_some();
        for (name, estimate) in of_the_load(findings, told) {
            if !(has_both && name == EXCESS && parameters.knows_better(name, &estimate)) {
                parameters.replace(name, estimate);
            }
        }
    }
    let difference = stages.difference.as_ref();
    if let Some(motor) = difference.and_then(|difference| difference.motor_coulomb) {
        let unit = findings.dataset.effort.unit();
        let is_seen = told.is_some_and(|told| told.motor_side.is_some());
        parameters.share_out_coulomb(about(motor.value, motor.half_width, unit.into()), is_seen);
    }
    parameters.widened(WRONG_IN_FORM)
}

impl Parameters {
    /// The same with half widths times a factor.
    fn widened(mut self, by: f64) -> Self {
        for estimate in self.estimates.values_mut() {
            let half_width = by * estimate.half_width();
            *estimate = about(
                estimate.value,
                half_width,
                std::mem::take(&mut estimate.unit),
            );
        }
        self
    }

    /// What the effort says of the mass of the load is off by what rounding of the positions makes.
    fn count_the_mass_of_the_load(&mut self, findings: &Findings<'_>) {
        let whole = self.estimates.get("inertia").map(|whole| whole.value);
        let (Some(whole), Some(load)) = (whole, self.estimates.get_mut("load_inertia")) else {
            return;
        };
        let off = counted_mass::off(findings.dataset, findings.motion, [whole, load.value]);
        *load = about(
            load.value,
            load.half_width().hypot(off),
            std::mem::take(&mut load.unit),
        );
    }

    /// Takes exponent and lag of a fall away where the load's motion tells its excess and velocity:
    /// those go with an exponent and a lag of their own.
    fn without_shape_of_fall(&mut self, told: &ByTheLoad) {
        if told.excess.value > 0.0 {
            for name in ["stribeck_exponent", "stribeck_lag", "stribeck_lag_growth"] {
                self.estimates.remove(name);
                self.from.remove(name);
            }
        }
    }

    /// The Coulomb friction on either side of a spring, where the motor's own side is seen to have
    /// some, as the stiffness was told with it or its interval says: that, and what is left of the
    /// whole for the load.
    fn share_out_coulomb(&mut self, motor: Estimate, is_seen: bool) {
        let whole = self.estimates.get("coulomb");
        let Some(whole) = whole.filter(|_| is_seen || motor.low > 0.0) else {
            return;
        };
        let half_width = whole.half_width().hypot(motor.half_width());
        let load = about(whole.value - motor.value, half_width, motor.unit.clone());
        self.replace("motor_coulomb", motor);
        self.replace("load_coulomb", load);
    }

    /// Whether it is in a narrower interval already.
    fn knows_better(&self, name: &str, estimate: &Estimate) -> bool {
        let own = self.estimates.get(name);
        own.is_some_and(|own| own.half_width() > 0.0 && own.half_width() < estimate.half_width())
    }

    /// A parameter by motion of the load, which knows it better than any output before.
    fn replace(&mut self, name: &str, estimate: Estimate) {
        self.from.insert(name.into(), ranking::DIFFERENCE);
        self.estimates.insert(name.into(), estimate);
    }
}

/// What the load's own motion tells: masses and the screw; the friction as far as the model has it.
fn of_the_load(findings: &Findings<'_>, told: &ByTheLoad) -> Vec<(&'static str, Estimate)> {
    let (effort, length) = (
        findings.dataset.effort.unit(),
        findings.dataset.kind.position_unit(),
    );
    let stiffness = format!("{effort}/{length}");
    let mut own = vec![
        (
            "load_inertia",
            estimate(told.mass, &format!("{effort} s2/{length}")),
        ),
        ("compliance_stiffness", estimate(told.stiffness, &stiffness)),
        (
            "compliance_damping",
            estimate(told.damping, &format!("{effort} s/{length}")),
        ),
    ];
    own.extend(told.gap.map(|gap| ("backlash_gap", estimate(gap, length))));
    let deflection = told.motor_side.and_then(|motor| motor.deflection);
    own.extend(deflection.map(|deflection| ("motor_deflection", estimate(deflection, length))));
    own.extend(bristle_of_the_load(findings, told));
    own.extend(asymmetry_of_the_load(findings, told));
    own.extend(sliding_of_the_load(findings, told));
    own
}

/// Deflection and damping of the bristle, where the model has one of that law.
fn bristle_of_the_load(findings: &Findings<'_>, told: &ByTheLoad) -> Vec<(&'static str, Estimate)> {
    let length = findings.dataset.kind.position_unit();
    let is_of_its_law = match findings.models.extended.bristle {
        Some(Bristle::Dahl(_)) => true,
        Some(Bristle::Slip(_)) => law_of_the_load(told).is_some(),
        None => false,
    };
    if !is_of_its_law {
        return Vec::new();
    }
    let damping = told.bristle_damping;
    let unit = format!("{} s/{length}", findings.dataset.effort.unit());
    let damping = (damping.value > damping.half_width)
        .then(|| ("presliding_damping", estimate(damping, &unit)));
    let deflection = (DEFLECTION, estimate(told.deflection, length));
    [Some(deflection), damping].into_iter().flatten().collect()
}

/// By which share the Coulomb level differs by direction, where that is certain and the model has
/// the constant force that goes with it.
fn asymmetry_of_the_load(
    findings: &Findings<'_>,
    told: &ByTheLoad,
) -> Option<(&'static str, Estimate)> {
    let own = told.coulomb_asymmetry?;
    let has_offset = findings.models.extended.fitted.of(EffectName::Offset);
    let is_certain = own.value.abs() > WRONG_IN_FORM * own.half_width;
    (is_certain && has_offset.is_some()).then(|| (COULOMB_ASYMMETRY, estimate(own, "")))
}

/// Friction of a load that slides. Along the travel the Coulomb level of the model is another one
/// than that of its middle.
fn sliding_of_the_load(findings: &Findings<'_>, told: &ByTheLoad) -> Vec<(&'static str, Estimate)> {
    let (effort, length) = (
        findings.dataset.effort.unit(),
        findings.dataset.kind.position_unit(),
    );
    let damping = format!("{effort} s/{length}");
    let fitted = &findings.models.extended.fitted;
    let mut own = Vec::new();
    if fitted.of(EffectName::Stribeck).is_some() && told.excess.value > 0.0 {
        let velocity = estimate(told.velocity, &format!("{length}/s"));
        own.push((EXCESS, estimate(told.excess, effort)));
        own.push(("stribeck_velocity", velocity));
        let lag = told.lag.map(|lag| ("stribeck_lag", estimate(lag, "s")));
        let exponent = told.exponent;
        let exponent = exponent.map(|exponent| ("stribeck_exponent", estimate(exponent, "")));
        let growth = told.lag_growth;
        let growth = growth.map(|growth| ("stribeck_lag_growth", estimate(growth, "")));
        own.extend(lag.into_iter().chain(growth).chain(exponent));
    }
    let is_level = fitted.of(EffectName::Stribeck).is_some() && told.excess.value <= 0.0;
    if told.motor_side.is_some() || is_level || !is_told(fitted.model(), told.more) {
        return own;
    }
    if !told.more.over_position {
        own.push(("coulomb", estimate(told.coulomb, effort)));
    }
    own.push(("viscous", estimate(told.viscous, &damping)));
    let has_both = fitted.of(EffectName::ViscousAsymmetry).is_some();
    let asymmetry = told.viscous_asymmetry.filter(|_| has_both);
    own.extend(asymmetry.map(|asymmetry| ("viscous_asymmetry", estimate(asymmetry, &damping))));
    own
}

fn estimate(known: Known, unit: &str) -> Estimate {
    about(known.value, known.half_width, unit.into())
}

/// What the load's own motion tells.
fn by_the_load<'a>(findings: &'a Findings<'_>) -> Option<&'a ByTheLoad> {
    let difference = findings.stages.difference.as_ref()?;
    difference.by_the_load.as_ref()
}

/// The bristle of the extended model; that of the load's motion where elements slip on a side.
pub(crate) fn bristle<'a>(findings: &'a Findings<'_>) -> Option<Cow<'a, Bristle>> {
    let own = findings.models.extended.bristle.as_ref()?;
    let of_load = by_the_load(findings).and_then(law_of_the_load);
    Some(of_load.map_or(Cow::Borrowed(own), Cow::Owned))
}

/// The law of the load's friction where elements slip on a side: those of the load, or its bristle
/// beside those of the motor, which the effort sees as elements of both.
fn law_of_the_load(told: &ByTheLoad) -> Option<Bristle> {
    let is_beside = !elements_of_the_motor(told).is_empty();
    let bristle = is_beside.then_some(Bristle::Dahl(told.deflection.value));
    told.elements.clone().map(Bristle::Slip).or(bristle)
}

/// Elements of the motor's own side, where it has some: where each slips, and its share.
pub(crate) fn motor_elements(findings: &Findings<'_>) -> Vec<(f64, f64)> {
    by_the_load(findings).map_or_else(Vec::new, elements_of_the_motor)
}

fn elements_of_the_motor(told: &ByTheLoad) -> Vec<(f64, f64)> {
    let motor = told.motor_side;
    motor.map_or_else(Vec::new, |motor| motor.elements())
}

/// Effects beside which Coulomb and viscous friction are those of the load alone: none of them is a
/// friction of another law.
const BESIDE_USUAL: [EffectName; 8] = [
    EffectName::Inertia,
    EffectName::Viscous,
    EffectName::Coulomb,
    EffectName::Offset,
    EffectName::Stribeck,
    EffectName::TorqueRipple,
    EffectName::Delay,
    EffectName::LoggedLate,
];

/// Whether a model has Coulomb and viscous friction, and no other but a Stribeck fall and what else
/// the load's motion tells.
fn is_told(model: &Model, more: More) -> bool {
    let is_usual = |part: &Part| match part.called() {
        Called::Effect(EffectName::ViscousAsymmetry) => more.by_direction,
        Called::Effect(EffectName::PositionDependentFriction) => more.over_position,
        Called::Effect(EffectName::QuadraticDrag) => more.squared,
        Called::Effect(name) => BESIDE_USUAL.contains(&name),
        Called::Structure(_) => part.effect.is_mass(),
    };
    let drags_alike = !more.squared || model.has(EffectName::QuadraticDrag);
    drags_alike
        && model.has(EffectName::Coulomb)
        && model.has(EffectName::Viscous)
        && model.parts.iter().all(is_usual)
}

/// Entries of outputs as a table; a name that comes again gets a number.
fn table(of_outputs: impl IntoIterator<Item = (&'static str, Vec<Entry>)>) -> Parameters {
    let (mut estimates, mut from) = (BTreeMap::new(), BTreeMap::new());
    for (output, entries) in of_outputs {
        for (name, estimate) in entries {
            let key = free_key(&estimates, &name);
            from.insert(key.clone(), output);
            estimates.insert(key, estimate);
        }
    }
    Parameters { estimates, from }
}

fn free_key(table: &BTreeMap<String, Estimate>, name: &str) -> String {
    let keys = (1..).map(|times| match times {
        1 => name.to_owned(),
        times => format!("{name}_{times}"),
    });
    let mut free = keys.skip_while(|key| table.contains_key(key));
    free.next().unwrap_or_default()
}

/// Named quantities as entries.
fn entries(named: Vec<Named>) -> Vec<Entry> {
    let entry = |named: Named| {
        let half_width = named.half_width.unwrap_or(0.0);
        (named.name, about(named.value, half_width, named.unit))
    };
    named.into_iter().map(entry).collect()
}

/// The parameters of an effect, named as its vocabulary names them.
fn of_an_effect(effect: &Effect<Estimate>) -> Vec<Entry> {
    let parts = effect.parts().into_iter();
    parts
        .map(|(row, estimate)| (row.report_name(), estimate.clone()))
        .collect()
}

fn about(value: f64, half_width: f64, unit: String) -> Estimate {
    Estimate {
        value,
        unit,
        low: value - half_width,
        high: value + half_width,
    }
}

/// A quantity without an interval.
fn plain(value: f64, unit: &str) -> Estimate {
    about(value, 0.0, unit.into())
}

fn of_the_inverse_model(findings: &Findings<'_>) -> Vec<Named> {
    let extended = &findings.models.extended;
    let mut estimates = extended.estimates(findings.dataset, [findings.motion, findings.low]);
    findings.on_both.widen(&mut estimates);
    let estimates = without_primes(estimates);
    let parameters = estimates.iter().flat_map(|estimate| {
        estimate.part.effect.parameters(&Naming {
            parameter: estimate.part.parameter,
            parameter_half_width: estimate.parameter_half_width,
            form_half_width: estimate.form_half_width,
            lag_half_width: estimate.lag_half_width,
            coefficients: &estimate.own,
            dataset: findings.dataset,
        })
    });
    parameters.collect()
}

/// Deflection and gap, with their output: from the free run with their intervals where that
/// decided, else the deflection that the effort about reversals gave. A deflection is the Coulomb
/// level over the stiffness at standstill. The bristle of effort and free run turns over by the
/// level at its velocity: where that falls, it is as stiff as the level at rest says. Elements that
/// slip have the stiffness of the Coulomb level already.
fn of_the_shape(findings: &Findings<'_>) -> (&'static str, Vec<Entry>) {
    let (output, mut shape) = of_the_shape_as_fitted(findings);
    let extended = &findings.models.extended;
    let first = |name| extended.fitted.of(name).and_then(<[f64]>::first).copied();
    if let Some(Bristle::Slip(_)) = extended.bristle {
        return (output, shape);
    }
    let levels = first(EffectName::Coulomb).zip(first(EffectName::Stribeck));
    let share = levels.and_then(|(sliding, excess)| share_of_rest(sliding, excess));
    let deflections = shape.iter_mut().filter(|(name, _)| name == DEFLECTION);
    for (_, deflection) in deflections {
        let by_dahl = scaled(deflection, share.unwrap_or(1.0));
        *deflection = as_near_as_laws_agree(by_dahl, extended.slips_at);
    }
    (output, shape)
}

/// A deflection by Dahl's law, no nearer known than elements agree that leave as much.
fn as_near_as_laws_agree(by_dahl: Estimate, slips_at: Option<f64>) -> Estimate {
    let apart = slips_at.map_or(0.0, |slips_at| (slips_at - by_dahl.value).abs());
    let half_width = by_dahl.half_width().max(apart);
    about(by_dahl.value, half_width, by_dahl.unit)
}

/// The sliding level over that at rest.
fn share_of_rest(sliding: f64, excess: f64) -> Option<f64> {
    (sliding > 0.0 && excess > 0.0).then(|| sliding / (sliding + excess))
}

/// An estimate times a factor above zero.
fn scaled(estimate: &Estimate, factor: f64) -> Estimate {
    Estimate {
        value: factor * estimate.value,
        low: factor * estimate.low,
        high: factor * estimate.high,
        unit: estimate.unit.clone(),
    }
}

fn of_the_shape_as_fitted(findings: &Findings<'_>) -> (&'static str, Vec<Entry>) {
    let Some(reversals) = findings.stages.reversals.accepted_shape() else {
        let length = findings.dataset.kind.position_unit();
        let gap = findings.stages.reversals.gap_by_effort();
        // Behind a gap the bristle is stiffer than one that stands for both.
        let bristle = gap.map(|gap| plain(gap.deflection, length));
        let alone = || {
            let extended = &findings.models.extended;
            let known = extended.known_deflection(findings.dataset, findings.motion);
            known.map(|known| about(known.value, known.half_width, length.into()))
        };
        let bristle = bristle.or_else(alone).map(bristle_of);
        let gap = gap.map(|gap| gap_of(plain(gap.width, length)));
        let shape = bristle.iter().chain(&gap).flat_map(of_an_effect);
        return (ranking::ABOUT_REVERSALS, shape.collect());
    };
    // The free run has Dahl's bristle only.
    if let Some(slipping) = slipping(findings) {
        let shape = of_an_effect(&bristle_of(slipping));
        return (ranking::ABOUT_REVERSALS, shape.into_iter().collect());
    }
    let shape = reversals.estimates(findings.dataset);
    let shape = shape.iter().flat_map(of_an_effect);
    (ranking::FREE_RUN, shape.collect())
}

/// The deflection of Maxwell slip, where that was found.
fn slipping(findings: &Findings<'_>) -> Option<Estimate> {
    let Some(Bristle::Slip(elements)) = &findings.models.extended.bristle else {
        return None;
    };
    let known = elements.known_deflection();
    let length = findings.dataset.kind.position_unit();
    Some(about(known.value, known.half_width, length.into()))
}

fn bristle_of(deflection: Estimate) -> Effect<Estimate> {
    Effect::from(Presliding {
        deflection,
        damping: None,
    })
}

fn gap_of(gap: Estimate) -> Effect<Estimate> {
    Effect::from(Backlash {
        gap,
        load_share: None,
        motor_friction: None,
        restitution: None,
    })
}

fn of_the_difference(findings: &Findings<'_>, difference: &Difference) -> Vec<Effect<Estimate>> {
    let length = findings.dataset.kind.position_unit();
    let stiffness_unit = format!("{}/{length}", findings.dataset.effort.unit());
    let gap = difference.gap.map(|gap| gap_of(estimate(gap, length)));
    let compliance = difference.stiffness.map(|stiffness| {
        Effect::from(Compliance {
            stiffness: estimate(stiffness, &stiffness_unit),
            damping: None,
        })
    });
    let pitch_errors = difference.pitch.iter().map(|(amplitude, per_length)| {
        Effect::from(PitchError {
            amplitude: estimate(*amplitude, length),
            period: estimate(per_length.inverse(), length),
        })
    });
    let all = gap.into_iter().chain(compliance).chain(pitch_errors);
    all.collect()
}

/// A ripple of which the amplitude alone is known.
fn of_an_order(findings: &Findings<'_>, order: &OrderAtReversals) -> Entry {
    let unit = findings.dataset.effort.unit().to_owned();
    (
        format!("{TorqueRipple}_amplitude_order_{}", order.per_rev),
        about(order.amplitude, order.half_width, unit),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(name: &str, value: f64, half_width: Option<f64>) -> Named {
        Named {
            name: name.into(),
            value,
            half_width,
            unit: "N".into(),
        }
    }

    #[test]
    fn the_narrower_interval_is_the_better_one_and_none_is_no_interval() {
        let knows_better = |half_width: f64| {
            let own = (EXCESS.to_owned(), about(120.0, half_width, "N".into()));
            let parameters = table([(ranking::EFFORT, vec![own])]);
            parameters.knows_better(EXCESS, &about(142.0, 57.0, "N".into()))
        };
        assert!(knows_better(56.0));
        assert!(!knows_better(57.0) && !knows_better(113.0));
        assert!(!knows_better(0.0));
    }

    #[test]
    fn the_load_has_what_the_motors_side_leaves_of_the_friction() {
        let newtons = |value, half_width| about(value, half_width, "N".into());
        let mut all = table([("effort", vec![("coulomb".into(), newtons(25.0, 0.3))])]);
        all.share_out_coulomb(newtons(10.0, 0.4), false);
        assert_eq!(all.estimates["motor_coulomb"], newtons(10.0, 0.4));
        assert_eq!(all.estimates["load_coulomb"], newtons(15.0, 0.5));
        assert_eq!(all.from["load_coulomb"], ranking::DIFFERENCE);
        // No friction of the motor is seen, or none at all.
        let mut unseen = table([("effort", vec![("coulomb".into(), newtons(25.0, 0.3))])]);
        unseen.share_out_coulomb(newtons(10.0, 11.0), false);
        assert_eq!(unseen.estimates.len(), 1);
        // The stiffness was told with it, so it is there however uncertain it is.
        unseen.share_out_coulomb(newtons(10.0, 11.0), true);
        assert_eq!(unseen.estimates["load_coulomb"].value, 15.0);
        let mut none = table([("effort", Vec::new())]);
        none.share_out_coulomb(newtons(10.0, 0.4), false);
        assert!(none.estimates.is_empty());
    }

    #[test]
    fn an_interval_stands_about_its_value() {
        let list = entries(vec![named("coulomb", 10.0, Some(0.5))]);
        let wanted = Estimate {
            value: 10.0,
            unit: "N".into(),
            low: 9.5,
            high: 10.5,
        };
        assert_eq!(list, [("coulomb".to_owned(), wanted)]);
    }

    #[test]
    fn friction_of_another_law_keeps_coulomb_and_viscous_friction_with_the_effort() {
        use crate::fit::made::{found, model};
        use EffectName::{
            Coulomb, FrictionDrift, Inertia, Offset, Stribeck, Viscous, ViscousAsymmetry,
        };
        let usual = model(&[Inertia, Viscous, Coulomb, Offset]);
        let none = More::default();
        assert!(is_told(&usual, none));
        assert!(is_told(&usual.with(found(Stribeck, 0.02)), none));
        assert!(!is_told(&usual.with(found(FrictionDrift, 2.0)), none));
        assert!(!is_told(&model(&[Inertia, Coulomb, Offset]), none));
        let either_way = model(&[Inertia, Viscous, Coulomb, Offset, ViscousAsymmetry]);
        let by_direction = More {
            by_direction: true,
            ..none
        };
        assert!(!is_told(&either_way, none) && is_told(&either_way, by_direction));
    }

    #[test]
    fn a_deflection_is_that_of_the_coulomb_level_where_the_level_is_higher_at_rest() {
        // 24 N while it slides, 32 N at rest.
        let share = share_of_rest(24.0, 8.0).unwrap();
        let deflection = scaled(&about(4.0, 2.0, "m".into()), share);
        assert_eq!(deflection, about(3.0, 1.5, "m".into()));
        // A level that rises from rest is none of a bristle's, nor is none at all.
        assert_eq!(
            (share_of_rest(20.0, -5.0), share_of_rest(0.0, 5.0)),
            (None, None)
        );
    }

    #[test]
    fn a_deflection_is_no_nearer_known_than_two_laws_agree() {
        let by_dahl = || about(4.0, 0.5, "m".into());
        for (slips_at, half_width) in [(None, 0.5), (Some(3.8), 0.5), (Some(1.0), 3.0)] {
            let told = as_near_as_laws_agree(by_dahl(), slips_at);
            assert_eq!(told, about(4.0, half_width, "m".into()));
        }
    }

    #[test]
    fn without_an_interval_both_ends_are_the_value() {
        let (_, gap) = entries(vec![named("gap", 2.0e-5, None)]).remove(0);
        assert_eq!((gap.low, gap.high), (2.0e-5, 2.0e-5));
    }

    #[test]
    fn an_effect_gives_the_parameters_that_are_known_by_the_names_of_the_vocabulary() {
        let effect = Effect::from(Backlash {
            gap: plain(2.0e-5, "m"),
            load_share: None,
            motor_friction: None,
            restitution: Some(plain(0.4, "of the velocity")),
        });
        let names: Vec<String> = of_an_effect(&effect).into_iter().map(|e| e.0).collect();
        assert_eq!(names, ["backlash_gap", "backlash_restitution"]);
    }

    #[test]
    fn a_second_and_a_third_ripple_get_numbers() {
        let name = "torque_ripple_amplitude";
        let ripple = [3.0, 2.0, 1.0].map(|value| named(name, value, None));
        let table = table([("an output", entries(ripple.to_vec()))]);
        assert!(table.from.values().all(|from| *from == "an output"));
        let values: Vec<(&str, f64)> = table
            .estimates
            .iter()
            .map(|(k, p)| (k.as_str(), p.value))
            .collect();
        let wanted = [
            ("torque_ripple_amplitude", 3.0),
            ("torque_ripple_amplitude_2", 2.0),
            ("torque_ripple_amplitude_3", 1.0),
        ];
        assert_eq!(values, wanted);
    }
}
