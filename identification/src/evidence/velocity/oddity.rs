//! What a velocity is that is not the derivative of the position, in words.

use std::f64::consts::{PI, TAU};

use crate::evidence::thresholds::{
    STANDSTILL_SLOPE, VELOCITY_CORRELATION, VELOCITY_LATE_ROWS, VELOCITY_SLOPE,
};
use crate::motion::measured_velocity::Relation;
use crate::record::dataset::Dataset;
use crate::record::samples::Record;
use crate::record::units::AxisKind;

/// How near a slope is to that of a unit: a velocity may be a little off besides.
const NEAR: f64 = 0.03;
const OFF_BY_A_TURN: &str = "a unit that is off by 2 pi: turns beside radians";

/// Why a velocity cannot be used; `None` where nothing speaks against it.
pub(crate) fn oddity(dataset: &Dataset, record: &Record, relation: Relation) -> Option<String> {
    let Relation {
        slope,
        late_s,
        correlation,
    } = relation;
    let position = format!("position_{}", dataset.kind.position_unit());
    if slope.abs() < STANDSTILL_SLOPE {
        return Some("it stands still while the axis moves; was it recorded?".into());
    }
    if correlation.abs() < VELOCITY_CORRELATION {
        return Some(format!(
            "it does not go with the derivative of {position} (correlation {correlation:.2}); is it another axis' or another run's?"
        ));
    }
    if !VELOCITY_SLOPE.contains(&slope) {
        let looks = looks(dataset, slope);
        return Some(format!(
            "it is {slope:.4} times the derivative of {position}: {looks}; scale it in [columns] of dataset.toml"
        ));
    }
    let latest_s = VELOCITY_LATE_ROWS * record.period_s;
    (late_s.abs() > latest_s).then(|| {
        let when = if late_s > 0.0 { "after" } else { "before" };
        format!(
            "it comes {:.1} ms {when} {position}, and {:.1} ms is the most that is shifted; is it filtered, or from another cycle?",
            1.0e3 * late_s.abs(),
            1.0e3 * latest_s
        )
    })
}

fn looks(dataset: &Dataset, slope: f64) -> String {
    let near = |(factor, _): &(f64, &str)| (slope.abs() / factor - 1.0).abs() < NEAR;
    let unit = units(dataset).into_iter().find(near);
    let sign = slope < 0.0;
    match (unit, sign) {
        (Some((_, "")), _) => "its sign is swapped".into(),
        (Some((_, unit)), false) => format!("it is in {unit}"),
        (Some((_, unit)), true) => format!("it is in {unit}, and its sign is swapped"),
        (None, false) => "a gear ratio or the lead is missing, or it has another unit".into(),
        (None, true) => {
            "its sign is swapped, and a gear ratio or the lead is missing, or it has another unit"
                .into()
        }
    }
}

/// Units of velocity over that of the axis; without a word: its own.
fn units(dataset: &Dataset) -> Vec<(f64, &'static str)> {
    let lead = dataset.lead_m_per_rev;
    match dataset.kind {
        AxisKind::Rotary => vec![
            (1.0, ""),
            (60.0 / TAU, "rpm"),
            (1.0 / TAU, "turns/s"),
            (180.0 / PI, "degrees/s"),
            (1.0e3, "mrad/s"),
            (TAU, OFF_BY_A_TURN),
        ],
        AxisKind::Linear => {
            let of_path = [
                (1.0, ""),
                (1.0e3, "mm/s"),
                (60.0, "m/min"),
                (6.0e4, "mm/min"),
                (1.0e6, "µm/s"),
                (TAU, OFF_BY_A_TURN),
                (1.0 / TAU, OFF_BY_A_TURN),
            ];
            let of_turns = lead.map(|lead| {
                [
                    (TAU / lead, "rad/s of the motor"),
                    (1.0 / lead, "turns/s of the motor"),
                    (60.0 / lead, "rpm of the motor"),
                ]
            });
            of_path
                .into_iter()
                .chain(of_turns.into_iter().flatten())
                .collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::made;

    fn said(kind: AxisKind, [slope, late_s, correlation]: [f64; 3]) -> String {
        let mut dataset = made::dataset(made::record(1.0e-3, vec![0.0; 10]), None);
        dataset.kind = kind;
        dataset.lead_m_per_rev = Some(0.01);
        let relation = Relation {
            slope,
            late_s,
            correlation,
        };
        oddity(&dataset, &dataset.train, relation).unwrap_or_default()
    }

    #[test]
    fn a_unit_is_named_by_its_factor_and_a_sign_by_its_own() {
        for (kind, slope, looks) in [
            (AxisKind::Linear, 1.2, ""),
            (AxisKind::Linear, -1.0, "its sign is swapped;"),
            (AxisKind::Linear, 1000.0, "it is in mm/s;"),
            (
                AxisKind::Linear,
                -60.0,
                "it is in m/min, and its sign is swapped",
            ),
            (AxisKind::Linear, 628.3, "rad/s of the motor"),
            (AxisKind::Linear, 6000.0, "rpm of the motor"),
            (AxisKind::Linear, 0.5, "a gear ratio or the lead is missing"),
            (
                AxisKind::Linear,
                -7.0,
                "its sign is swapped, and a gear ratio",
            ),
            (AxisKind::Rotary, 9.549, "it is in rpm;"),
            (AxisKind::Rotary, 0.1592, "turns/s"),
            (AxisKind::Rotary, 57.3, "degrees/s"),
            (AxisKind::Rotary, TAU, "off by 2 pi"),
            (AxisKind::Linear, 1.0 / TAU, "off by 2 pi"),
        ] {
            let text = said(kind, [slope, 0.0, slope.signum()]);
            assert!(
                text.contains(looks) && text.is_empty() == looks.is_empty(),
                "{slope} {text}"
            );
        }
    }

    #[test]
    fn a_row_late_is_shifted_and_more_is_told() {
        let late = |late_s: f64| said(AxisKind::Linear, [1.0, late_s, 1.0]);
        assert_eq!(late(0.9e-3), "");
        assert!(late(1.8e-3).contains("1.8 ms after position_m, and 1.0 ms is the most"));
        assert!(late(-4.0e-3).contains("4.0 ms before position_m"));
    }

    #[test]
    fn a_stranger_and_a_column_at_rest_are_told_before_their_slope() {
        let other = said(AxisKind::Linear, [30.0, 0.0, 0.4]);
        assert!(other.contains("correlation 0.40"), "{other}");
        assert!(said(AxisKind::Linear, [0.0; 3]).contains("stands still"));
    }
}
