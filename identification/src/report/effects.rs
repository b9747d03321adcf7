//! What was identified, in the words of the vocabulary: for whoever computes with it.
//!
//! The table of parameters names each one as the vocabulary does, `stribeck_velocity`, so that an
//! effect is put together from it by name alone. Where the vocabulary counts in shares of the
//! friction and the fit in efforts, the shares are made here:
//!
//! ```text
//! Fc + a u + b u²,  u = (x − m) / h     =  F0 (1 + k x + q x²),   F0 where x is zero
//! Fc + c exp(−t / τ)                    =  Fc (1 + g exp(−t / τ))
//! ```
//!
//! Friction over position that was found as a smooth curve is put as its nearest parabola: the
//! vocabulary has no curve.
//!
//! A share is as uncertain as both of its efforts, and what is moved to position zero as all that
//! moves it; they are taken to err apart from each other.

use std::collections::BTreeMap;

use axis_model::{Effect, EffectName, Estimate, Parameter, TorqueRipple};

use crate::evidence::thresholds::MOST_EFFECTS;
use crate::model::effects::curve;
use crate::model::effects::position_dependent_friction::knot_name;
use crate::report::forms::{ParameterTable, Report, UnknownParameter};
use crate::report::parameters::{COULOMB_ASYMMETRY, DEFLECTION};

/// Parameters by the name that a report gives them.
type Table = BTreeMap<String, Estimate>;

/// Where an axis moved in the training record.
#[derive(Clone, Copy)]
pub(crate) struct Travel {
    /// Middle and half of the travel.
    pub middle_and_half: (f64, f64),
    /// Unit of the position.
    pub unit: &'static str,
}

/// The effects of a report.
pub(crate) fn effects(report: &Report, travel: Travel) -> Vec<Effect<Estimate>> {
    let table = in_shares(&used(report), travel);
    let mut effects = Vec::new();
    for name in EffectName::ALL {
        let each = (1..=MOST_TIMES).filter_map(|times| assemble(*name, times, &table));
        effects.extend(each);
    }
    effects.extend(at_reversals(report));
    effects
}

/// What gives way: where a record knows of it only that it is in some interval above zero, the
/// middle of that is nearer than a screw that is rigid, and is used with that interval. That of a
/// deflection is used from zero on as well: it is nearer than a friction that gives way at once,
/// which a record with a bristle has not.
const USED_AS_AN_INTERVAL: [&str; 4] = [
    "compliance_stiffness",
    "compliance_damping",
    LOAD_INERTIA,
    DEFLECTION,
];

/// The parameters that are known, and those that are used though they are not.
fn used(report: &Report) -> Table {
    let mut table = report.parameters.known.clone();
    for (key, own) in amid_interval(&report.parameters) {
        let (middle, half) = (0.5 * (own.low + own.high), 0.5 * (own.high - own.low));
        table.insert(key.into(), Estimate::about(middle, half, &own.unit));
    }
    table
}

/// Parameters that are unknown and stand amid their intervals in the effects.
fn amid_interval(
    parameters: &ParameterTable,
) -> impl Iterator<Item = (&'static str, &UnknownParameter)> {
    USED_AS_AN_INTERVAL.into_iter().filter_map(|key| {
        let unknown = parameters.unknown.get(key)?;
        (unknown.low > 0.0 || key == DEFLECTION).then_some((key, unknown))
    })
}

impl ParameterTable {
    /// Whether a parameter is unknown, and stands amid its interval in the effects all the same.
    #[must_use]
    pub fn is_used_amid_interval(&self, key: &str) -> bool {
        amid_interval(self).any(|(own, _)| own == key)
    }
}

/// The most that one effect is found. One of them may have a size that nobody knows.
const MOST_TIMES: usize = MOST_EFFECTS;

/// An effect that was found for the first time, the second, …; `None` where it was not.
fn assemble(name: EffectName, times: usize, table: &Table) -> Option<Effect<Estimate>> {
    Effect::assemble(name, |parameter| {
        let key = key(parameter);
        let key = if times == 1 {
            key
        } else {
            format!("{key}_{times}")
        };
        table.get(&key).cloned()
    })
}

/// The mass of the load is a structure of its own in the inverse model.
const LOAD_INERTIA: &str = "load_inertia";

/// The name that a report gives a parameter.
pub(crate) fn key(parameter: &Parameter) -> String {
    if parameter.effect == EffectName::Inertia && parameter.optional {
        LOAD_INERTIA.into()
    } else {
        parameter.report_name()
    }
}

