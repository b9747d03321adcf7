//! What a record says of a parameter.

use serde::{Deserialize, Serialize};

use crate::vocabulary::Effect;

/// A value with its 95 % interval and its unit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Estimate {
    /// Value.
    pub value: f64,
    /// Unit, as people write it: `N s/m`.
    pub unit: String,
    /// Lower end of the interval; the value itself where no interval is known.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl Estimate {
    /// The estimate of a quantity that is proportional to this one.
    #[must_use]
    pub fn scaled(&self, factor: f64, unit: &str) -> Self {
        let ends = [self.low * factor, self.high * factor];
        Self {
            value: self.value * factor,
            unit: unit.into(),
            low: ends[0].min(ends[1]),
            high: ends[0].max(ends[1]),
        }
    }
}

impl Estimate {
    /// A value with the half width of its interval.
    #[must_use]
    pub fn about(value: f64, half_width: f64, unit: &str) -> Self {
        Self {
            value,
            unit: unit.into(),
            low: value - half_width,
            high: value + half_width,
        }
    }

    /// Half of the interval's width.
    #[must_use]
    pub const fn half_width(&self) -> f64 {
        0.5 * (self.high - self.low)
    }

    /// The sum with so many times another one that errs apart from this one.
    #[must_use]
    pub fn plus(&self, times: f64, other: &Self) -> Self {
        let half_width = self.half_width().hypot(times * other.half_width());
        Self::about(self.value + times * other.value, half_width, &self.unit)
    }

    /// The product with another one that errs apart from this one.
    #[must_use]
    pub fn times(&self, other: &Self, unit: &str) -> Self {
        let half_width = (self.half_width() * other.value).hypot(self.value * other.half_width());
        Self::about(self.value * other.value, half_width, unit)
    }

    /// The share of another one that errs apart from this one.
    #[must_use]
    pub fn over(&self, other: &Self, unit: &str) -> Self {
        let value = self.value / other.value;
        let half_width =
            (self.half_width() / other.value).hypot(value * other.half_width() / other.value);
        Self::about(value, half_width, unit)
    }
}

impl Effect<Estimate> {
    /// The values alone, each moved into the range that a machine file may state.
    ///
    /// # Panics
    /// Never: an effect has the parameters that it needs.
    #[must_use]
    pub fn stated(&self) -> Effect {
        let parts = self.parts();
        let stated = Effect::assemble(self.name(), |row| {
            let part = parts.iter().find(|(other, _)| *other == row);
            part.map(|(_, estimate)| estimate.value.clamp(row.min, row.max))
        });
        stated.expect("it has all that it needs")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{PitchError, Stribeck};

    #[test]
    fn sums_and_shares_are_as_uncertain_as_both_of_their_parts() {
        let [one, other] = [
            Estimate::about(20.0, 0.3, "N"),
            Estimate::about(-10.0, 0.2, "N"),
        ];
        let sum = one.plus(2.0, &other);
        assert_eq!((sum.value, sum.unit.as_str()), (0.0, "N"));
        assert!((sum.half_width() - 0.5).abs() < 1.0e-12);
        let share = Estimate::about(3.0, 0.09, "N").over(&Estimate::about(10.0, 0.4, "N"), "");
        assert!((share.value - 0.3).abs() < 1.0e-12);
        assert!((share.half_width() - 0.3 * 0.05).abs() < 1.0e-12);
    }

    #[test]
    fn what_is_stated_of_an_estimate_is_its_value_within_the_range() {
        let estimate = |value| Estimate {
            value,
            low: 0.0,
            high: 9.0,
            unit: "N".into(),
        };
        let stribeck = Effect::from(Stribeck {
            excess: estimate(-3.0),
            velocity: estimate(2.0e-3),
            exponent: Some(estimate(2.1)),
            lag: None,
            lag_growth: None,
        });
        let stated = Effect::from(Stribeck {
            excess: 0.0,
            velocity: 2.0e-3,
            exponent: Some(2.0),
            lag: None,
            lag_growth: None,
        });
        assert_eq!(stribeck.stated(), stated);
        let pitch = Effect::from(PitchError {
            amplitude: estimate(2.0e-3),
            period: estimate(0.01),
        });
        let Effect::PitchError(pitch) = pitch.stated() else {
            panic!("a pitch error stays one");
        };
        assert_eq!((pitch.amplitude, pitch.period), (1.0e-3, 0.01));
    }

    #[test]
    fn a_negative_factor_turns_the_interval_round() {
        let force = Estimate {
            value: 2.0,
            unit: "N".into(),
            low: 1.0,
            high: 4.0,
        };
        let turned = force.scaled(-0.5, "N m");
        assert_eq!((turned.value, turned.low, turned.high), (-1.0, -2.0, -0.5));
        assert_eq!(turned.unit, "N m");
    }
}
