//! Controllers: sampled laws from setpoint and measured position to an effort.
//!
//! | law | effort |
//! |---|---|
//! | cascade | kv·(e + ki·Σe·T) + M·a_ref, e = kp·(r − x) + v_ref − v |
//! | PID | p·e + i·Σe·T + d·(e' filtered) + M·a_ref, e = r − x |
//! | state feedback | M·(w²(r − x̂) + 2ζw(v_ref − v̂) + a_ref) + d̂ |
//! | velocity | kv·(e + ki·Σe·T), e = v_ref − v |
//! | PI | the forms of [`pi`] |
//! | lead | the compensator of [`lead`] + M·a_ref |
//! | sliding mode | that of [`sliding`] + M·a_ref |
//! | rejecting | PD with the observer of [`rejecting`] + M·a_ref |
//! | feedforward | M·a_ref + viscous·v_ref, with nothing measured |
//! | open | the effort of the programme |
//!
//! x̂, v̂ and d̂ are an observer's: position, velocity and disturbance (Luenberger, IEEE TAC 16,
//! 1971).
//! v is the difference quotient of the measured position, smoothed by v += share·(quotient − v).

pub mod lead;
pub mod pi;
pub mod rejecting;
pub mod sliding;

use crate::control::lead::{Lead, LeadState};
use crate::control::pi::{Lag, Pi, PiState};
use crate::control::rejecting::Rejecting;
use crate::control::sliding::Sliding;
use crate::motion::Setpoint;

/// Damping ratio of state feedback: no overshoot to speak of.
const DAMPING: f64 = 0.9;

/// A law and its gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// P on position over PI on velocity.
    Cascade {
        /// kp, 1/s.
        position_per_s: f64,
        /// kv, effort per velocity.
        velocity: f64,
        /// ki, 1/s.
        integral_per_s: f64,
        /// Whether v_ref is added.
        feedforward: bool,
    },
    /// PID on position.
    Pid {
        /// p, effort per position.
        proportional: f64,
        /// i, effort per position and second.
        integral: f64,
        /// d, effort per velocity.
        derivative: f64,
    },
    /// State feedback with an observer.
    StateFeedback {
        /// Inertia of the model.
        inertia: f64,
        /// w, rad/s.
        bandwidth_rad_s: f64,
        /// Threefold pole of the observer, rad/s.
        observer_rad_s: f64,
    },
    /// PI on velocity.
    Velocity {
        /// kv, effort per velocity.
        velocity: f64,
        /// ki, 1/s.
        integral_per_s: f64,
    },
    /// Cascade with a PI controller in one of its forms.
    Pi(Pi),
    /// Lead compensator.
    Lead(Lead),
    /// Sliding mode.
    Sliding(Sliding),
    /// PD with an observer of the disturbance.
    Rejecting(Rejecting),
    /// Feedforward alone: viscous friction of the model, effort per velocity.
    Feedforward(f64),
    /// No loop.
    Open,
}

/// Gains that change at a time: a switch of operating modes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Switch {
    /// When, s.
    pub at_s: f64,
    /// The law from then on.
    pub law: Law,
}

/// Which position the loop is closed on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sensor {
    /// The motor's.
    Motor,
    /// The load's.
    Load,
}

/// A controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controller {
    /// Its law.
    pub law: Law,
    /// Period, s.
    pub period_s: f64,
    /// Share of the new difference quotient in the velocity.
    pub filter_share: f64,
    /// Inertia of the feedforward; zero where there is none.
    pub feedforward_inertia: f64,
    /// Which position it sees.
    pub sensor: Sensor,
    /// A switch in mid-record.
    pub switch: Option<Switch>,
}

/// State of a controller.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ControllerState {
    last: Option<f64>,
    velocity: f64,
    sum: f64,
    observed: [f64; 3],
    pi: PiState,
    lead: LeadState,
    rejected: f64,
    command: f64,
}