/// The table with shares of the friction in place of efforts. Without a friction above zero there
/// is nothing to take a share of.
fn in_shares(parameters: &Table, travel: Travel) -> Table {
    let mut table = parameters.clone();
    parabola_of_a_curve(&mut table);
    let parameters = table.clone();
    let above_zero = |key: &str| parameters.get(key).filter(|own| own.value > 0.0);
    let viscous = above_zero("viscous");
    share(
        &mut table,
        "viscous_asymmetry",
        "viscous_asymmetry",
        viscous,
    );
    let coulomb = above_zero("coulomb");
    share(
        &mut table,
        "friction_drift_coulomb",
        "friction_drift_gain",
        coulomb,
    );
    share(
        &mut table,
        "friction_drift_viscous",
        "friction_drift_viscous_gain",
        viscous,
    );
    by_direction(&mut table, coulomb);
    over_position(&mut table, coulomb, travel);
    table
}

/// What differs by direction and is friction alone.
const BY_DIRECTION: [&str; 2] = [
    "stribeck_excess_by_direction",
    "friction_drift_by_direction",
];

/// A fall or a drift that differs by direction says of an offset that it is an asymmetry of the
/// friction. Where the load's motion tells how large that is, the rest is a constant force.
fn by_direction(table: &mut Table, coulomb: Option<&Estimate>) {
    let differs = BY_DIRECTION.map(|key| table.remove(key).is_some());
    let told = table.get(COULOMB_ASYMMETRY).cloned();
    if let (Some(told), Some(coulomb)) = (told, coulomb) {
        // Whether friction of the motor's own side differs by direction as well, nobody says.
        let on_motor = table.get("motor_coulomb").map_or(0.0, |own| own.value);
        if let Some(offset) = table.get_mut("offset") {
            let rest = offset.plus(-1.0, &told.times(coulomb, &offset.unit));
            let half_width = rest.half_width().hypot(told.value * on_motor);
            *offset = Estimate::about(rest.value, half_width, &rest.unit);
        }
    } else if differs.contains(&true) {
        share(table, "offset", COULOMB_ASYMMETRY, coulomb);
    }
}

/// Replaces an effort by its share of another.
fn share(table: &mut Table, effort: &str, share: &str, of: Option<&Estimate>) {
    let own = table.remove(effort);
    if let (Some(own), Some(of)) = (own, of) {
        table.insert(share.into(), own.over(of, ""));
    }
}

const LINEAR: &str = "position_dependent_friction_linear";
const QUADRATIC: &str = "position_dependent_friction_quadratic";

/// From a polynomial about the middle of the travel to one about position zero, in shares of the
/// level there.
fn over_position(table: &mut Table, coulomb: Option<&Estimate>, travel: Travel) {
    let (middle, half) = travel.middle_and_half;
    let (Some(a), b) = (table.remove(LINEAR), table.remove(QUADRATIC)) else {
        return;
    };
    let at_zero = -middle / half;
    let with_curve = |of: Estimate, times: f64| match &b {
        Some(b) => of.plus(times, b),
        None => of,
    };
    let level = coulomb.map(|coulomb| with_curve(coulomb.plus(at_zero, &a), at_zero * at_zero));
    let Some(level) = level.filter(|level| level.value > 0.0) else {
        return;
    };
    let unit = |power: &str| format!("1/{}{power}", travel.unit);
    let slope = with_curve(a, 2.0 * at_zero).scaled(1.0 / half, "");
    table.insert(LINEAR.into(), slope.over(&level, &unit("")));
    if let Some(b) = b {
        let b = b.scaled(1.0 / (half * half), "");
        table.insert(QUADRATIC.into(), b.over(&level, &unit("2")));
    }
    table.insert("coulomb".into(), level);
}

