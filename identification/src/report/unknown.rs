//! Parameters that a record does not know, and what to record for them.
//!
//! A size is not known where half of its interval is half of its value or more, and where it comes
//! out below zero. An offset, a difference of the directions or a slope may be zero: an interval
//! about zero is what there is to know of them. So may what was fitted besides the vocabulary.

use std::collections::BTreeMap;

use axis_model::{EffectName, Estimate, Parameter};

use crate::report::effects::key;
use crate::report::forms::{ParameterTable, UnknownParameter};

/// Half width of an interval from which on a size is not known, as a share of its value.
const TOO_WIDE: f64 = 0.5;

/// Waves, each with its amplitude.
const WAVES: [(&str, &str); 3] = [
    ("torque_ripple", "torque_ripple_amplitude"),
    ("torque_constant_ripple", "torque_constant_ripple"),
    ("pitch_error", "pitch_error_amplitude"),
];

/// What is told of a wave beside its amplitude.
const BESIDE_AMPLITUDE: [&str; 3] = ["order", "period", "phase"];

/// The estimates, those that are not known apart.
pub(crate) fn table(estimates: BTreeMap<String, Estimate>) -> ParameterTable {
    let mut table = ParameterTable::default();
    for (name, estimate) in estimates {
        match size(&name).filter(|_| is_unknown(&estimate)) {
            Some(size) => {
                table.unknown.insert(name, unknown(estimate, size.effect));
            }
            None => {
                table.known.insert(name, estimate);
            }
        }
    }
    // By how much a lag grows is nothing without the lag.
    if !table.known.contains_key("stribeck_lag") {
        table.known.remove("stribeck_lag_growth");
    }
    let waves: Vec<String> = table
        .unknown
        .keys()
        .flat_map(|n| of_no_known_wave(n))
        .collect();
    for own in waves {
        table.known.remove(&own);
        table.unknown.remove(&own);
    }
    table
}

/// What stands beside a wave whose amplitude has this name, and is nothing where that is unknown:
/// another wave may stand there.
fn of_no_known_wave(name: &str) -> impl Iterator<Item = String> {
    let number = WAVES
        .into_iter()
        .find_map(|(wave, amplitude)| Some((wave, name.strip_prefix(amplitude)?)));
    let number = number.filter(|(_, number)| is_number(number));
    let of_wave = |(wave, number)| BESIDE_AMPLITUDE.map(|own| format!("{wave}_{own}{number}"));
    number.into_iter().flat_map(of_wave)
}

fn is_unknown(estimate: &Estimate) -> bool {
    estimate.value < 0.0 || estimate.half_width() > TOO_WIDE * estimate.value
}

/// Below zero no size can be.
fn unknown(estimate: Estimate, effect: EffectName) -> UnknownParameter {
    UnknownParameter {
        unknown: true,
        low: estimate.low.max(0.0),
        high: estimate.high.max(0.0),
        unit: estimate.unit,
        record: what_to_record(effect),
    }
}

/// The row of the vocabulary that a name of a report means, where that is a size.
fn size(name: &str) -> Option<Parameter> {
    let rows = EffectName::ALL
        .iter()
        .flat_map(|effect| effect.parameters());
    let mut sizes = rows.copied().filter(|row| row.min >= 0.0);
    sizes.find(|row| is_called(&key(row), name))
}

/// Whether a name is this one, or this one with the number of its ripple.
fn is_called(own: &str, name: &str) -> bool {
    let rest = name.strip_prefix(own);
    let rest = rest.map(|rest| rest.strip_prefix("_order").unwrap_or(rest));
    rest.is_some_and(is_number)
}

/// Whether the end of a name is the number of its ripple, or nothing.
fn is_number(end: &str) -> bool {
    let number = end.strip_prefix('_').unwrap_or(end);
    number.chars().all(|digit| digit.is_ascii_digit())
}