/// What a controller sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Setpoint.
    pub wanted: Setpoint,
    /// Measured position.
    pub position: f64,
    /// Effort of the programme, for an axis without a loop.
    pub programme: f64,
    /// Time, s.
    pub time_s: f64,
}

impl ControllerState {
    /// How far position and velocity lag behind what is wanted.
    fn lag(&self, seen: &Seen) -> Lag {
        Lag {
            position: seen.wanted.position - seen.position,
            velocity: seen.wanted.velocity - self.velocity,
            wanted_velocity: seen.wanted.velocity,
        }
    }
}

impl Controller {
    /// Cascade by its bandwidths, Hz: gains are those of a rigid inertia.
    #[must_use]
    pub fn cascade(inertia: f64, position_hz: f64, velocity_hz: f64, period_s: f64) -> Self {
        let rad = std::f64::consts::TAU;
        Self::of(
            Law::Cascade {
                position_per_s: rad * position_hz,
                velocity: rad * velocity_hz * inertia,
                // A fifth of the bandwidth: 11 degrees of phase.
                integral_per_s: rad * velocity_hz / 5.0,
                feedforward: true,
            },
            inertia,
            period_s,
        )
    }

    /// PID by its bandwidth, Hz: p = M w², d = 2·0.9·M w, i = 0.2·M w³.
    #[must_use]
    pub fn pid(inertia: f64, bandwidth_hz: f64, period_s: f64) -> Self {
        let w = std::f64::consts::TAU * bandwidth_hz;
        let law = Law::Pid {
            proportional: inertia * w * w,
            integral: 0.2 * inertia * w * w * w,
            derivative: 2.0 * DAMPING * inertia * w,
        };
        Self::of(law, inertia, period_s)
    }

    /// State feedback by its bandwidth, Hz; the observer is four times as fast.
    #[must_use]
    pub fn state_feedback(inertia: f64, bandwidth_hz: f64, period_s: f64) -> Self {
        let w = std::f64::consts::TAU * bandwidth_hz;
        let law = Law::StateFeedback {
            inertia,
            bandwidth_rad_s: w,
            observer_rad_s: 4.0 * w,
        };
        Self::of(law, inertia, period_s)
    }

    /// Velocity loop by its bandwidth, Hz.
    #[must_use]
    pub fn velocity(inertia: f64, bandwidth_hz: f64, period_s: f64) -> Self {
        let w = std::f64::consts::TAU * bandwidth_hz;
        let law = Law::Velocity {
            velocity: inertia * w,
            integral_per_s: w / 5.0,
        };
        Self::of(law, 0.0, period_s)
    }

    /// PI in one of its forms, without feedforward.
    #[must_use]
    pub fn pi(pi: Pi, period_s: f64) -> Self {
        Self::of(Law::Pi(pi), 0.0, period_s)
    }

    /// Lead compensator by its crossover, Hz.
    #[must_use]
    pub fn lead(inertia: f64, crossover_hz: f64, period_s: f64) -> Self {
        let law = Law::Lead(Lead::of(inertia, crossover_hz));
        Self::of(law, inertia, period_s)
    }

    /// Sliding mode by its bandwidth, Hz, and the effort that it may add.
    #[must_use]
    pub fn sliding(inertia: f64, bandwidth_hz: f64, reach: f64, period_s: f64) -> Self {
        let law = Law::Sliding(Sliding::of(inertia, bandwidth_hz, reach));
        Self::of(law, inertia, period_s)
    }

    /// PD by its bandwidth, Hz, with an observer of the disturbance.
    #[must_use]
    pub fn rejecting(inertia: f64, bandwidth_hz: f64, period_s: f64) -> Self {
        let law = Law::Rejecting(Rejecting::of(inertia, bandwidth_hz));
        Self::of(law, inertia, period_s)
    }

    /// Feedforward of inertia and viscous friction, and no feedback.
    #[must_use]
    pub fn feedforward(inertia: f64, viscous: f64, period_s: f64) -> Self {
        Self::of(Law::Feedforward(viscous), inertia, period_s)
    }

