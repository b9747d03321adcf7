//! The reversal unit: the compensation pulse of the paper.
//!
//! On a change of commanded direction, `Δn · exp(−t / T_comp)` is added to the speed setpoint, in
//! the new direction, after an optional start delay. So that it does no harm it comes at reversals
//! alone that [count](crate::direction::Turns), and ends where the setpoint stops. One pulse is
//! good for one acceleration at the reversal; a [`Schedule`] has one for each.
//!
//! Source: "Influence of the gap and the friction on trajectory reproduction accuracy in a
//! multiaxis machine with CNC", §4.2. The exponential is a geometric series: one multiplication a
//! cycle by `decay = exp(−T_cycle / T_comp)`, computed on the host.

mod schedule;

use fixed::FixedI64;
use fixed::types::extra::U42;
use fixed::types::{I2F30, I20F12};

use crate::direction::Direction;
use crate::units::{PositionError, Velocity};
pub use schedule::{MeanAcceleration, POINTS, Point, Schedule};

/// What a pulse looks like.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shape {
    /// Δn: height of the pulse, in the new direction.
    pub amplitude: Velocity,
    /// exp(−T_cycle / T_comp), 0…1.
    pub decay: I2F30,
    /// Cycles from the reversal to the start of the pulse.
    pub start_delay_cycles: u16,
}

/// Parameters of the pulse.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PulseConfig {
    /// The pulse of every reversal; without height there is none.
    pub shape: Shape,
    /// Pulses over the acceleration, instead of that one.
    pub schedule: Option<Schedule>,
    /// Way the other way after which a reversal counts.
    pub shortest_way: PositionError,
    /// The setpoint has stopped when it has not moved for so many cycles.
    pub stop_cycles: u16,
}

impl PulseConfig {
    /// Whether any reversal has a pulse.
    #[must_use]
    pub fn is_off(&self) -> bool {
        self.schedule.is_none() && self.shape.amplitude == Velocity::ZERO
    }
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

/// Memory of the pulse.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PulseState {
    mean: MeanAcceleration,
    stage: Stage,
    has_rested: bool,
}

/// Where the pulse stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Stage {
    /// No pulse.
    #[default]
    Idle,
    /// A reversal was seen; so many cycles to go.
    Waiting { cycles: u16, pulse: Pulse },
    /// The pulse decays. What decays is the envelope, 1…0 in 2.30 bits: a decaying height in 20.12
    /// bits would lose an area that the velocity loop integrates.
    Active { envelope: I2F30, pulse: Pulse },
}

/// The pulse of one reversal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Pulse {
    amplitude: Velocity,
    decay: I2F30,
    direction: Direction,
}

impl PulseState {
    /// Advances by one cycle; gives what is added to the speed setpoint. `change` is that of the
    /// commanded velocity to the next cycle, where a setpoint tells it.
    ///
    /// Out of rest the acceleration is not known yet: a schedule has no pulse there.
    pub fn step(
        &mut self,
        config: &PulseConfig,
        setpoint: Setpoint,
        change: Option<Velocity>,
    ) -> Velocity {
        if config.is_off() {
            *self = Self::default();
            return Velocity::ZERO;
        }
        if let (Some(schedule), Some(change)) = (&config.schedule, change) {
            self.mean.take(schedule, change);
        }
        let has_rested = core::mem::replace(&mut self.has_rested, setpoint == Setpoint::Stopped);
        match setpoint {
            Setpoint::Moves => {}
            Setpoint::Turns(_) if has_rested && config.schedule.is_some() => {
                self.stage = Stage::Idle;
            }
            Setpoint::Turns(direction) => self.stage = self.begun(config, direction),
            Setpoint::Stopped => self.stage = Stage::Idle,
        }
        match self.stage {
            Stage::Idle => Velocity::ZERO,
            Stage::Waiting { cycles: 0, pulse } => self.emit(I2F30::ONE, pulse),
            Stage::Waiting { cycles, pulse } => {
                let cycles = cycles.saturating_sub(1);
                self.stage = Stage::Waiting { cycles, pulse };
                Velocity::ZERO
            }
            Stage::Active { envelope, pulse } => self.emit(envelope, pulse),
        }
    }