/// Replaces the knots of a curve by the parabola that is nearest to them, without its constant:
/// that is a part of the friction's level.
fn parabola_of_a_curve(table: &mut Table) {
    let key = |place: usize| knot_name(place + 1);
    let known: Vec<Estimate> = (0..).map_while(|place| table.remove(&key(place))).collect();
    let Some(first) = known.first().cloned() else {
        return;
    };
    let values = known.iter().map(|own| own.value);
    let mut points: Vec<(f64, f64)> = (0..known.len())
        .map(|place| curve::knot(place, known.len()))
        .zip(values)
        .collect();
    points.push((0.0, 0.0));
    let mean = |of: &dyn Fn(f64, f64) -> f64| {
        let sum: f64 = points.iter().map(|(u, y)| of(*u, *y)).sum();
        sum / points.len() as f64
    };
    // 1, u and u² − ⟨u²⟩ are orthogonal over knots that lie evenly about zero.
    let square = mean(&|u, _| u * u);
    let bend = |u: f64| u * u - square;
    let slope = mean(&|u, y| u * y) / square;
    let curvature = mean(&|u, y| bend(u) * y) / mean(&|u, _| bend(u).powi(2));
    let level = mean(&|_, y| y) - curvature * square;
    if let Some(coulomb) = table.get_mut("coulomb") {
        *coulomb = Estimate::about(coulomb.value + level, coulomb.half_width(), &coulomb.unit);
    }
    for (name, value) in [(LINEAR, slope), (QUADRATIC, curvature)] {
        let nearest = Estimate::about(value, first.half_width(), &first.unit);
        table.insert(name.into(), nearest);
    }
}

