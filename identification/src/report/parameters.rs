//! The parameters of the extended model, with intervals, by name.
//!
//! Each comes from the output that shows it best: columns, delay and saturation from the effort,
//! deflection and gap from the free run where that decided, gap, stiffness and pitch error from
//! motor − load where there is a load scale.

use std::collections::BTreeMap;

use crate::evidence::difference::Difference;
use crate::evidence::findings::Findings;
use crate::evidence::slow_ripple::OrderAtReversals;
use crate::fit::bench::Bench;
use crate::model::effects::{Named, Naming};
use crate::report::forms::Parameter;

/// The table of an identification.
pub(crate) fn parameters(findings: &Findings<'_>) -> BTreeMap<String, Parameter> {
    let stages = &findings.stages;
    let mut named = of_the_inverse_model(findings);
    named.extend(of_the_shape(findings));
    let difference = stages.difference.iter();
    named.extend(difference.flat_map(|difference| of_the_difference(findings, difference)));
    let orders = stages.ripple.iter().flat_map(|ripple| &ripple.orders);
    named.extend(orders.map(|order| of_an_order(findings, order)));
    table(named)
}

/// Named parameters as a table; a name that comes again gets a number.
pub(crate) fn table(named: Vec<Named>) -> BTreeMap<String, Parameter> {
    let mut table = BTreeMap::new();
    for one in named {
        let key = free_key(&table, &one.name);
        let half = one.half_width.unwrap_or(0.0);
        let parameter = Parameter {
            value: one.value,
            unit: one.unit,
            low: one.value - half,
            high: one.value + half,
        };
        table.insert(key, parameter);
    }
    table
}

fn free_key(table: &BTreeMap<String, Parameter>, name: &str) -> String {
    let keys = (1..).map(|times| match times {
        1 => name.to_owned(),
        times => format!("{name}_{times}"),
    });
    let mut free = keys.skip_while(|key| table.contains_key(key));
    free.next().unwrap_or_default()
}

/// A quantity without an interval.
fn plain(name: &str, value: f64, unit: &str) -> Named {
    Named {
        name: name.into(),
        value,
        half_width: None,
        unit: unit.into(),
    }
}

fn of_the_inverse_model(findings: &Findings<'_>) -> Vec<Named> {
    let extended = &findings.models.extended;
    let seen = extended.motion(findings.motion);
    let bench = Bench::new(findings.dataset, &seen);
    let estimates = bench.estimates(&extended.fitted);
    let parameters = estimates.iter().flat_map(|estimate| {
        estimate.part.effect.parameters(&Naming {
            parameter: estimate.part.parameter,
            parameter_half_width: estimate.parameter_half_width,
            coefficients: &estimate.own,
            dataset: findings.dataset,
        })
    });
    parameters.collect()
}

/// Deflection and gap: from the free run with their intervals where that decided, else the
/// deflection that the effort about reversals gave.
fn of_the_shape(findings: &Findings<'_>) -> Vec<Named> {
    let length = findings.dataset.kind.position_unit();
    let Some(reversals) = findings.stages.reversals.accepted_shape() else {
        let deflection = findings.models.extended.deflection;
        let named = deflection.map(|value| plain("presliding_deflection", value, length));
        return named.into_iter().collect();
    };
    let is_shape =
        |named: &Named| named.name.starts_with("presliding") || named.name.starts_with("backlash");
    let all = reversals.named(findings.dataset).into_iter();
    all.filter(is_shape).collect()
}

fn of_the_difference(findings: &Findings<'_>, difference: &Difference) -> Vec<Named> {
    let length = findings.dataset.kind.position_unit();
    let stiffness_unit = format!("{}/{length}", findings.dataset.effort.unit());
    let gap = difference.gap.map(|gap| plain("backlash_gap", gap, length));
    let stiffness = difference
        .stiffness
        .map(|k| plain("compliance_stiffness", k, &stiffness_unit));
    let pitch = difference.pitch().map(|(amplitude, per_length)| {
        [
            plain("pitch_error_amplitude", amplitude, length),
            plain("pitch_error_period", 1.0 / per_length, length),
        ]
    });
    let pitch = pitch.into_iter().flatten();
    gap.into_iter().chain(stiffness).chain(pitch).collect()
}

fn of_an_order(findings: &Findings<'_>, order: &OrderAtReversals) -> Named {
    Named {
        name: format!("torque_ripple_amplitude_order_{}", order.per_rev),
        value: order.amplitude,
        half_width: Some(order.half_width),
        unit: findings.dataset.effort.unit().to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_stands_about_its_value() {
        let table = table(vec![Named {
            half_width: Some(0.5),
            ..plain("coulomb", 10.0, "N")
        }]);
        let wanted = Parameter {
            value: 10.0,
            unit: "N".into(),
            low: 9.5,
            high: 10.5,
        };
        assert_eq!(table["coulomb"], wanted);
    }

    #[test]
    fn without_an_interval_both_ends_are_the_value() {
        let table = table(vec![plain("backlash_gap", 2.0e-5, "m")]);
        let gap = &table["backlash_gap"];
        assert_eq!((gap.low, gap.high), (2.0e-5, 2.0e-5));
    }

    #[test]
    fn a_second_and_a_third_ripple_get_numbers() {
        let ripple = |value| plain("torque_ripple_amplitude", value, "N");
        let table = table(vec![ripple(3.0), ripple(2.0), ripple(1.0)]);
        let values: Vec<(&str, f64)> = table.iter().map(|(k, p)| (k.as_str(), p.value)).collect();
        let wanted = [
            ("torque_ripple_amplitude", 3.0),
            ("torque_ripple_amplitude_2", 2.0),
            ("torque_ripple_amplitude_3", 1.0),
        ];
        assert_eq!(values, wanted);
    }
}
