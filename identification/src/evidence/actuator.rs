//! What stands between the recorded and the delivered effort: a delay, and a drive whose torque
//! falls behind.

use crate::evidence::selection::Scored;
use crate::fit::bench::{Bench, Model, Saturation};
use crate::fit::blocks::{Fit, Gain};
use crate::fit::search::{descend, smallest};

/// A delay below this is not worth a name, s.
pub(crate) const SHORTEST_DELAY_S: f64 = 1.0e-4;
/// Longest delay that is searched, s.
const LONGEST_DELAY_S: f64 = 6.0e-3;
/// Cut-off for the search of a delay: quantisation comes back through the controller as effort that
/// follows measured noise, and looks like a delay at 100 Hz but not here.
const DELAY_CUTOFF_HZ: f64 = 30.0;
/// Shares of the largest effort that are tried as lost.
const LOSSES: [f64; 8] = [0.004, 0.01, 0.02, 0.04, 0.08, 0.15, 0.25, 0.4];
/// The linearisation about the last fit is renewed so often.
const RENEWALS: usize = 3;

/// The cut-off for the delay search at a sample period.
#[must_use]
pub(crate) fn delay_cutoff_hz(period_s: f64) -> f64 {
    DELAY_CUTOFF_HZ.min(crate::motion::filter::cutoff_hz(period_s))
}

/// A record with the cut-off of the errors, and the same with that of the delay search.
#[derive(Clone, Copy)]
pub(crate) struct Pair<'a> {
    /// As the errors are defined.
    pub bench: &'a Bench<'a>,
    /// For the delay.
    pub low: &'a Bench<'a>,
}

/// Judges a delay.
#[must_use]
pub(crate) fn delay_candidate(
    pair: Pair<'_>,
    model: &Model,
    base: &Fit,
    round: usize,
) -> (Scored, Model) {
    let delayed = |delay_s: f64| Model {
        delay_s,
        ..model.clone()
    };
    let grid: Vec<f64> = (-8..=24)
        .map(|i| 2.5e-4 * f64::from(i))
        .filter(|d| *d <= LONGEST_DELAY_S)
        .collect();
    let start = smallest(grid, &|delay_s| pair.low.sse(&delayed(delay_s))).unwrap_or(0.0);
    let parameter = best_delay(pair.low, model, start);
    let extended = delayed(parameter);
    let gain = Gain::of(base, &pair.bench.fit(&extended));
    let gain_low = Gain::of(&pair.low.fit(model), &pair.low.fit(&extended));
    let gain = Gain {
        share: gain.share.min(gain_low.share),
        t: gain.t.min(gain_low.t),
        ..gain
    };
    let physical = parameter >= SHORTEST_DELAY_S;
    (
        Scored {
            effect: "delay",
            parameter,
            gain,
            physical,
            accepted: false,
            nameless: false,
            round,
        },
        extended,
    )
}

/// The delay of least error about a start value.
#[must_use]
pub(crate) fn best_delay(low: &Bench<'_>, model: &Model, start_s: f64) -> f64 {
    let sse = |delay_s: f64| {
        low.sse(&Model {
            delay_s,
            ..model.clone()
        })
    };
    descend(start_s, 1.0e-4, (-LONGEST_DELAY_S, LONGEST_DELAY_S), &sse)
}

/// Judges a saturating actuator.
#[must_use]
pub(crate) fn saturation_candidate(
    pair: Pair<'_>,
    model: &Model,
    base: &Fit,
    round: usize,
) -> (Scored, Model) {
    let extended = with_saturation(pair.bench, model, None);
    let gain = Gain::of(base, &pair.bench.fit(&extended));
    // Coarse positions dilute the inertia at 100 Hz, which bends like a saturation; at 30 Hz they
    // do not.
    let low = linearised(pair.low, model, extended.saturation.per_effort);
    let gain_low = Gain::of(&pair.low.fit(model), &pair.low.fit(&low));
    let gain = Gain {
        share: gain.share.min(gain_low.share),
        t: gain.t.min(gain_low.t),
        ..gain
    };
    let parameter = extended.saturation.per_effort;
    let physical = parameter > 0.0;
    (
        Scored {
            effect: "torque_saturation",
            parameter,
            gain,
            physical,
            accepted: false,
            nameless: false,
            round,
        },
        extended,
    )
}

/// The model with the saturation of least error; searched about a start value, or everywhere.
#[must_use]
pub(crate) fn with_saturation(bench: &Bench<'_>, model: &Model, start: Option<f64>) -> Model {
    let largest = largest_effort(bench);
    let sse = |k: f64| bench.sse(&linearised(bench, model, k));
    let grid = || LOSSES.iter().map(|loss| loss / largest).collect();
    let start = start.or_else(|| smallest(grid(), &sse)).unwrap_or(0.0);
    let k = descend(
        start,
        0.3 * start,
        (0.1 * LOSSES[0] / largest, 0.6 / largest),
        &sse,
    );
    linearised(bench, model, k)
}

fn largest_effort(bench: &Bench<'_>) -> f64 {
    let fitted = bench
        .motion
        .effort_lp
        .iter()
        .zip(&bench.motion.fitted)
        .filter(|(_, fitted)| **fitted);
    fitted.fold(f64::MIN_POSITIVE, |most, (effort, _)| {
        most.max(effort.abs())
    })
}

/// The model with a saturation k, linearised about its own fit.
#[must_use]
pub(crate) fn linearised(bench: &Bench<'_>, model: &Model, k: f64) -> Model {
    let mut model = Model {
        saturation: Saturation::default(),
        ..model.clone()
    };
    let mut about = bench.blocks(&bench.design(&model)).fit().coefficients;
    for _ in 0..RENEWALS {
        model.saturation = Saturation {
            per_effort: k,
            about,
        };
        about = bench.blocks(&bench.design(&model)).fit().coefficients;
    }
    model.saturation.about = about;
    model
}
