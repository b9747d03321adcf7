//! The one low-pass of the error definitions: Butterworth, 4th order, forwards and backwards.

use crate::motion::butterworth::Butterworth;
use crate::record::dataset::Dataset;
use crate::record::samples::Record;

/// Rows trimmed at each end of a filtered record, by definition of the errors.
const TRIM: usize = 200;
/// Of a short record at most one row in so many is trimmed at each end: otherwise a second at
/// 500 Hz would keep a fifth of its rows, and one at 250 Hz none. At a cut-off of a tenth of the
/// rate the filter settles within 30 rows.
const LARGEST_TRIM: usize = 4;

/// Rows trimmed at each end of a filtered piece of so many rows.
#[must_use]
pub(crate) const fn trim(rows: usize) -> usize {
    let most = rows / LARGEST_TRIM;
    if TRIM < most { TRIM } else { most }
}

/// Cut-off of a sample rate: 100 Hz, or 0.1 of the rate where that is below 1 kHz.
#[must_use]
pub(crate) fn cutoff_hz(period_s: f64) -> f64 {
    let rate = 1.0 / period_s;
    if rate < 999.0 { 0.1 * rate } else { 100.0 }
}

/// Cut-off where the clock jittered: the acceleration of jittered positions is noise above it, and
/// inertia would come out small.
const JITTERED_CUTOFF_HZ: f64 = 20.0;

/// Cut-off with which a record is fitted.
#[must_use]
pub(crate) fn fit_cutoff_hz(dataset: &Dataset, record: &Record) -> f64 {
    let defined = cutoff_hz(record.period_s);
    if record.jittered && !dataset.full_band {
        defined.min(JITTERED_CUTOFF_HZ)
    } else {
        defined
    }
}

/// Zero-phase low-pass.
#[derive(Clone, Debug)]
pub(crate) struct LowPass {
    filter: Butterworth,
    /// Its cut-off.
    pub cutoff_hz: f64,
}

impl LowPass {
    /// A low-pass for a sample period; `None` where the cut-off is not below half the sample rate.
    #[must_use]
    pub(crate) fn new(period_s: f64, cutoff_hz: f64) -> Option<Self> {
        let filter = Butterworth::new(1.0 / period_s, cutoff_hz)?;
        Some(Self { filter, cutoff_hz })
    }

    /// The filtered signal, of the same length.
    ///
    /// A record that is shorter than the filter's padding comes back as it was; readers refuse such
    /// records.
    #[must_use]
    pub(crate) fn apply(&self, signal: &[f64]) -> Vec<f64> {
        self.filter.both_ways(signal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn two_hundred_rows_are_trimmed_or_a_quarter_of_a_short_record() {
        let of = [10_000, 1000, 800, 500, 250].map(trim);
        assert_eq!(of, [200, 200, 200, 125, 62]);
    }

    #[test]
    fn the_gain_is_that_of_a_butterworth_run_twice_and_the_phase_is_zero() {
        let filter = LowPass::new(1.0e-3, 100.0).unwrap();
        for hz in [10.0, 50.0, 100.0, 200.0] {
            let wave: Vec<f64> = (0..4000)
                .map(|i| (TAU * hz * 1.0e-3 * f64::from(i)).cos())
                .collect();
            let out = filter.apply(&wave);
            let gain = (1500..2500).map(|i| out[i] * wave[i]).sum::<f64>()
                / (1500..2500).map(|i| wave[i].powi(2)).sum::<f64>();
            // Bilinear transform: tan(π f / fs).
            let ratio = (TAU / 2.0 * hz * 1.0e-3).tan() / (TAU / 2.0 * 0.1).tan();
            let wanted = 1.0 / (1.0 + ratio.powi(8));
            assert!((gain - wanted).abs() < 2.0e-3, "{hz} Hz: {gain} {wanted}");
        }
    }
}
