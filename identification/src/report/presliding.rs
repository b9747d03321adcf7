//! Friction after a reversal, as a curve over the way: from sliding one way to sliding the other.
//!
//! By Masing's rule a branch is the virgin curve, twice as large: `F(s) = C (2 z(s/2) − 1)` with
//! z = Σ shareᵢ min(s/δᵢ, 1) for Maxwell slip. Dahl's law has `F(s) = C (1 − 2 e^(−s/δ))`.

use std::collections::BTreeMap;

use axis_model::Estimate;

use crate::evidence::difference::Known;
use crate::evidence::reversal::bristle::Bristle;
use crate::model::effects::geometric;
use crate::report::forms::{AfterReversal, PreslidingCurve, SlipElement};

/// Points of the curve beside its start, from a share of the deflection on.
const POINTS: u32 = 40;
const FIRST: f64 = 0.02;
/// The last point of Dahl's curve, in deflections: a fiftieth of the level is left there.
const LAST: f64 = 4.6;

/// The curve of a bristle with the parameters that are told, beside elements of the motor's own
/// side by their ways and shares; `None` where the level is not told.
pub(crate) fn curve(
    bristle: &Bristle,
    of_motor: &[(f64, f64)],
    told: &BTreeMap<String, Estimate>,
) -> Option<PreslidingCurve> {
    let level = known(told.get("coulomb")?);
    let deflection = known(told.get("presliding_deflection")?);
    let (law, elements, last) = match bristle {
        Bristle::Dahl(_) => ("dahl", Vec::new(), LAST * deflection.value),
        Bristle::Slip(own) => {
            let elements = own.elements().iter().map(|element| SlipElement {
                deflection: element.deflection,
                share: element.share,
            });
            let last = own.elements().last()?.deflection;
            ("maxwell-slip", elements.collect(), 2.0 * last)
        }
    };
    let motor_elements = of_motor
        .iter()
        .map(|&(deflection, share)| SlipElement { deflection, share });
    let ways = geometric(FIRST * deflection.value, last, POINTS);
    let point = |way: f64| {
        let state = match bristle {
            Bristle::Dahl(_) => dahl(way, deflection),
            Bristle::Slip(own) => {
                let virgin = own.known_force(0.5 * way);
                Known::new(2.0 * virgin.value - 1.0, 2.0 * virgin.half_width)
            }
        };
        of_level(way, level, state)
    };
    Some(PreslidingCurve {
        law,
        elements,
        motor_elements: motor_elements.collect(),
        points: std::iter::once(0.0).chain(ways).map(point).collect(),
    })
}

fn known(estimate: &Estimate) -> Known {
    Known::new(estimate.value, 0.5 * (estimate.high - estimate.low))
}

/// Dahl's state after a way, with what its deflection leaves open.
fn dahl(way: f64, deflection: Known) -> Known {
    let left = 2.0 * (-way / deflection.value).exp();
    let slope = left * way / deflection.value.powi(2);
    Known::new(1.0 - left, slope * deflection.half_width)
}

fn of_level(way: f64, level: Known, state: Known) -> AfterReversal {
    let force = level.value * state.value;
    let half_width = (level.half_width * state.value).hypot(level.value * state.half_width);
    // Whatever the deflection, friction is within its level.
    let most = level.value + level.half_width;
    AfterReversal {
        way,
        force,
        low: (force - half_width).max(-most),
        high: (force + half_width).min(most),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::reversal::slip::tests::elements;

    fn told(deflection: f64, half_width: f64) -> BTreeMap<String, Estimate> {
        let of = |value: f64, half_width: f64| Estimate {
            value,
            unit: String::new(),
            low: value - half_width,
            high: value + half_width,
        };
        let level = ("coulomb".to_owned(), of(200.0, 2.0));
        let deflection = (
            "presliding_deflection".to_owned(),
            of(deflection, half_width),
        );
        BTreeMap::from([level, deflection])
    }

    #[test]
    fn dahls_curve_turns_over_within_its_deflection_and_its_band_ends_in_that_of_the_level() {
        let curve = curve(&Bristle::Dahl(1.0e-5), &[], &told(1.0e-5, 1.0e-6)).unwrap();
        assert_eq!(
            (curve.law, curve.elements.len(), curve.points.len()),
            ("dahl", 0, 41)
        );
        let first = curve.points[0];
        assert_eq!(
            (first.way, first.force, first.low, first.high),
            (0.0, -200.0, -202.0, -198.0)
        );
        let last = curve.points[40];
        assert!(last.force > 195.0 && last.high - last.low < 6.0, "{last:?}");
        let turns = curve
            .points
            .iter()
            .position(|point| point.force > 0.0)
            .unwrap();
        let way = curve.points[turns].way / 1.0e-5;
        // Half the level is over after δ ln 2.
        assert!((0.69..0.80).contains(&way), "{way}");
        let middle = curve.points[turns];
        assert!(middle.high - middle.low > 20.0, "{middle:?}");
    }

    #[test]
    fn elements_give_straight_stretches_and_end_where_the_last_one_slips() {
        let two = elements(1.0e-5, &[(0.5, 0.5), (1.0, 0.5)]);
        let deflection = two.deflection();
        let curve = curve(&Bristle::Slip(two), &[], &told(deflection, 0.0)).unwrap();
        assert_eq!(curve.law, "maxwell-slip");
        assert_eq!(
            curve.elements[1],
            SlipElement {
                deflection: 1.0e-5,
                share: 0.5
            }
        );
        let last = curve.points[40];
        assert!((last.way - 2.0e-5).abs() < 1.0e-12 && (last.force - 200.0).abs() < 1.0e-9);
        let at_half = curve
            .points
            .iter()
            .find(|point| point.way > 1.0e-5)
            .unwrap();
        // The first has slipped all the way, the second half of it.
        assert!((at_half.force - (100.0 + 200.0 * (at_half.way / 2.0e-5 - 0.5))).abs() < 1.0e-6);
    }

    #[test]
    fn without_a_level_there_is_no_curve() {
        assert!(curve(&Bristle::Dahl(1.0e-5), &[], &BTreeMap::new()).is_none());
    }
}
