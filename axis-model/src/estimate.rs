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
    /// The estimate of a quantity that is more than this one by a known amount.
    #[must_use]
    pub fn moved(&self, by: f64) -> Self {
        Self {
            value: self.value + by,
            unit: self.unit.clone(),
            low: self.low + by,
            high: self.high + by,
        }
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
        });
        let stated = Effect::from(Stribeck {
            excess: 0.0,
            velocity: 2.0e-3,
            exponent: Some(2.0),
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
        let moved = force.moved(0.5);
        assert_eq!((moved.value, moved.low, moved.high), (2.5, 1.5, 4.5));
        assert_eq!(moved.unit, "N");
    }
}
