//! What another pulse would leave of a burst, from a circle without and one with a pulse.
//!
//! About a reversal the closed loop is linear enough: what a pulse does to the path, r, is the
//! difference of the two circles. The pulse itself is a geometric series, `h / (1 − d z⁻¹)` with
//! `d = exp(−T / T_comp)`. So another one of height h', decay d' and a delay of n cycles more does
//!
//! ```text
//! r' = h'/h · (1 − d z⁻¹) / (1 − d' z⁻¹) · z⁻ⁿ r
//! ```
//!
//! and the best one is found without running a circle. Where friction makes it wrong, a circle with
//! that pulse is the next one to judge from: with the pulse itself the prediction is the circle.

use argmin::core::{CostFunction, Executor, State};
use argmin::solver::neldermead::NelderMead;

use super::valley::SENSIBLE_S;
use crate::compensation::Pulse;
use crate::error::{Failure, Outcome};

/// Radial deviations after a reversal, in both directions: to positive position, to negative.
/// Cycles are µm, one after the other.
pub(super) type Bursts = [Vec<f64>; 2];

/// Pulses of both directions: heights, and what they have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::struct_field_names, reason = "units end in seconds")]
pub(super) struct Pulses {
    /// To positive position, to negative, m/s.
    pub(super) heights_m_per_s: [f64; 2],
    pub(super) time_constant_s: f64,
    pub(super) start_delay_s: f64,
}

impl Pulses {
    /// The same pulse both ways.
    pub(super) fn both(pulse: &Pulse) -> Self {
        Self {
            heights_m_per_s: [pulse.height_m_per_s; 2],
            time_constant_s: pulse.time_constant_s,
            start_delay_s: pulse.start_delay_s,
        }
    }
}

/// Two circles: without a pulse, and with one.
pub(super) struct Probe<'a> {
    pub(super) without: &'a Bursts,
    pub(super) with: &'a Bursts,
    pub(super) pulses: Pulses,
    pub(super) period_s: f64,
}

/// The cost is a norm of this order of the deviations: nearly their largest, but smooth.
const ORDER: i32 = 20;

/// What is left of bursts, µm: about the largest deviation of each direction, their mean.
pub(super) fn left_um(bursts: &Bursts) -> f64 {
    let norm = |burst: &Vec<f64>| {
        let largest = burst.iter().fold(0.0_f64, |most, own| most.max(own.abs()));
        if largest == 0.0 {
            return 0.0;
        }
        let sum: f64 = burst.iter().map(|own| (own / largest).powi(ORDER)).sum();
        largest * sum.powf(1.0 / f64::from(ORDER))
    };
    0.5 * (norm(&bursts[0]) + norm(&bursts[1]))
}

impl Probe<'_> {
    /// Bursts with other pulses, µm.
    pub(super) fn predicted(&self, other: &Pulses) -> Bursts {
        [0, 1].map(|way| {
            let moved = self.moved(way, other);
            let pairs = self.without[way].iter().zip(moved);
            pairs.map(|(without, moved)| without + moved).collect()
        })
    }

    /// What other pulses do to the path in a direction.
    fn moved(&self, way: usize, other: &Pulses) -> Vec<f64> {
        let own = &self.pulses;
        let height = own.heights_m_per_s[way];
        if height == 0.0 {
            return vec![0.0; self.without[way].len()];
        }
        let gain = other.heights_m_per_s[way] / height;
        let decay = |pulses: &Pulses| (-self.period_s / pulses.time_constant_s).exp();
        let (before, after) = (decay(own), decay(other));
        let (mut input, mut output) = (0.0, 0.0);
        let pairs = self.with[way].iter().zip(&self.without[way]);
        let prompt: Vec<f64> = pairs
            .map(|(with, without)| {
                let response = with - without;
                output = after * output + gain * (response - before * input);
                input = response;
                output
            })
            .collect();
        delayed(
            &prompt,
            (other.start_delay_s - own.start_delay_s) / self.period_s,
        )
    }

    /// The pulses that leave least, as far as these circles tell.
    ///
    /// # Errors
    /// Where the solver fails.
    pub(super) fn best(&self) -> Outcome<Pulses> {
        let mut corner = START;
        // A simplex that has shrunk to a wrong place begins anew there.
        for _ in 0..2 {
            let simplex = simplex(corner);
            let solver = NelderMead::new(simplex).with_sd_tolerance(1.0e-4);
            let solver = solver.map_err(|error| Failure::new(error.to_string()))?;
            let executor =
                Executor::new(self, solver).configure(|state| state.max_iters(MOST_STEPS));
            let result = executor.run();
            let result = result.map_err(|error| Failure::new(error.to_string()))?;
            if let Some(best) = result.state().get_best_param() {
                corner.copy_from_slice(best);
            }
        }
        Ok(self.pulses_at(corner))
    }

    /// Ways that both pulses add over those of the probe, ln of the time constant over its, and the
    /// delay over its time constant.
    fn pulses_at(&self, [forward, backward, ln_time, delay]: Corner) -> Pulses {
        let own = &self.pulses;
        let times = ln_time.exp();
        let [a, b] = own.heights_m_per_s;
        Pulses {
            heights_m_per_s: [a * forward / times, b * backward / times],
            time_constant_s: own.time_constant_s * times,
            start_delay_s: own.start_delay_s + own.time_constant_s * delay,
        }
    }
}