    /// No loop.
    #[must_use]
    pub fn open(period_s: f64) -> Self {
        Self::of(Law::Open, 0.0, period_s)
    }

    fn of(law: Law, feedforward_inertia: f64, period_s: f64) -> Self {
        Self {
            law,
            period_s,
            filter_share: 0.7,
            feedforward_inertia,
            sensor: Sensor::Motor,
            switch: None,
        }
    }

    /// The effort for the next period.
    pub fn tick(&self, state: &mut ControllerState, seen: &Seen) -> f64 {
        let quotient = (seen.position - state.last.unwrap_or(seen.position)) / self.period_s;
        if state.last.is_none() {
            state.observed = [seen.position, 0.0, 0.0];
        }
        state.last = Some(seen.position);
        state.velocity += self.filter_share * (quotient - state.velocity);
        let switched = self.switch.filter(|switch| seen.time_s >= switch.at_s);
        let law = switched.map_or(self.law, |switch| switch.law);
        let feedforward = self.feedforward_inertia * seen.wanted.acceleration;
        state.command = feedforward + self.feedback(law, state, seen);
        state.command
    }

    fn feedback(&self, law: Law, state: &mut ControllerState, seen: &Seen) -> f64 {
        let error = seen.wanted.position - seen.position;
        match law {
            Law::Open => seen.programme,
            Law::Feedforward(viscous) => viscous * seen.wanted.velocity,
            Law::Pi(pi) => {
                let lag = state.lag(seen);
                pi.effort(&mut state.pi, &lag, self.period_s)
            }
            Law::Lead(lead) => lead.effort(&mut state.lead, error, self.period_s),
            Law::Sliding(sliding) => sliding.effort(&state.lag(seen)),
            Law::Rejecting(rejecting) => {
                let (lag, last) = (state.lag(seen), (state.command, state.velocity));
                rejecting.effort(&mut state.rejected, &lag, last, self.period_s)
            }
            Law::Cascade {
                position_per_s,
                velocity,
                integral_per_s,
                feedforward,
            } => {
                let ahead = if feedforward {
                    seen.wanted.velocity
                } else {
                    0.0
                };
                let lag = position_per_s * error + ahead - state.velocity;
                state.sum += lag * self.period_s;
                velocity * (lag + integral_per_s * state.sum)
            }
            Law::Velocity {
                velocity,
                integral_per_s,
            } => {
                let lag = seen.wanted.velocity - state.velocity;
                state.sum += lag * self.period_s;
                velocity * (lag + integral_per_s * state.sum)
            }
            Law::Pid {
                proportional,
                integral,
                derivative,
            } => {
                state.sum += error * self.period_s;
                let rate = seen.wanted.velocity - state.velocity;
                proportional * error + integral * state.sum + derivative * rate
            }
            Law::StateFeedback {
                inertia,
                bandwidth_rad_s: w,
                observer_rad_s,
            } => {
                self.observe(state, seen.position, inertia, observer_rad_s);
                let [position, velocity, disturbance] = state.observed;
                let stiff = w * w * (seen.wanted.position - position);
                let damped = 2.0 * DAMPING * w * (seen.wanted.velocity - velocity);
                inertia * (stiff + damped) + disturbance
            }
        }
    }

