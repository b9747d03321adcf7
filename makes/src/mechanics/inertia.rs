//! Inertia of a body: constant, changing at a time or with it, or a function of position.
//!
//! With J(x) the energy is T = ½ J(x) v² and Lagrange's equation gives J a + ½ J'(x) v² = F: the
//! second term is what a crank or an arm adds (Wittenburg, Dynamics of Multibody Systems, 2008).
//! With J(t), of something on board that moves by itself, it gives J a + J'(t) v = F.

use std::f64::consts::TAU;

/// Inertia, kg or kg m².
#[derive(Clone, Debug, PartialEq)]
pub enum Inertia {
    /// The same always.
    Constant(f64),
    /// A payload is taken up at some times and put down at others; `at_s` alternates.
    Payload {
        /// Without payload.
        empty: f64,
        /// With it.
        loaded: f64,
        /// When it changes, s.
        at_s: Vec<f64>,
    },
    /// A reel that fills from the start of the record. What arrives moves along already, so that
    /// it takes no momentum.
    Filling {
        /// At the start.
        empty: f64,
        /// Growth, per second.
        per_s: f64,
    },
    /// J(x) = mean · (1 + share · cos(waves · x + phase)): a crank over its angle, an arm whose
    /// second link stretches and folds.
    Harmonic {
        /// Mean.
        mean: f64,
        /// Amplitude, as a share of the mean.
        share: f64,
        /// Wave number, rad per unit of position.
        waves: f64,
        /// Phase at position zero, rad.
        phase: f64,
    },
    /// J(t) = mean · (1 + share · sin(2π f t)): something on board stretches and folds by itself.
    Breathing {
        /// Mean.
        mean: f64,
        /// Amplitude, as a share of the mean.
        share: f64,
        /// f, Hz.
        frequency_hz: f64,
    },
}

impl Inertia {
    /// At a position and a time.
    #[must_use]
    pub fn at(&self, position: f64, time_s: f64) -> f64 {
        match self {
            Self::Constant(inertia) => *inertia,
            Self::Payload {
                empty,
                loaded,
                at_s,
            } => {
                let changes = at_s.iter().filter(|at| time_s >= **at).count();
                if changes % 2 == 1 { *loaded } else { *empty }
            }
            Self::Filling { empty, per_s } => empty + per_s * time_s.max(0.0),
            Self::Harmonic {
                mean,
                share,
                waves,
                phase,
            } => mean * (1.0 + share * libm::cos(waves * position + phase)),
            Self::Breathing {
                mean,
                share,
                frequency_hz,
            } => mean * (1.0 + share * libm::sin(TAU * frequency_hz * time_s)),
        }
    }

    /// dJ/dx.
    #[must_use]
    pub fn slope(&self, position: f64) -> f64 {
        match self {
            Self::Constant(_)
            | Self::Payload { .. }
            | Self::Filling { .. }
            | Self::Breathing { .. } => 0.0,
            Self::Harmonic {
                mean,
                share,
                waves,
                phase,
            } => -mean * share * waves * libm::sin(waves * position + phase),
        }
    }

    /// dJ/dt of what moves by itself, which takes momentum along.
    #[must_use]
    pub fn rate(&self, time_s: f64) -> f64 {
        match self {
            Self::Constant(_)
            | Self::Payload { .. }
            | Self::Filling { .. }
            | Self::Harmonic { .. } => 0.0,
            Self::Breathing {
                mean,
                share,
                frequency_hz,
            } => {
                let w = TAU * frequency_hz;
                mean * share * w * libm::cos(w * time_s)
            }
        }
    }

    /// Its middle: what a model with one inertia would be told.
    #[must_use]
    pub fn nominal(&self) -> f64 {
        match self {
            Self::Constant(inertia) => *inertia,
            Self::Payload { empty, .. } | Self::Filling { empty, .. } => *empty,
            Self::Harmonic { mean, .. } | Self::Breathing { mean, .. } => *mean,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_is_the_derivative() {
        let crank = Inertia::Harmonic {
            mean: 2.0,
            share: 0.3,
            waves: 2.0,
            phase: 0.4,
        };
        for position in [-1.0, 0.0, 0.7] {
            let change = crank.at(position + 1.0e-6, 0.0) - crank.at(position - 1.0e-6, 0.0);
            assert!((change / 2.0e-6 - crank.slope(position)).abs() < 1.0e-8);
        }
    }

    #[test]
    fn a_payload_is_taken_and_put_down() {
        let gripper = Inertia::Payload {
            empty: 3.0,
            loaded: 5.0,
            at_s: vec![1.0, 2.0],
        };
        assert_eq!(
            [0.9, 1.0, 1.9, 2.0].map(|t| gripper.at(0.0, t)),
            [3.0, 5.0, 5.0, 3.0]
        );
    }
}
