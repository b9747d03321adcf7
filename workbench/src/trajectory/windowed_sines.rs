//! What `commission` moves to record an axis: slow and fast runs, reversals at several
//! accelerations, within the axis limits.
//!
//! A sequence of windowed sines. A sine passes every velocity up to its peak and reverses
//! with its peak acceleration, so a few of them from 1.5 mm/s to over half the axis' velocity cover
//! Stribeck fall, viscous friction, presliding and inertia.

use std::f64::consts::TAU;

use plant_sim::machine::Limits;

use super::smoothstep::smoothstep;

/// A sine that comes in and goes out smoothly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowedSine {
    amplitude_m: f64,
    frequency_hz: f64,
    duration_s: f64,
}

/// Peak velocity and peak acceleration of each burst, as shares of the axis limits, and its number
/// of periods.
const TRAIN: [(f64, f64, f64); 9] = [
    (0.003, 0.0008, 3.0),
    (0.008, 0.004, 4.0),
    (0.02, 0.02, 6.0),
    (0.05, 0.05, 6.0),
    (0.12, 0.15, 8.0),
    (0.3, 0.15, 4.0),
    (0.3, 0.6, 10.0),
    (0.6, 0.4, 4.0),
    (0.1, 0.5, 14.0),
];
/// The validation record moves otherwise: another share of everything.
const VALIDATION: (f64, f64) = (0.8, 0.65);
/// The most of the limits that any burst uses.
const MOST: f64 = 0.7;
/// Rest before and after each sine.
const REST_S: f64 = 0.3;
/// Window that brings a burst in and out, periods.
const WINDOW: f64 = 0.75;

/// The bursts of the training record (or of the validation record) within the limits of an axis.
#[must_use]
pub fn sequence(limits: &Limits, validation: bool) -> Vec<WindowedSine> {
    let (v_share, a_share) = if validation { VALIDATION } else { (1.0, 1.0) };
    let sine = |(v, a, periods): &(f64, f64, f64)| {
        let velocity = (v * v_share).min(MOST) * limits.velocity_m_per_s;
        let acceleration = (a * a_share).min(MOST) * limits.acceleration_m_per_s2;
        // v = ω A, a = ω v.
        let omega = acceleration / velocity;
        let amplitude_m = (velocity / omega).min(MOST * limits.travel_m);
        let frequency_hz = omega / TAU;
        WindowedSine {
            amplitude_m,
            frequency_hz,
            duration_s: (periods + 2.0 * WINDOW) / frequency_hz,
        }
    };
    TRAIN.iter().map(sine).collect()
}

/// Duration of a record, s.
#[must_use]
pub fn duration_s(sines: &[WindowedSine]) -> f64 {
    sines
        .iter()
        .map(|sine| sine.duration_s + REST_S)
        .sum::<f64>()
        + REST_S
}

/// Setpoint at a time, m.
#[must_use]
pub fn at(sines: &[WindowedSine], time_s: f64) -> f64 {
    let mut start = REST_S;
    for sine in sines {
        let t = time_s - start;
        if t < 0.0 {
            return 0.0;
        }
        if t < sine.duration_s {
            let window = smooth(t * sine.frequency_hz / WINDOW)
                * smooth((sine.duration_s - t) * sine.frequency_hz / WINDOW);
            return sine.amplitude_m * window * (TAU * sine.frequency_hz * t).sin();
        }
        start += sine.duration_s + REST_S;
    }
    0.0
}

fn smooth(u: f64) -> f64 {
    smoothstep(u.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_record_passes_the_limits_of_its_axis() {
        let limits = Limits {
            velocity_m_per_s: 0.5,
            acceleration_m_per_s2: 5.0,
            travel_m: 0.25,
        };
        for validation in [false, true] {
            let sines = sequence(&limits, validation);
            let (dt, mut fastest, mut hardest) = (1.0e-3, 0.0_f64, 0.0_f64);
            let mut t = dt;
            while t < duration_s(&sines) {
                let [a, b, c] = [t - dt, t, t + dt].map(|t| at(&sines, t));
                fastest = fastest.max(((c - a) / (2.0 * dt)).abs());
                hardest = hardest.max(((c - 2.0 * b + a) / (dt * dt)).abs());
                assert!(b.abs() < limits.travel_m);
                t += dt;
            }
            assert!(
                fastest < limits.velocity_m_per_s && hardest < limits.acceleration_m_per_s2,
                "{fastest} {hardest}"
            );
        }
    }
}
