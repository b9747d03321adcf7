//! The random numbers of a plan: one stream for everything.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal, Uniform};

/// Numbers drawn one after the other.
pub(super) struct Draws(ChaCha8Rng);

impl Draws {
    /// The stream of a seed.
    pub(super) fn of(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Uniform between two limits.
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        Uniform::new(low, high).map_or(low, |range| range.sample(&mut self.0))
    }

    /// Normal, with standard deviation one.
    pub(super) fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }
}
