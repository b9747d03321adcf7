//! The effort that acts, where a known first-order lag stands between it and the recorded one:
//! `T du/dt = u_recorded − u`.

use crate::record::units::EffortHold;

/// Share of the way to where it goes that a first-order lag covers in a time.
#[must_use]
pub(crate) fn share(time_s: f64, lag_s: f64) -> f64 {
    -(-time_s / lag_s).exp_m1()
}

/// The acting effort at the rows; for a zero-order hold, its mean over the interval of the row.
#[must_use]
pub(crate) fn acting_effort(
    recorded: &[f64],
    lag_s: f64,
    period_s: f64,
    hold: EffortHold,
) -> Vec<f64> {
    if lag_s <= 0.0 {
        return recorded.to_vec();
    }
    let decay = (-period_s / lag_s).exp();
    let mean_share = lag_s / period_s * (1.0 - decay);
    let mut state = recorded.first().copied().unwrap_or(0.0);
    recorded
        .iter()
        .map(|u| {
            let before = state;
            state = u + (state - u) * decay;
            match hold {
                EffortHold::ZeroOrder => u + (before - u) * mean_share,
                EffortHold::Instant => state,
            }
        })
        .collect()
}

/// By how much more of the acting effort is in the second half of a row than in the first,
/// weighted by the way from its middle, where the effort goes evenly: a share of what it changes by
/// in a row. A twelfth where the lag is long, nothing without one: a held effort is even.
#[must_use]
pub(crate) fn unevenness(lag_s: f64, period_s: f64) -> f64 {
    if lag_s <= 0.0 {
        return 0.0;
    }
    let rows = period_s / lag_s;
    let decay = (-rows).exp();
    // Of exp(−rows y) from 0 to 1: its mean weighted by 1 − 2 y.
    let weighted = (1.0 - decay) / rows - 2.0 * (1.0 - decay * (1.0 + rows)) / rows.powi(2);
    0.5 * weighted / (1.0 - decay)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step from 0 to 1 at row 10, rows of 1 ms.
    fn step() -> Vec<f64> {
        (0..40).map(|row| f64::from(u8::from(row >= 10))).collect()
    }

    #[test]
    fn without_a_lag_the_recorded_effort_acts() {
        assert_eq!(
            acting_effort(&step(), 0.0, 1.0e-3, EffortHold::Instant),
            step()
        );
    }

    #[test]
    fn an_instantaneous_effort_follows_a_step_exponentially() {
        let acting = acting_effort(&step(), 5.0e-3, 1.0e-3, EffortHold::Instant);
        assert_eq!(acting[9], 0.0);
        // Five rows after the row before the step: one time constant.
        assert!((acting[14] - (1.0 - (-1.0_f64).exp())).abs() < 1.0e-12);
    }

    #[test]
    fn a_held_effort_acts_with_its_mean_over_the_row() {
        let acting = acting_effort(&step(), 5.0e-3, 1.0e-3, EffortHold::ZeroOrder);
        // ∫ (1 − exp(−t/5)) dt from 0 to 1.
        let wanted = 1.0 - 5.0 * (1.0 - (-0.2_f64).exp());
        assert!((acting[10] - wanted).abs() < 1.0e-12, "{}", acting[10]);
    }

    #[test]
    fn an_effort_is_uneven_within_its_rows_as_far_as_it_lags() {
        assert_eq!(unevenness(0.0, 1.0e-3), 0.0);
        assert!(unevenness(1.0e-5, 1.0e-3) < 0.006);
        assert!((unevenness(0.1, 1.0e-3) - 1.0 / 12.0).abs() < 1.0e-4);
    }
}