/// Cycles by which a response comes later, or earlier; between cycles it is straight.
fn delayed(response: &[f64], cycles: f64) -> Vec<f64> {
    let at = |place: f64| {
        let whole = place.floor();
        if whole < 0.0 {
            return 0.0;
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "whole, and not negative"
        )]
        let index = whole as usize;
        let [from, to] = [index, index + 1].map(|index| response.get(index).copied());
        let from = from.unwrap_or(0.0);
        from + (place - whole) * (to.unwrap_or(from) - from)
    };
    (0..response.len())
        .map(|cycle| at(cycle as f64 - cycles))
        .collect()
}

type Corner = [f64; 4];
const START: Corner = [1.0, 1.0, 0.0, 0.0];
/// First steps of the search.
const STEPS: Corner = [0.2, 0.2, 0.3, 0.2];
const MOST_STEPS: u64 = 200;
/// Ln of the time constant may leave that of the probe by so much, before a circle is run again.
const FARTHEST: f64 = 1.2;
/// The longest start delay that the drive holds.
const LONGEST_DELAY_S: f64 = 1.0;
/// What pulses cost that make no sense: more than any burst, µm.
const NO_PULSE_UM: f64 = 1.0e6;

fn simplex(corner: Corner) -> Vec<Vec<f64>> {
    let mut simplex = vec![corner.to_vec()];
    for place in 0..corner.len() {
        let mut other = corner.to_vec();
        other[place] += STEPS[place];
        simplex.push(other);
    }
    simplex
}

impl CostFunction for &Probe<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, corner: &Self::Param) -> Result<f64, argmin::core::Error> {
        let corner: Corner = corner
            .as_slice()
            .try_into()
            .map_err(|_| argmin::core::Error::msg("four numbers make a pulse"))?;
        let pulses = self.pulses_at(corner);
        let makes_sense = corner[2].abs() <= FARTHEST
            && pulses.time_constant_s <= SENSIBLE_S.end
            && (0.0..=LONGEST_DELAY_S).contains(&pulses.start_delay_s);
        Ok(if makes_sense {
            left_um(&self.predicted(&pulses))
        } else {
            NO_PULSE_UM
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_S: f64 = 1.0e-3;

    /// A loop of second order with 25 /s and 100 /s: what it makes of a speed added to its
    /// setpoint.
    fn path(speed: impl Fn(usize) -> f64) -> Vec<f64> {
        let (mut fast, mut slow) = (0.0, 0.0);
        (0..400)
            .map(|cycle| {
                fast += 0.1 * (speed(cycle) - fast);
                slow += 1.0e6 * PERIOD_S * fast - 0.025 * slow;
                slow
            })
            .collect()
    }

    fn pulse(height: f64, time_s: f64, delay: usize) -> impl Fn(usize) -> f64 {
        let decay = (-PERIOD_S / time_s).exp();
        move |cycle| match cycle.checked_sub(delay) {
            Some(after) => height * decay.powi(i32::try_from(after).unwrap()),
            None => 0.0,
        }
    }

    fn sum(one: &[f64], other: &[f64]) -> Vec<f64> {
        one.iter().zip(other).map(|(a, b)| a + b).collect()
    }

    /// Bursts that pulses of −1 and −0.8 mm/s, 12 ms and 4 cycles of delay take away.
    fn without() -> Bursts {
        [-1.0e-3, -0.8e-3].map(|height| path(pulse(height, 0.012, 4)))
    }

    #[test]
    fn another_pulse_is_predicted_from_a_circle_with_one() {
        let with = |height, time_s, delay| {
            let moved = path(pulse(height, time_s, delay));
            without().map(|burst| sum(&burst, &moved))
        };
        let probe = Probe {
            without: &without(),
            with: &with(2.0e-3, 0.020, 0),
            pulses: Pulses {
                heights_m_per_s: [2.0e-3; 2],
                time_constant_s: 0.020,
                start_delay_s: 0.0,
            },
            period_s: PERIOD_S,
        };
        let other = Pulses {
            heights_m_per_s: [0.7e-3; 2],
            time_constant_s: 0.008,
            start_delay_s: 0.003,
        };
        let wanted = with(0.7e-3, 0.008, 3);
        for (got, wanted) in probe.predicted(&other).iter().zip(&wanted) {
            for (got, wanted) in got.iter().zip(wanted) {
                assert!((got - wanted).abs() < 1.0e-9, "{got}, wanted {wanted}");
            }
        }
    }

    #[test]
    fn the_best_pulses_take_the_bursts_away() {
        let without = without();
        let moved = path(pulse(1.5e-3, 0.020, 0));
        let with = without.clone().map(|burst| sum(&burst, &moved));
        let pulses = Pulses {
            heights_m_per_s: [1.5e-3; 2],
            time_constant_s: 0.020,
            start_delay_s: 0.0,
        };
        let probe = Probe {
            without: &without,
            with: &with,
            pulses,
            period_s: PERIOD_S,
        };
        let best = probe.best().unwrap();
        let [before, after] = [&without, &probe.predicted(&best)].map(left_um);
        assert!(after < 0.02 * before, "{before} µm, {after} µm: {best:?}");
        let [forward, backward] = best.heights_m_per_s;
        assert!((backward / forward - 0.8).abs() < 0.02, "{best:?}");
    }
}
