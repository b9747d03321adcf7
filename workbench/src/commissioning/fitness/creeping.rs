//! Whether an axis oscillates while it creeps: where friction falls as the speed grows, faster than
//! the loop damps, and where a loop rings at one speed alone.
//!
//! The axis accelerates slowly from rest. An oscillation of its own keeps its frequency while the
//! speed grows; what comes from the screw or the motor goes with the speed, and noise is as large
//! at every speed. Below 16 Hz, and over more than three quarters of the sweep, nothing is seen.

use super::{LEAST_CROSSINGS, amplitude};

/// Acceleration of the sweep, m/s², where the axis can do more.
pub(super) const ACCELERATION_M_PER_S2: f64 = 1.0e-3;
/// The longest sweep, s: up to 4 mm/s.
pub(super) const LONGEST_S: f64 = 4.0;
/// A part of the sweep that is looked at, s; the next one begins half of it later.
const PART_S: f64 = 0.25;
/// Parts in a row that have to oscillate.
const IN_A_ROW: usize = 3;
/// An oscillation is at least so many times what the quieter quarter of all parts has.
const ABOVE_NOISE: f64 = 3.0;
/// Its frequency changes by at most this share of what the speed changes by, as logarithms.
const OWN: f64 = 0.5;

/// What oscillates while the axis creeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Creep {
    pub(super) frequency_hz: f64,
    pub(super) amplitude_um: f64,
    /// Speed at which it is largest.
    pub(super) speed_m_per_s: f64,
}

/// The errors of a sweep with its acceleration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sweep<'a> {
    pub(super) error_um: &'a [f64],
    pub(super) period_s: f64,
    pub(super) acceleration_m_per_s2: f64,
}

/// The largest oscillation of a sweep; `None` where there is none.
pub(super) fn oscillation(sweep: Sweep<'_>, least_um: f64) -> Option<Creep> {
    let parts = parts(sweep);
    let mut sizes: Vec<f64> = parts.iter().map(|part| part.amplitude_um).collect();
    sizes.sort_by(f64::total_cmp);
    let quiet_um = *sizes.get(sizes.len() / 4)?;
    let least_um = least_um.max(ABOVE_NOISE * quiet_um);
    let rings = |part: &Creep| part.amplitude_um >= least_um && part.frequency_hz > 0.0;
    let rows = parts
        .chunk_by(|one, other| rings(one) && rings(other))
        .filter(|row| row.len() >= IN_A_ROW && is_own(row));
    rows.flatten()
        .max_by(|one, other| one.amplitude_um.total_cmp(&other.amplitude_um))
        .copied()
}

/// The parts of a sweep; one with too few crossings for an oscillation has no frequency.
fn parts(sweep: Sweep<'_>) -> Vec<Creep> {
    let Sweep {
        error_um, period_s, ..
    } = sweep;
    let rows = ((PART_S / period_s).round() as usize).max(2);
    let begins = (0..error_um.len().saturating_sub(rows - 1)).step_by(rows / 2);
    let of = |begin: usize| {
        let own = about_a_parabola(&error_um[begin..begin + rows]);
        let middle_s = period_s * (begin + rows / 2) as f64;
        Creep {
            frequency_hz: frequency(&own) / period_s,
            amplitude_um: amplitude(&own),
            speed_m_per_s: sweep.acceleration_m_per_s2 * middle_s,
        }
    };
    begins.map(of).collect()
}

/// Per row, from the first crossing of zero to the last one; zero where there are too few.
fn frequency(values: &[f64]) -> f64 {
    let crosses = |(place, pair): (usize, &[f64])| {
        let (from, to) = (pair[0], pair[1]);
        ((from > 0.0) != (to > 0.0)).then(|| place as f64 + from / (from - to))
    };
    let at: Vec<f64> = values.windows(2).enumerate().filter_map(crosses).collect();
    match &at[..] {
        [first, .., last] if at.len() as f64 >= LEAST_CROSSINGS => {
            (at.len() - 1) as f64 / (2.0 * (last - first))
        }
        _ => 0.0,
    }
}

/// Whether the frequency stays while the speed grows.
fn is_own(row: &[Creep]) -> bool {
    let [first, .., last] = row else { return false };
    let change = |of: fn(&Creep) -> f64| (of(last) / of(first)).ln().abs();
    change(|part| part.frequency_hz) <= OWN * change(|part| part.speed_m_per_s)
}

/// What is left beside the parabola of least squares: the slow error of a reversal is no
/// oscillation. By the orthogonal polynomials 1, x and x² − mean.
fn about_a_parabola(values: &[f64]) -> Vec<f64> {
    let count = values.len() as f64;
    let at = |place: usize| (place as f64 + 0.5) / count - 0.5;
    let mean_square = (0..values.len())
        .map(|place| at(place).powi(2))
        .sum::<f64>()
        / count;
    let polynomials: [Box<dyn Fn(f64) -> f64>; 3] = [
        Box::new(|_| 1.0),
        Box::new(|x| x),
        Box::new(move |x| x * x - mean_square),
    ];
    let mut left = values.to_vec();
    for polynomial in &polynomials {
        let (mut product, mut square) = (0.0, 0.0);
        for (place, value) in left.iter().enumerate() {
            let own = polynomial(at(place));
            product += own * value;
            square += own * own;
        }
        for (place, value) in left.iter_mut().enumerate() {
            *value -= product / square * polynomial(at(place));
        }
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const PERIOD_S: f64 = 1.0e-3;

    /// A sweep of 4 s with a slow error, and what is added at each time.
    fn sweep(added_um: impl Fn(f64) -> f64) -> Vec<f64> {
        let at = |cycle: u32| {
            let time_s = PERIOD_S * f64::from(cycle);
            14.0 * (-3.0 * time_s).exp() + added_um(time_s)
        };
        (0..4000).map(at).collect()
    }

    fn of(error_um: &[f64]) -> Option<Creep> {
        let sweep = Sweep {
            error_um,
            period_s: PERIOD_S,
            acceleration_m_per_s2: ACCELERATION_M_PER_S2,
        };
        oscillation(sweep, 1.0)
    }

    /// Amplitude of what rings between 0.7 and 1.4 s.
    fn bump(time_s: f64) -> f64 {
        4.0 * (-((time_s - 1.05) / 0.35).powi(4)).exp()
    }

    #[test]
    fn what_rings_at_one_speed_is_seen_with_it() {
        let rings = sweep(|time_s| bump(time_s) * (TAU * 24.0 * time_s).sin());
        let seen = of(&rings).unwrap();
        assert!((seen.frequency_hz - 24.0).abs() < 1.0, "{seen:?}");
        assert!((seen.amplitude_um - 4.0).abs() < 0.3, "{seen:?}");
        assert!((seen.speed_m_per_s - 1.05e-3).abs() < 0.2e-3, "{seen:?}");
    }

    #[test]
    fn a_slow_error_noise_and_ripple_are_no_oscillation() {
        let noise = |time_s: f64| 2.0 * (1.0e4 * (12.9898 * time_s * 1.0e3).sin()).rem_euclid(1.0);
        // A wave of 0.05 mm over the way a t² / 2.
        let ripple = |time_s: f64| (TAU * 0.5e-3 * time_s * time_s / 0.05e-3).sin();
        assert_eq!(of(&sweep(|_| 0.0)), None);
        assert_eq!(of(&sweep(noise)), None);
        let wave = sweep(|time_s| bump(time_s) * ripple(time_s));
        assert_eq!(of(&wave), None);
        assert_eq!(of(&[]), None);
    }
}