const fn what_to_record(effect: EffectName) -> &'static str {
    match effect {
        EffectName::Inertia | EffectName::PositionDependentInertia => {
            "reversals with more acceleration, for the mass of the load with a load scale"
        }
        EffectName::Viscous | EffectName::ViscousAsymmetry | EffectName::QuadraticDrag => {
            "long moves at several velocities up to the fastest"
        }
        EffectName::Coulomb | EffectName::Offset | EffectName::CoulombAsymmetry => {
            "slow moves in both directions, seconds each"
        }
        EffectName::Stribeck => {
            "slow moves in both directions, from a tenth of the fall's velocity to ten times it"
        }
        EffectName::Presliding => {
            "slow reversals, so that many rows lie within the deflection, and reversals within it"
        }
        EffectName::Backlash => "many slow reversals, with motor and load position",
        EffectName::Compliance => {
            "reversals with more acceleration, or a finer load scale: the load must lag by several of its counts"
        }
        EffectName::TorqueRipple | EffectName::TorqueConstantRipple | EffectName::PitchError => {
            "slow moves over several of its periods, in both directions"
        }
        EffectName::PositionDependentFriction => "moves over the whole travel",
        EffectName::FrictionDrift => {
            "a record from cold that lasts several times as long as the drift"
        }
        EffectName::LoadDependentFriction | EffectName::TorqueSaturation => {
            "more acceleration, so that the effort grows larger"
        }
        EffectName::Payload => "accelerations before and after the load changes",
        EffectName::Delay | EffectName::LoggedLate => {
            "fast changes of the effort, with more rows per second"
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(name: &str, value: f64, half_width: f64) -> ParameterTable {
        let estimate = Estimate::about(value, half_width, "N");
        table(BTreeMap::from([(name.to_owned(), estimate)]))
    }

    #[test]
    fn a_size_is_known_up_to_half_of_its_value() {
        assert!(told("viscous", 10.0, 4.9).get("viscous").is_some());
        let wide = told("viscous", 10.0, 12.0);
        assert_eq!(wide.get("viscous"), None);
        let unknown = &wide.unknown["viscous"];
        assert_eq!((unknown.low, unknown.high), (0.0, 22.0));
        assert!(unknown.record.contains("velocities"));
    }

    #[test]
    fn no_size_is_below_zero() {
        let below = told("coulomb", -488.0, 3.0);
        let unknown = &below.unknown["coulomb"];
        assert_eq!((unknown.low, unknown.high), (0.0, 0.0));
    }

    #[test]
    fn what_may_be_zero_is_known_to_be_near_it() {
        for name in ["offset", "viscous_asymmetry", "torque_ripple_phase"] {
            assert!(told(name, 0.1, 2.0).get(name).is_some(), "{name}");
        }
        assert!(
            told("stribeck_excess_by_direction", 0.1, 2.0)
                .unknown
                .is_empty()
        );
    }

    #[test]
    fn a_value_without_an_interval_is_told_as_it_was() {
        assert!(told("torque_ripple_order", 5.0, 0.0).unknown.is_empty());
    }

    #[test]
    fn a_wave_of_unknown_amplitude_has_no_order() {
        let estimate = |name: &str, value: f64, half_width: f64| {
            let own = Estimate::about(value, half_width, "N");
            (name.to_owned(), own)
        };
        let waves = [
            estimate("torque_ripple_amplitude", 3.0, 0.1),
            estimate("torque_ripple_order", 12.0, 0.1),
            estimate("torque_ripple_amplitude_2", 3.0, 2.0),
            estimate("torque_ripple_order_2", 24.0, 0.1),
            estimate("torque_ripple_phase_2", 1.0, 0.1),
            estimate("torque_constant_ripple", 0.1, 0.2),
            estimate("torque_constant_ripple_period", 0.1, 0.2),
            estimate("pitch_error_amplitude", 1.0e-6, 0.1e-6),
            estimate("pitch_error_period", 0.01, 1.0e-5),
        ];
        let table = table(BTreeMap::from(waves));
        let known: Vec<&str> = table.known.keys().map(String::as_str).collect();
        assert_eq!(
            known,
            [
                "pitch_error_amplitude",
                "pitch_error_period",
                "torque_ripple_amplitude",
                "torque_ripple_order"
            ]
        );
        let unknown: Vec<&str> = table.unknown.keys().map(String::as_str).collect();
        assert_eq!(
            unknown,
            ["torque_constant_ripple", "torque_ripple_amplitude_2"]
        );
    }

    #[test]
    fn a_second_ripple_and_one_by_its_order_are_ripples() {
        let names = [
            "torque_ripple_amplitude_2",
            "torque_ripple_amplitude_order_12",
            "load_inertia",
            "presliding_deflection",
        ];
        for name in names {
            assert!(told(name, 1.0, 0.8).unknown.contains_key(name), "{name}");
        }
    }
}