    fn begun(&self, config: &PulseConfig, direction: Direction) -> Stage {
        let shape = match &config.schedule {
            Some(schedule) => schedule.shape(self.mean, direction),
            None => config.shape,
        };
        Stage::Waiting {
            cycles: shape.start_delay_cycles,
            pulse: Pulse {
                amplitude: shape.amplitude,
                decay: shape.decay,
                direction,
            },
        }
    }

    fn emit(&mut self, envelope: I2F30, pulse: Pulse) -> Velocity {
        // 2.30 times 2.30 bits: 4.60 bits, exact; rounded down, so that it ends.
        let next = I2F30::saturating_from_num(envelope.wide_mul(pulse.decay));
        self.stage = if next == I2F30::ZERO {
            Stage::Idle
        } else {
            Stage::Active {
                envelope: next,
                pulse,
            }
        };
        let height = Velocity(I20F12::saturating_from_num(
            pulse.amplitude.0.wide_mul(envelope).saturating_add(HALF),
        ));
        signed(height, pulse.direction)
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
        let shape = Shape {
            amplitude: Velocity(I20F12::from_num(100)),
            decay,
            start_delay_cycles: delay,
        };
        PulseConfig {
            shape,
            schedule: None,
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
            let got: f64 = state.step(&config(0), setpoint, None).0.to_num();
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
                state.step(&config(3), setpoint, None).0.to_num()
            })
            .collect();
        assert_eq!(&heights[..3], [0.0; 3]);
        assert!((heights[3] - 100.0).abs() < 1e-3);
    }

    #[test]
    fn a_second_reversal_starts_a_new_pulse() {
        let mut state = PulseState::default();
        state.step(&config(0), ON, None);
        let second: f64 = state.step(&config(0), BACK, None).0.to_num();
        assert!((second + 100.0).abs() < 1e-3);
    }

    #[test]
    fn the_pulse_ends() {
        let mut state = PulseState::default();
        state.step(&config(0), BACK, None);
        for _ in 0..4000 {
            state.step(&config(0), Setpoint::Moves, None);
        }
        assert_eq!(state.stage, Stage::Idle);
    }

    #[test]
    fn a_pulse_that_is_switched_off_does_not_come_back() {
        let mut state = PulseState::default();
        state.step(&config(0), BACK, None);
        let off = PulseConfig {
            shape: Shape::default(),
            ..config(0)
        };
        assert_eq!(state.step(&off, Setpoint::Moves, None), Velocity::ZERO);
        assert_eq!(
            state.step(&config(0), Setpoint::Moves, None),
            Velocity::ZERO
        );
    }

    #[test]
    fn a_stop_ends_the_pulse_and_one_that_waits() {
        for delay in [0, 9] {
            let mut state = PulseState::default();
            state.step(&config(delay), BACK, None);
            assert_eq!(
                state.step(&config(delay), Setpoint::Stopped, None),
                Velocity::ZERO
            );
            assert_eq!(state.stage, Stage::Idle);
        }
    }

    #[test]
    fn a_schedule_has_no_pulse_out_of_rest() {
        let point = Point {
            forward: Velocity(I20F12::from_num(100)),
            backward: Velocity(I20F12::from_num(100)),
            decay: I2F30::from_bits(1 << 29),
            start_delay_cycles: 0,
        };
        let config = PulseConfig {
            schedule: Schedule::new(1 << 32, 0, [point; POINTS]),
            ..config(0)
        };
        let change = Some(Velocity(I20F12::from_num(16)));
        let pulse = |before: Setpoint| {
            let mut state = PulseState::default();
            state.step(&config, before, change);
            let first: f64 = state.step(&config, BACK, change).0.to_num();
            first
        };
        assert!((pulse(Setpoint::Moves) + 100.0).abs() < 1.0e-3);
        assert_eq!(pulse(Setpoint::Stopped), 0.0);
    }
}