    /// Position, velocity and the effort that is taken by what the model lacks.
    fn observe(&self, state: &mut ControllerState, position: f64, inertia: f64, pole: f64) {
        let [x, v, d] = state.observed;
        let off = position - x;
        let acceleration = (state.command - d) / inertia;
        state.observed = [
            x + self.period_s * (v + 3.0 * pole * off),
            v + self.period_s * (acceleration + 3.0 * pole * pole * off),
            d - self.period_s * inertia * pole * pole * pole * off,
        ];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::pi::Shape;
    use crate::mechanics::train::Train;
    use crate::motion::{Pace, Path};

    /// Largest error of a controller on 3 kg with friction and gravity over a move of 0.2 m.
    fn worst_error(controller: &Controller) -> (f64, f64) {
        let mut train = Train::one(3.0, 5.0, 10.0);
        train
            .fields
            .push((0, crate::mechanics::field::Field::Constant(-20.0)));
        let pace = Pace {
            velocity: 0.3,
            acceleration: 3.0,
        };
        let path = Path::from(0.0).rest(2.0).least_jerk(0.2, pace).rest(2.0);
        let (mut axis, mut state) = (train.at_rest(0.0), ControllerState::default());
        let (mut worst, mut last) = (0.0_f64, 0.0);
        for k in 0..(path.end_s() * 1000.0) as usize {
            let time_s = k as f64 * 1.0e-3;
            let seen = Seen {
                wanted: path.at(time_s),
                position: axis.positions[0],
                programme: 0.0,
                time_s,
            };
            let effort = controller.tick(&mut state, &seen);
            (0..50).for_each(|_| train.step(&mut axis, effort, 2.0e-5));
            last = (seen.wanted.position - seen.position).abs();
            worst = if time_s > 2.0 { worst.max(last) } else { worst };
        }
        (worst, last)
    }

    #[test]
    fn every_position_loop_follows_and_arrives() {
        let loops = [
            Controller::cascade(3.0, 6.0, 40.0, 1.0e-3),
            Controller::pid(3.0, 15.0, 1.0e-3),
            Controller::state_feedback(3.0, 12.0, 1.0e-3),
            Controller::lead(3.0, 16.0, 1.0e-3),
            Controller::rejecting(3.0, 12.0, 1.0e-3),
            Controller::pi(Pi::of(3.0, 6.0, 40.0, Shape::VelocityForm(90.0)), 1.0e-3),
            Controller::pi(Pi::of(3.0, 6.0, 40.0, Shape::BackCalculation(90.0)), 1.0e-3),
        ];
        for controller in loops {
            let (worst, last) = worst_error(&controller);
            assert!(
                worst < 2.0e-3 && last < 2.0e-4,
                "{worst} {last} {controller:?}"
            );
        }
    }

    /// A force of 25 N or 15 N over M λ²: 1.1 mm at 14 Hz, which stays.
    #[test]
    fn a_sliding_mode_stays_off_by_what_pushes_over_its_stiffness() {
        let (worst, last) = worst_error(&Controller::sliding(3.0, 14.0, 300.0, 1.0e-3));
        assert!(
            worst < 1.5e-3 && (5.0e-4..1.3e-3).contains(&last),
            "{worst} {last}"
        );
    }

    #[test]
    fn feedforward_takes_the_setpoint_and_nothing_that_is_measured() {
        let controller = Controller::feedforward(2.0, 5.0, 1.0e-3);
        let effort = |position| {
            let wanted = Setpoint {
                position: 0.0,
                velocity: 3.0,
                acceleration: 4.0,
            };
            let seen = Seen {
                wanted,
                position,
                programme: 0.0,
                time_s: 0.0,
            };
            controller.tick(&mut ControllerState::default(), &seen)
        };
        assert_eq!((effort(0.0), effort(0.7)), (23.0, 23.0));
    }

    #[test]
    fn an_axis_without_a_loop_gets_its_programme() {
        let seen = Seen {
            wanted: Setpoint::default(),
            position: 0.3,
            programme: 7.0,
            time_s: 0.0,
        };
        let mut state = ControllerState::default();
        assert_eq!(Controller::open(1.0e-3).tick(&mut state, &seen), 7.0);
    }

    #[test]
    fn a_switch_changes_the_law_at_its_time() {
        let mut controller = Controller::pid(1.0, 10.0, 1.0e-3);
        controller.switch = Some(Switch {
            at_s: 1.0,
            law: Law::Open,
        });
        let seen = |time_s| Seen {
            wanted: Setpoint::default(),
            position: 0.1,
            programme: 7.0,
            time_s,
        };
        let mut state = ControllerState::default();
        assert!(controller.tick(&mut state, &seen(0.9)) < -100.0);
        assert_eq!(controller.tick(&mut state, &seen(1.0)), 7.0);
    }
}