/// Ripple that was seen about reversals alone: amplitudes by order, without a phase.
fn at_reversals(report: &Report) -> Vec<Effect<Estimate>> {
    let exact = |value: f64| Estimate {
        value,
        unit: "per rev".into(),
        low: value,
        high: value,
    };
    let orders = report.slow_ripple.iter().flat_map(|ripple| &ripple.orders);
    let ripple = orders.filter_map(|order| {
        let name = format!(
            "{}_amplitude_order_{}",
            EffectName::TorqueRipple,
            order.per_rev
        );
        Some(Effect::TorqueRipple(TorqueRipple {
            amplitude: report.parameters.get(&name)?.clone(),
            order: Some(exact(f64::from(order.per_rev))),
            period: None,
            phase: None,
        }))
    });
    ripple.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::forms::{ParameterTable, RippleOrder, SlowRipple, UnknownParameter};

    const fn travel(middle: f64, half: f64) -> Travel {
        Travel {
            middle_and_half: (middle, half),
            unit: "m",
        }
    }

    fn about(value: f64, half_width: f64, unit: &str) -> Estimate {
        Estimate {
            value,
            unit: unit.into(),
            low: value - half_width,
            high: value + half_width,
        }
    }

    fn report(parameters: &[(&str, f64)]) -> Report {
        let entry = |(name, value): &(&str, f64)| ((*name).to_owned(), about(*value, 1.0, "N"));
        Report {
            parameters: ParameterTable {
                known: parameters.iter().map(entry).collect(),
                ..ParameterTable::default()
            },
            ..Report::default()
        }
    }

    fn parts(effect: &Effect<Estimate>) -> Vec<(String, f64)> {
        let parts = effect.parts().into_iter();
        parts
            .map(|(row, own)| (row.report_name(), own.value))
            .collect()
    }

    /// The one effect of a name.
    fn only(effects: &[Effect<Estimate>], name: EffectName) -> Vec<(String, f64)> {
        let mut own = effects.iter().filter(|effect| effect.name() == name);
        let parts = parts(own.next().expect("it is there"));
        assert!(own.next().is_none(), "{name} twice");
        parts
    }

    fn assert_near(parts: &[(String, f64)], wanted: &[(&str, f64)]) {
        assert_eq!(parts.len(), wanted.len(), "{parts:?}");
        for ((key, value), (wanted_key, wanted)) in parts.iter().zip(wanted) {
            assert_eq!(key, wanted_key);
            assert!(
                (value - wanted).abs() < 1.0e-9 * wanted.abs(),
                "{key} = {value}"
            );
        }
    }

    #[test]
    fn a_screw_or_bristle_of_which_only_an_interval_is_known_is_used_amid_it() {
        let mut report = report(&[("coulomb", 100.0)]);
        let unknown = |low: f64, unit: &str| UnknownParameter {
            unknown: true,
            unit: unit.into(),
            low,
            high: 9.0e7,
            record: "",
        };
        let key = "compliance_stiffness";
        let found = |report: &Report| effects(report, travel(0.0, 0.1)).len();
        for (low, count) in [(-1.0, 1), (5.0e7, 2)] {
            let own = unknown(low, "N/m");
            report.parameters.unknown.insert(key.into(), own);
            assert_eq!(found(&report), count);
        }
        let screw = only(&effects(&report, travel(0.0, 0.1)), EffectName::Compliance);
        assert_near(&screw, &[(key, 7.0e7)]);
        let other = unknown(1.0, "N");
        report.parameters.unknown.insert("offset".into(), other);
        assert_eq!(found(&report), 2);
        let bristle = unknown(0.0, "m");
        report.parameters.unknown.insert(DEFLECTION.into(), bristle);
        assert_eq!(found(&report), 3);
        assert!(report.parameters.is_used_amid_interval(DEFLECTION));
    }

    #[test]
    fn what_the_load_tells_of_an_offset_is_an_asymmetry_and_the_rest_a_force() {
        let parameters = [
            ("coulomb", 100.0),
            ("offset", -20.0),
            (COULOMB_ASYMMETRY, 0.15),
        ];
        for more in [&[][..], &[(BY_DIRECTION[1], 3.0)]] {
            let parameters = [&parameters[..], more].concat();
            let found = effects(&report(&parameters), travel(0.0, 0.1));
            assert_near(&only(&found, EffectName::Offset), &[("offset", -35.0)]);
            let asymmetry = only(&found, EffectName::CoulombAsymmetry);
            assert_near(&asymmetry, &[(COULOMB_ASYMMETRY, 0.15)]);
        }
    }

    #[test]
    fn an_offset_beside_a_fall_by_direction_is_an_asymmetry_of_the_friction() {
        let coulomb_and_fall = [
            ("coulomb", 100.0),
            ("offset", -20.0),
            ("stribeck_excess", 50.0),
            ("stribeck_velocity", 0.01),
            ("stribeck_exponent", 1.5),
        ];
        let found = effects(&report(&coulomb_and_fall), travel(0.0, 0.1));
        assert_near(&only(&found, EffectName::Offset), &[("offset", -20.0)]);
        let by_direction = BY_DIRECTION
            .map(|key| [&coulomb_and_fall[..], &[(key, -10.0)]].concat())
            .map(|parameters| effects(&report(&parameters), travel(0.0, 0.1)));
        let [found, by_drift] = by_direction;
        assert_eq!(found, by_drift);
        let asymmetry = only(&found, EffectName::CoulombAsymmetry);
        assert_near(&asymmetry, &[("coulomb_asymmetry", -0.2)]);
        assert!(
            found
                .iter()
                .all(|effect| effect.name() != EffectName::Offset)
        );
        let fall = [
            ("stribeck_excess", 50.0),
            ("stribeck_velocity", 0.01),
            ("stribeck_exponent", 1.5),
        ];
        assert_near(&only(&found, EffectName::Stribeck), &fall);
    }

    #[test]
    fn a_curve_over_position_becomes_its_nearest_parabola() {
        // 300 N in the middle of the travel, and a parabola with 20 u − 30 u² at the knots.
        let at = |place: usize| {
            let u = curve::knot(place, 8);
            20.0 * u - 30.0 * u * u
        };
        let names: Vec<String> = (1..=8).map(knot_name).collect();
        let mut parameters: Vec<(&str, f64)> = vec![("coulomb", 300.0)];
        let knots = names.iter().enumerate();
        parameters.extend(knots.map(|(place, name)| (name.as_str(), at(place))));
        let found = effects(&report(&parameters), travel(0.0, 0.1));
        let wanted = [
            ("position_dependent_friction_linear", 20.0 / 0.1 / 300.0),
            (
                "position_dependent_friction_quadratic",
                -30.0 / 0.01 / 300.0,
            ),
        ];
        assert_near(
            &only(&found, EffectName::PositionDependentFriction),
            &wanted,
        );
        assert_near(&only(&found, EffectName::Coulomb), &[("coulomb", 300.0)]);
    }

    #[test]
    fn an_effect_is_there_where_all_that_it_needs_is() {
        let found = effects(
            &report(&[
                ("inertia", 700.0),
                ("load_inertia", 300.0),
                ("coulomb", 250.0),
                ("stribeck_excess", 80.0),
                ("backlash_gap", 2.0e-5),
                ("backlash_restitution", 0.4),
            ]),
            travel(0.0, 0.1),
        );
        let names: Vec<&str> = found.iter().map(|effect| effect.name().as_str()).collect();
        assert_eq!(
            names,
            ["inertia", "coulomb", "backlash"],
            "no fall without a velocity"
        );
        assert_near(
            &only(&found, EffectName::Inertia),
            &[("inertia", 700.0), ("inertia_load", 300.0)],
        );
        assert_near(
            &only(&found, EffectName::Backlash),
            &[("backlash_gap", 2.0e-5), ("backlash_restitution", 0.4)],
        );
    }

    #[test]
    fn an_effort_becomes_a_share_of_its_friction_with_its_interval() {
        let report = report(&[
            ("coulomb", 200.0),
            ("viscous", 1000.0),
            ("viscous_asymmetry", -150.0),
            ("friction_drift_coulomb", 80.0),
            ("friction_drift_viscous", 250.0),
            ("friction_drift_time_constant", 20.0),
        ]);
        let found = effects(&report, travel(0.0, 0.1));
        assert_near(
            &only(&found, EffectName::ViscousAsymmetry),
            &[("viscous_asymmetry", -0.15)],
        );
        assert_near(
            &only(&found, EffectName::FrictionDrift),
            &[
                ("friction_drift_gain", 0.4),
                ("friction_drift_time_constant", 20.0),
                ("friction_drift_viscous_gain", 0.25),
            ],
        );
        let Some(Effect::FrictionDrift(drift)) = found
            .iter()
            .find(|effect| effect.name() == EffectName::FrictionDrift)
        else {
            panic!("a drift");
        };
        // 80 ± 1 of 200 ± 1 N.
        let half_width = 0.4 * f64::hypot(1.0 / 80.0, 1.0 / 200.0);
        assert!((drift.gain.half_width() - half_width).abs() < 1.0e-12);
        assert!(drift.gain.unit.is_empty());
    }

    #[test]
    fn friction_over_position_is_the_same_function_about_zero() {
        let (middle, half) = (0.05, 0.2);
        let report = report(&[("coulomb", 200.0), (LINEAR, 40.0), (QUADRATIC, -12.0)]);
        let found = effects(&report, travel(middle, half));
        let coulomb = only(&found, EffectName::Coulomb)[0].1;
        let parts = only(&found, EffectName::PositionDependentFriction);
        let [(_, k), (_, q)] = parts.as_slice() else {
            panic!("{parts:?}");
        };
        let fitted = |x: f64| {
            let u = (x - middle) / half;
            200.0 + 40.0 * u - 12.0 * u * u
        };
        for x in [-0.15, -0.03, 0.02, 0.25] {
            let share = 1.0 + k * x + q * x * x;
            assert!((fitted(x) - coulomb * share).abs() < 1.0e-9, "{x}");
        }
    }

    #[test]
    fn without_friction_there_is_no_share_of_it() {
        let report = report(&[
            (LINEAR, 40.0),
            ("viscous", -3.0),
            ("viscous_asymmetry", 1.0),
        ]);
        let found = effects(&report, travel(0.0, 0.2));
        let names: Vec<EffectName> = found.iter().map(Effect::name).collect();
        assert_eq!(names, [EffectName::Viscous]);
    }

    #[test]
    fn a_wave_of_a_size_that_nobody_knows_hides_none_after_it() {
        let report = report(&[
            ("pitch_error_period", 3.0e-3),
            ("pitch_error_amplitude_2", 2.0e-6),
            ("pitch_error_period_2", 1.0e-2),
        ]);
        let found = effects(&report, travel(0.0, 0.1));
        let parts = only(&found, EffectName::PitchError);
        assert_eq!(parts[0].1, 2.0e-6);
    }

    #[test]
    fn every_order_of_ripple_is_an_effect() {
        let mut report = report(&[
            ("torque_ripple_amplitude", 30.0),
            ("torque_ripple_period", 2.0e-3),
            ("torque_ripple_phase", 0.3),
            ("torque_ripple_amplitude_2", 8.0),
            ("torque_ripple_period_2", 1.0e-3),
            ("torque_ripple_phase_2", -0.3),
            ("torque_ripple_amplitude_order_7", 4.0),
        ]);
        let order = RippleOrder {
            per_rev: 7,
            ..RippleOrder::default()
        };
        report.slow_ripple = Some(SlowRipple {
            orders: vec![order],
            ..SlowRipple::default()
        });
        let found = effects(&report, travel(0.0, 0.1));
        let amplitudes: Vec<f64> = found.iter().map(|effect| parts(effect)[0].1).collect();
        assert_eq!(amplitudes, [30.0, 8.0, 4.0]);
        let order = ("torque_ripple_order".to_owned(), 7.0);
        assert_eq!(parts(&found[2])[1], order);
    }
}
