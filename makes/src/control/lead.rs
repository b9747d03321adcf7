//! Lead compensator on position with an integral: no velocity is estimated.
//!
//! C(s) = gain·(s + z)/(s + p)·(1 + i/s), by Tustin's rule (Franklin, Powell and Emami-Naeini,
//! Feedback Control of Dynamic Systems, 2010, ch. 6). With z a third of the crossover and p three
//! times as much the lead is 53 degrees there, of which the integral takes 6.

use std::f64::consts::TAU;

/// Ratio of pole to crossover, and of crossover to zero.
const SPREAD: f64 = 3.0;
/// Corner of the integral as a share of the crossover: 6 degrees of phase.
const INTEGRAL_SHARE: f64 = 0.1;

/// A compensator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lead {
    /// Gain at high frequencies, effort per position.
    pub gain: f64,
    /// z, rad/s.
    pub zero_rad_s: f64,
    /// p, rad/s.
    pub pole_rad_s: f64,
    /// i, 1/s.
    pub integral_per_s: f64,
}

/// State of a compensator.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LeadState {
    error: f64,
    lead: f64,
    sum: f64,
}

impl Lead {
    /// By the crossover of the open loop on a rigid inertia, Hz: |C| = M w² there.
    #[must_use]
    pub fn of(inertia: f64, crossover_hz: f64) -> Self {
        let w = TAU * crossover_hz;
        Self {
            gain: SPREAD * inertia * w * w,
            zero_rad_s: w / SPREAD,
            pole_rad_s: w * SPREAD,
            integral_per_s: w * INTEGRAL_SHARE,
        }
    }

    /// The effort for the next period by the error of position.
    pub fn effort(&self, state: &mut LeadState, error: f64, period_s: f64) -> f64 {
        let rate = 2.0 / period_s;
        let (zero, pole) = (self.zero_rad_s, self.pole_rad_s);
        let risen = (rate + zero) * error - (rate - zero) * state.error;
        state.lead = (risen + (rate - pole) * state.lead) / (rate + pole);
        state.error = error;
        state.sum += self.integral_per_s * period_s * state.lead;
        self.gain * (state.lead + state.sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Amplitude and phase in degrees of the answer to a sine of the crossover.
    fn answer(lead: &Lead, frequency_hz: f64) -> (f64, f64) {
        let (period_s, mut state) = (1.0e-4, LeadState::default());
        let (mut sine, mut cosine) = (0.0, 0.0);
        let (settled, whole) = (200_000, 100_000);
        for k in 0..settled + whole {
            let angle = TAU * frequency_hz * f64::from(k) * period_s;
            let effort = lead.effort(&mut state, libm::sin(angle), period_s);
            if k >= settled {
                sine += effort * libm::sin(angle) / f64::from(whole) * 2.0;
                cosine += effort * libm::cos(angle) / f64::from(whole) * 2.0;
            }
        }
        let phase = libm::atan2(cosine, sine).to_degrees();
        (libm::hypot(sine, cosine), phase)
    }

    #[test]
    fn at_the_crossover_the_gain_is_that_of_the_inertia_and_the_lead_is_47_degrees() {
        let lead = Lead::of(2.0, 10.0);
        let (gain, phase) = answer(&lead, 10.0);
        let wanted = 2.0 * (TAU * 10.0) * (TAU * 10.0);
        assert!((gain / wanted - 1.0).abs() < 0.01, "{gain} {wanted}");
        assert!((phase - 47.4).abs() < 0.5, "{phase}");
    }
}
