//! Searches for a gap and for a pitch error.

use std::f64::consts::TAU;

use super::columns::{Apart, FittedWays, Way};
use crate::evidence::thresholds::FEWEST_COUNTS;
use crate::fit::plain::Plain;
use crate::fit::search::{descend, smallest};
use crate::model::effects::geometric;
use crate::simulate::load::Behind;

/// Widths that are tried, between the smallest that counts and a hundred times that, or a
/// millimetre.
const WIDTHS: u32 = 24;
/// Shares of the moved mass that stand behind the gap, as tried.
const SHARES: [f64; 5] = [0.02, 0.3, 0.4, 0.5, 0.65];
/// Coefficients of restitution that are tried.
const RESTITUTIONS: [f64; 5] = [0.0, 0.3, 0.5, 0.7, 0.9];
/// First steps of the descent for the width, as shares of it: the grid's, then a narrow one.
const WIDTH_STEPS: [f64; 2] = [0.15, 0.02];

/// What is searched of a gap.
#[derive(Clone, Copy)]
struct Trial {
    gap: f64,
    /// Share of the moved mass behind it.
    share: f64,
    restitution: f64,
}

impl Trial {
    /// The load behind the gap, slowed by all of the friction.
    fn behind(self, plain: &Plain) -> Behind {
        let mass = self.share * plain.inertia;
        Behind {
            gap: self.gap,
            coulomb: plain.coulomb / mass,
            viscous: plain.viscous.max(0.0) / mass,
            restitution: self.restitution,
        }
    }
}

/// The gap that leaves least beside other ways, not narrower than the encoders show.
pub(crate) fn best_gap(apart: &Apart<'_>, ways: &[Way], count: f64) -> Way {
    let narrowest = FEWEST_COUNTS * count;
    let plain = Plain::fit(apart.motion);
    let sse = |trial: Trial| left_by(apart, ways, trial.behind(&plain));
    let mut best = Trial {
        gap: narrowest,
        share: SHARES[2],
        restitution: RESTITUTIONS[0],
    };
    let widths = geometric(narrowest, 1.0e-3_f64.max(100.0 * narrowest), WIDTHS);
    best.gap = smallest(&widths, &|gap| sse(Trial { gap, ..best })).unwrap_or(narrowest);
    for step in WIDTH_STEPS {
        best = improved(best, step, narrowest, &sse);
    }
    Way::Play(best.behind(&plain))
}

/// One parameter after the other.
fn improved(
    mut best: Trial,
    step: f64,
    narrowest: f64,
    sse: &(dyn Fn(Trial) -> f64 + Sync),
) -> Trial {
    best.gap = descend(best.gap, step * best.gap, (narrowest, f64::MAX), &|gap| {
        sse(Trial { gap, ..best })
    });
    best.restitution = smallest(&RESTITUTIONS, &|restitution| {
        sse(Trial {
            restitution,
            ..best
        })
    })
    .unwrap_or(best.restitution);
    best.share = smallest(&SHARES, &|share| sse(Trial { share, ..best })).unwrap_or(best.share);
    best.restitution = descend(best.restitution, 0.1, (0.0, 0.99), &|restitution| {
        sse(Trial {
            restitution,
            ..best
        })
    });
    best.share = descend(best.share, 0.05, (0.01, 0.95), &|share| {
        sse(Trial { share, ..best })
    });
    best
}

/// Sum of squares beside a gap. A gap is as wide as it is: its lag is subtracted, not scaled.
fn left_by(apart: &Apart<'_>, ways: &[Way], behind: Behind) -> f64 {
    let lag = behind.follow(apart.path.position, apart.motion.period_s);
    let pairs = apart.target.iter().zip(lag);
    let target: Vec<f64> = pairs.map(|(target, lag)| target - lag).collect();
    let without = Apart {
        target: &target,
        mask: apart.mask.clone(),
        ..*apart
    };
    without.blocks(ways).fit().sse
}

/// Every so many samples are scanned for a pitch error.
const STRIDE: usize = 8;
/// Fewest half periods within the travel: fewer are no pitch.
const FEWEST_HALF_PERIODS: usize = 8;
/// Most half periods that are scanned, and those of a pitch of half a millimetre.
const MOST_HALF_PERIODS: usize = 4000;
const HALF_PERIODS_PER_LENGTH: f64 = 4000.0;

/// The period with the strongest component in what other ways leave.
pub(crate) fn best_pitch(apart: &Apart<'_>, fitted: &FittedWays) -> Option<Way> {
    let (low, high) = apart.motion.span();
    let step = 0.5 / (high - low);
    let residual = apart.residual(fitted);
    let rows = (0..residual.len()).step_by(STRIDE);
    let inside = rows.filter(|row| apart.mask[*row]);
    let samples: Vec<(f64, f64)> = inside
        .map(|row| (apart.path.position[row], residual[row]))
        .collect();
    let most = ((HALF_PERIODS_PER_LENGTH * (high - low)) as usize).min(MOST_HALF_PERIODS);
    let coarse = (FEWEST_HALF_PERIODS..most.max(FEWEST_HALF_PERIODS + 1)).map(|i| step * i as f64);
    let best = strongest(&samples, coarse)?;
    let fine = (-8..=8).map(|i| best + step / 8.0 * f64::from(i));
    let per_length = strongest(&samples, fine)?;
    Some(Way::Pitch { per_length })
}

/// The wave number with the largest amplitude in samples over position.
fn strongest(samples: &[(f64, f64)], wave_numbers: impl Iterator<Item = f64>) -> Option<f64> {
    let amplitude = |k: f64| {
        let (re, im) = samples.iter().fold((0.0, 0.0), |(re, im), (x, left)| {
            let (sin, cos) = (TAU * k * x).sin_cos();
            (re + cos * left, im + sin * left)
        });
        re.hypot(im)
    };
    let all = wave_numbers.map(|k| (amplitude(k), k));
    all.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, k)| k)
}
