//! What a record says of a parameter.

use serde::{Deserialize, Serialize};

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

#[cfg(test)]
mod tests {
    use super::*;

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
