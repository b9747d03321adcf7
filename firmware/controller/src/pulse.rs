//! The reversal unit: the compensation pulse of the paper.
//!
//! On a change of commanded direction, `Δn · exp(−t / T_comp)` is added to the speed setpoint, in
//! the new direction, after an optional start delay. So that it does no harm it comes at reversals
//! alone that [count](crate::direction::Turns), and ends where the setpoint stops.
//!
//! Source: "Influence of the gap and the friction on trajectory reproduction accuracy in a
//! multiaxis machine with CNC", §4.2. The exponential is a geometric series: one multiplication a
//! cycle by `decay = exp(−T_cycle / T_comp)`, computed on the host.

use fixed::FixedI64;
use fixed::types::extra::U42;
use fixed::types::{I2F30, I20F12};

use crate::direction::Direction;
use crate::units::{PositionError, Velocity};

/// Parameters of the pulse.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PulseConfig {
    /// Δn: height of the pulse; zero switches it off.
    pub amplitude: Velocity,
    /// exp(−T_cycle / T_comp), 0…1.
    pub decay: I2F30,
    /// Cycles from the reversal to the start of the pulse.
    pub start_delay_cycles: u16,
    /// Way the other way after which a reversal counts.
    pub shortest_way: PositionError,
    /// The setpoint has stopped when it has not moved for so many cycles.
    pub stop_cycles: u16,
}

/// What the setpoint does in a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Setpoint {
    /// It goes on.
    Moves,
    /// It has just turned round.
    Turns(Direction),
    /// It has stopped.
    Stopped,
}

/// Where the pulse stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PulseState {
    /// No pulse.
    #[default]
    Idle,
    /// A reversal was seen; so many cycles to go.
    Waiting {
        /// Cycles until the pulse starts.
        cycles: u16,
        /// Its direction.
        direction: Direction,
    },
    /// The pulse decays. What decays is the envelope, 1…0 in 2.30 bits: a decaying height in 20.12
    /// bits would lose an area that the velocity loop integrates.
    Active {
        /// exp(−t / T_comp), never negative.
        envelope: I2F30,
        /// Its direction.
        direction: Direction,
    },
}

impl PulseState {
    /// Advances by one cycle; gives what is added to the speed setpoint.
    pub fn step(&mut self, config: &PulseConfig, setpoint: Setpoint) -> Velocity {
        if config.amplitude == Velocity::ZERO {
            *self = Self::Idle;
            return Velocity::ZERO;
        }
        match setpoint {
            Setpoint::Moves => {}
            Setpoint::Turns(direction) => {
                *self = Self::Waiting {
                    cycles: config.start_delay_cycles,
                    direction,
                };
            }
            Setpoint::Stopped => *self = Self::Idle,
        }
        match *self {
            Self::Idle => Velocity::ZERO,
            Self::Waiting {
                cycles: 0,
                direction,
            } => self.emit(config, I2F30::ONE, direction),
            Self::Waiting { cycles, direction } => {
                *self = Self::Waiting {
                    cycles: cycles.saturating_sub(1),
                    direction,
                };
                Velocity::ZERO
            }
            Self::Active {
                envelope,
                direction,
            } => self.emit(config, envelope, direction),
        }
    }

    fn emit(&mut self, config: &PulseConfig, envelope: I2F30, direction: Direction) -> Velocity {
        // 2.30 times 2.30 bits: 4.60 bits, exact; rounded down, so that it ends.
        let next = I2F30::saturating_from_num(envelope.wide_mul(config.decay));
        let height = Velocity(I20F12::saturating_from_num(
            config.amplitude.0.wide_mul(envelope).saturating_add(HALF),
        ));
        *self = if next == I2F30::ZERO {
            Self::Idle
        } else {
            Self::Active {
                envelope: next,
                direction,
            }
        };
        signed(height, direction)
    }
}

/// Half of the last bit of a velocity, in the 22.42 bits of the product.
const HALF: FixedI64<U42> = FixedI64::from_bits(1 << 29);

fn signed(amplitude: Velocity, direction: Direction) -> Velocity {
    match direction {
        Direction::Positive => amplitude,
        Direction::Negative => amplitude.reversed(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn config(delay: u16) -> PulseConfig {
        // T_comp = 20 cycles.
        let decay = I2F30::from_num((-1.0_f64 / 20.0).exp());
        PulseConfig {
            amplitude: Velocity(I20F12::from_num(100)),
            decay,
            start_delay_cycles: delay,
            shortest_way: PositionError::ZERO,
            stop_cycles: 10,
        }
    }

    const BACK: Setpoint = Setpoint::Turns(Direction::Negative);
    const ON: Setpoint = Setpoint::Turns(Direction::Positive);

    #[test]
    fn the_pulse_is_the_papers_exponential_within_a_thousandth() {
        let mut state = PulseState::default();
        for cycle in 0..100_u32 {
            let setpoint = if cycle == 0 { BACK } else { Setpoint::Moves };
            let got: f64 = state.step(&config(0), setpoint).0.to_num();
            let wanted = -100.0 * (-f64::from(cycle) / 20.0).exp();
            assert!(
                (got - wanted).abs() < 0.005,
                "cycle {cycle}: {got} {wanted}"
            );
        }
    }

    #[test]
    fn the_start_delay_is_counted_in_whole_cycles() {
        let mut state = PulseState::default();
        let heights: Vec<f64> = (0..5)
            .map(|cycle| {
                let setpoint = if cycle == 0 { ON } else { Setpoint::Moves };
                state.step(&config(3), setpoint).0.to_num()
            })
            .collect();
        assert_eq!(&heights[..3], [0.0; 3]);
        assert!((heights[3] - 100.0).abs() < 1e-3);
    }

    #[test]
    fn a_second_reversal_starts_a_new_pulse() {
        let mut state = PulseState::default();
        state.step(&config(0), ON);
        let second: f64 = state.step(&config(0), BACK).0.to_num();
        assert!((second + 100.0).abs() < 1e-3);
    }

    #[test]
    fn the_pulse_ends() {
        let mut state = PulseState::default();
        state.step(&config(0), BACK);
        for _ in 0..4000 {
            state.step(&config(0), Setpoint::Moves);
        }
        assert_eq!(state, PulseState::Idle);
    }

    #[test]
    fn a_pulse_that_is_switched_off_does_not_come_back() {
        let mut state = PulseState::default();
        state.step(&config(0), BACK);
        let off = PulseConfig {
            amplitude: Velocity::ZERO,
            ..config(0)
        };
        assert_eq!(state.step(&off, Setpoint::Moves), Velocity::ZERO);
        assert_eq!(state.step(&config(0), Setpoint::Moves), Velocity::ZERO);
    }

    #[test]
    fn a_stop_ends_the_pulse_and_one_that_waits() {
        for delay in [0, 9] {
            let mut state = PulseState::default();
            state.step(&config(delay), BACK);
            assert_eq!(
                state.step(&config(delay), Setpoint::Stopped),
                Velocity::ZERO
            );
            assert_eq!(state, PulseState::Idle);
        }
    }
}
