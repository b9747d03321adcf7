//! The edges of a gap between springy flanks, in motor − load.
//!
//! Units: m or rad, unit of the effort over it.

/// The edges of a gap in motor − load: the flanks are in contact beyond them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Flanks {
    /// Motor − load where the load is pushed backwards.
    pub low: f64,
    /// Motor − load where it is pushed forwards.
    pub high: f64,
    /// Stiffness of both flanks, as the force shows it.
    pub stiffness: f64,
}

impl Flanks {
    /// Width of the gap.
    pub(crate) const fn gap(self) -> f64 {
        self.high - self.low
    }

    /// The same about their middle, so many times as far apart.
    pub(super) fn wider_by(self, factor: f64) -> Self {
        let (middle, half) = (0.5 * (self.low + self.high), 0.5 * factor * self.gap());
        Self {
            low: middle - half,
            high: middle + half,
            ..self
        }
    }

    /// Motor − load within the gap, about its middle: what of it is no wind-up.
    pub(crate) fn lag(self, difference: &[f64]) -> Vec<f64> {
        let middle = 0.5 * (self.low + self.high);
        let within = |d: &f64| d.max(self.low).min(self.high) - middle;
        difference.iter().map(within).collect()
    }

    /// Wind-up of the flanks.
    pub(super) fn wind_up(self, d: f64) -> f64 {
        (d - self.high).max(0.0) + (d - self.low).min(0.0)
    }

    /// Rows at which they meet or part while motor − load changes by at least a step from one row
    /// to the next.
    pub(super) fn strikes(self, difference: &[f64], step: f64) -> Vec<bool> {
        let before = difference.iter().take(1).chain(difference);
        let pairs = before.zip(difference);
        pairs
            .map(|(before, at)| {
                self.touches(*before) != self.touches(*at) && (at - before).abs() >= step
            })
            .collect()
    }

    /// Whether they are in contact.
    pub(super) fn touches(self, d: f64) -> bool {
        !(self.low..self.high).contains(&d)
    }
}
