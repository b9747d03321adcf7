//! The cascade: position P, velocity PI with feedforward.
//!
//! ```text
//! v_cmd = v_ref + Kv (x_ref − x) + pulse          position loop, motor or load side
//! v_f  += α (v_motor − v_exp − v_f)                 velocity filter
//! e_v   = v_cmd − v_f                               velocity loop, motor side
//! T     = Kp e_v + I + Ja a_ref + friction        I += Ki e_v, unless T is driven beyond the limit
//! ```
//!
//! The motor's velocity is the difference of two encoder positions. With a friction model it is
//! known what it has to be (v_exp, that of the table and of the screw's wind-up): that is taken off
//! before the filter instead of added to the setpoint, so that the filter delays both alike.
//! Anti-windup acts against the torque that is really commanded, after every limit: the integral
//! stands still while the torque is at its limit and the error would push it further.

use fixed::types::{I2F30, I20F12};

use crate::units::{
    Acceleration, AccelerationGain, PositionError, PositionGain, Torque, TorqueLimit, Velocity,
    VelocityGain, lower,
};

/// Gains of the cascade.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CascadeConfig {
    /// Kv times the cycle time.
    pub position_gain: PositionGain,
    /// Kp.
    pub velocity_gain: VelocityGain,
    /// Ki times the cycle time.
    pub integral_gain: VelocityGain,
    /// Ja: inertia for acceleration feedforward.
    pub acceleration_gain: AccelerationGain,
    /// α: share of the new difference in the velocity filter, 0 to 1; 1 switches it off.
    pub velocity_filter: I2F30,
    /// Limit of the commanded torque.
    pub torque_limit: TorqueLimit,
}

/// What the cascade gets in one cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CascadeInput {
    /// Setpoint − measurement.
    pub error: PositionError,
    /// Velocity setpoint with everything that is added to it.
    pub velocity_setpoint: Velocity,
    /// Velocity that the motor is expected to have, where a model tells it; not in the setpoint.
    pub expected_velocity: Velocity,
    /// Acceleration of the setpoint.
    pub acceleration: Acceleration,
    /// Velocity of the motor.
    pub motor_velocity: Velocity,
    /// Torque added from friction feedforward.
    pub friction: Torque,
}

/// Memory of the cascade.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CascadeState {
    integral: Torque,
    velocity: Velocity,
}

impl CascadeState {
    /// At standstill, with the torque that it takes to stay there in the integral.
    #[must_use]
    pub const fn holding(torque: Torque) -> Self {
        Self {
            integral: torque,
            velocity: Velocity::ZERO,
        }
    }

    /// In motion: the velocity filter begins settled.
    #[must_use]
    pub const fn moving(self, velocity: Velocity) -> Self {
        Self {
            integral: self.integral,
            velocity,
        }
    }

    /// The same with a torque more in the integral, which somebody else held until now.
    #[must_use]
    pub fn taking(self, torque: Torque) -> Self {
        Self {
            integral: self.integral.plus(torque),
            ..self
        }
    }

    /// The integral part of the torque.
    #[must_use]
    pub const fn integral(&self) -> Torque {
        self.integral
    }

    /// First half of a cycle: the torque that is wanted.
    #[expect(
        clippy::inline_always,
        reason = "as the law: the plain one has zeros to add, which fall out"
    )]
    #[inline(always)]
    pub fn propose(&mut self, config: &CascadeConfig, input: &CascadeInput) -> Proposal {
        let setpoint = input
            .velocity_setpoint
            .plus(config.position_gain.times(input.error));
        let off = input.motor_velocity.minus(input.expected_velocity);
        self.velocity = filtered(self.velocity, off, config.velocity_filter);
        let error = setpoint.minus(self.velocity);
        let integral = self.integral.with(config.integral_gain.times(error));
        let integral = config.torque_limit.cut(integral);
        let direct = config.velocity_gain.times(error);
        let feedforward = config
            .acceleration_gain
            .times(input.acceleration)
            .with(input.friction);
        Proposal {
            micro_nm: direct.with(integral).with(feedforward).nearest_micro_nm(),
            integral,
            error,
        }
    }

    /// Second half: `commanded_micro_nm` is what is left of it after every limit and filter. Tells
    /// whether a limit cut it.
    pub fn settle(
        &mut self,
        config: &CascadeConfig,
        proposal: &Proposal,
        commanded_micro_nm: i32,
    ) -> bool {
        let limit = config.torque_limit;
        if limit.passes(commanded_micro_nm, proposal.micro_nm) {
            self.integral = proposal.integral;
            return false;
        }
        let (high, low) = limit.stops(commanded_micro_nm, proposal.micro_nm);
        if !(high && proposal.error > Velocity::ZERO || low && proposal.error < Velocity::ZERO) {
            self.integral = proposal.integral;
        }
        high || low
    }
}

/// What the cascade wants, before limits and filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Proposal {
    /// Torque without any limit, in whole µN·m.
    pub micro_nm: i32,
    integral: Torque,
    error: Velocity,
}

fn filtered(before: Velocity, new: Velocity, share: I2F30) -> Velocity {
    // 20.12 times 2.30 bits: 22.42 bits, exact, below 2⁶²; to nearest, as in
    // `PositionGain::times`. A share of a difference fits where that does.
    let step = new.minus(before).0.wide_mul(share).to_bits();
    let half = 1_i64 << 29;
    let step = I20F12::from_bits(lower(step.wrapping_add(half).wrapping_shr(30)));
    before.plus(Velocity(step))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn config() -> CascadeConfig {
        CascadeConfig {
            velocity_gain: VelocityGain(I20F12::from_num(1000)),
            integral_gain: VelocityGain(I20F12::from_num(100)),
            torque_limit: TorqueLimit::from_micro_nm(50_000),
            velocity_filter: I2F30::ONE,
            ..CascadeConfig::default()
        }
    }

    fn input(velocity_setpoint: i32) -> CascadeInput {
        CascadeInput {
            velocity_setpoint: Velocity(I20F12::from_num(velocity_setpoint)),
            ..CascadeInput::default()
        }
    }

    fn step(state: &mut CascadeState, velocity_setpoint: i32) -> (i32, bool) {
        let proposal = state.propose(&config(), &input(velocity_setpoint));
        let commanded = config().torque_limit.cut_micro_nm(proposal.micro_nm);
        (commanded, state.settle(&config(), &proposal, commanded))
    }

    #[test]
    fn the_integral_stands_still_at_the_limit_and_comes_back_at_once() {
        let mut state = CascadeState::default();
        for _ in 0..1000 {
            assert_eq!(step(&mut state, 200), (50_000, true));
        }
        assert_eq!(state.integral(), Torque::ZERO);
        let (torque, limited) = step(&mut state, -10);
        assert!(torque < 0 && !limited, "no stored torque to undo");
    }

    #[test]
    fn below_the_limit_the_integral_takes_over() {
        let mut state = CascadeState::default();
        let torques: Vec<i32> = (0..5).map(|_| step(&mut state, 10).0).collect();
        assert_eq!(torques, [11_000, 12_000, 13_000, 14_000, 15_000]);
    }
}
