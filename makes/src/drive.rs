//! From the commanded effort to the effort at the motor: quantum, dead time, current loop,
//! droop, ripple of the torque constant.
//!
//! The closed current loop is of first order (a zero that cancels the winding) or of second order
//! (Leonhard, Control of Electrical Drives, 2001, ch. 7). Iron that saturates delivers
//! u/(1 + k|u|). A torque constant that depends on the rotor's place delivers
//! u·(1 + share·cos(waves·x + phase)) (Holtz and Springob, IEEE Trans. Ind. Electron. 43, 1996).

use std::collections::VecDeque;
use std::f64::consts::TAU;

/// Closed current loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CurrentLoop {
    /// Follows at once.
    Ideal,
    /// First order with a time constant, s.
    First(f64),
    /// Second order: natural frequency, Hz, and damping ratio.
    Second(f64, f64),
}

impl CurrentLoop {
    /// What it has not yet followed of a step of the command, as a share of it, step by step of a
    /// simulation.
    #[must_use]
    pub fn behind(self, step_s: f64) -> Vec<f64> {
        let drive = Drive {
            current_loop: self,
            ..Drive::default()
        };
        let mut state = DriveState::default();
        let steps = (FOLLOWED_S / step_s) as usize;
        let behind = (0..steps).map(|_| 1.0 - drive.follow(&mut state, 1.0, step_s));
        behind.collect()
    }
}

/// A current loop has followed a step after this time, s.
const FOLLOWED_S: f64 = 0.1;

/// Ripple of the torque constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstantRipple {
    /// Amplitude as a share.
    pub share: f64,
    /// Wave number, rad per unit of position.
    pub waves: f64,
    /// Phase at position zero, rad.
    pub phase: f64,
}

/// What a drive does that no name of the list says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flaw {
    /// Commands below this deliver nothing, larger ones less by it.
    DeadZone(f64),
    /// The delivered effort is larger by a share from a time on, s.
    Stronger(f64, f64),
    /// The delivered effort falls by a share with a time constant, s.
    Fading(f64, f64),
    /// Delivered effort larger by a share in one direction than in the other.
    Lopsided(f64),
    /// The delivered effort swings by a share at a frequency, Hz: a supply that flickers.
    Flicker(f64, f64),
    /// No more than this is delivered, in either direction.
    Limit(f64),
    /// The delivered effort lags the current within a play of so much to either side: a spool that
    /// sticks (Krasnosel'skii and Pokrovskii, Systems with Hysteresis, 1989, ch. 2).
    Play(f64),
    /// The delivered effort falls with velocity: by (v/this)², down to nothing. A supply whose
    /// voltage the motor's own eats up.
    Starved(f64),
    /// The delivered effort is larger by a share about a place: centre, half width at 1/e, share.
    Patch(f64, f64, f64),
    /// The last command stays for so long, s, at the end of every period, s: telegrams are lost.
    Silence(f64, f64),
    /// The current grows and falls by no more than this in a second, N/s or N m/s.
    Ramp(f64),
    /// A battery that sags under load and recovers: the delivered effort falls by a share per
    /// effort, of what has been asked for of late: share, 1/N or 1/(N m), and time constant, s.
    Sag(f64, f64),
}

/// Where and when a drive works.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// Position of the motor.
    pub position: f64,
    /// Its velocity.
    pub velocity: f64,
    /// Time, s.
    pub time_s: f64,
}

/// A drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Step of the command, N or N m; zero where there is none.
    pub quantum: f64,
    /// Time until a command reaches the current loop, s.
    pub dead_time_s: f64,
    /// Current loop.
    pub current_loop: CurrentLoop,
    /// k of u/(1 + k|u|).
    pub droop: f64,
    /// Ripple of the torque constant.
    pub ripple: Option<ConstantRipple>,
    /// Flaw.
    pub flaw: Option<Flaw>,
}

impl Default for Drive {
    fn default() -> Self {
        Self {
            quantum: 0.0,
            dead_time_s: 0.0,
            current_loop: CurrentLoop::First(4.0e-5),
            droop: 0.0,
            ripple: None,
            flaw: None,
        }
    }
}

/// State of a drive.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DriveState {
    waiting: VecDeque<f64>,
    current: f64,
    rate: f64,
    played: f64,
    heard: f64,
    ramped: f64,
    asked: f64,
}

/// What a drive gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Delivered {
    /// Current, as effort by the nominal torque constant: what the drive's own sensor sees.
    pub current: f64,
    /// Effort on the motor.
    pub effort: f64,
}

impl Drive {
    /// One step with a command.
    pub fn step(
        &self,
        state: &mut DriveState,
        command: f64,
        place: Place,
        step_s: f64,
    ) -> Delivered {
        let heard = self.heard(state, rounded(command, self.quantum), place.time_s);
        let due = self.waited(state, heard, step_s);
        let due = self.ramped(state, due, step_s);
        let current = self.follow(state, due, step_s);
        let drooped = current / (1.0 + self.droop * current.abs());
        let ripple = self.ripple.map_or(0.0, |wave| {
            wave.share * libm::cos(wave.waves * place.position + wave.phase)
        });
        let given = drooped * (1.0 + ripple) * self.sagged(state, current, step_s);
        let effort = flawed(self.flaw, given, place, &mut state.played);
        Delivered { current, effort }
    }

    fn heard(&self, state: &mut DriveState, command: f64, time_s: f64) -> f64 {
        let is_silent = matches!(self.flaw, Some(Flaw::Silence(lasts_s, period_s))
            if time_s.rem_euclid(period_s) >= period_s - lasts_s);
        if !is_silent {
            state.heard = command;
        }
        state.heard
    }

    /// Whole steps of an integration for which a command waits.
    #[must_use]
    pub fn dead_steps(&self, step_s: f64) -> usize {
        (self.dead_time_s / step_s).round() as usize
    }

    fn waited(&self, state: &mut DriveState, command: f64, step_s: f64) -> f64 {
        let steps = self.dead_steps(step_s);
        state.waiting.push_back(command);
        if state.waiting.len() > steps {
            state.waiting.pop_front().unwrap_or(command)
        } else {
            0.0
        }
    }

    fn ramped(&self, state: &mut DriveState, due: f64, step_s: f64) -> f64 {
        let Some(Flaw::Ramp(per_s)) = self.flaw else {
            return due;
        };
        let most = per_s * step_s;
        state.ramped += (due - state.ramped).clamp(-most, most);
        state.ramped
    }

    fn sagged(&self, state: &mut DriveState, current: f64, step_s: f64) -> f64 {
        let Some(Flaw::Sag(per_effort, time_constant_s)) = self.flaw else {
            return 1.0;
        };
        let share = 1.0 - libm::exp(-step_s / time_constant_s);
        state.asked += (current.abs() - state.asked) * share;
        (1.0 - per_effort * state.asked).max(0.0)
    }

    fn follow(&self, state: &mut DriveState, due: f64, step_s: f64) -> f64 {
        match self.current_loop {
            CurrentLoop::Ideal => state.current = due,
            CurrentLoop::First(time_constant_s) => {
                state.current +=
                    (due - state.current) * (1.0 - libm::exp(-step_s / time_constant_s));
            }
            CurrentLoop::Second(frequency_hz, damping) => {
                let w = TAU * frequency_hz;
                let bend = w * w * (due - state.current) - 2.0 * damping * w * state.rate;
                state.rate += step_s * bend;
                state.current += step_s * state.rate;
            }
        }
        state.current
    }
}

/// To the nearest step; as it is where there is none.
#[must_use]
pub fn rounded(value: f64, quantum: f64) -> f64 {
    if quantum > 0.0 {
        (value / quantum).round() * quantum
    } else {
        value
    }
}

fn flawed(flaw: Option<Flaw>, effort: f64, place: Place, played: &mut f64) -> f64 {
    let time_s = place.time_s;
    match flaw {
        None | Some(Flaw::Silence(..) | Flaw::Ramp(_) | Flaw::Sag(..)) => effort,
        Some(Flaw::DeadZone(half)) => effort - effort.clamp(-half, half),
        Some(Flaw::Stronger(share, from_s)) if time_s >= from_s => effort * (1.0 + share),
        Some(Flaw::Stronger(..)) => effort,
        Some(Flaw::Fading(share, time_constant_s)) => {
            let warm = 1.0 - libm::exp(-time_s.max(0.0) / time_constant_s);
            effort * (1.0 - share * warm)
        }
        Some(Flaw::Lopsided(share)) => effort + share * effort.abs(),
        Some(Flaw::Flicker(share, frequency_hz)) => {
            effort * (1.0 + share * libm::sin(TAU * frequency_hz * time_s))
        }
        Some(Flaw::Limit(most)) => effort.clamp(-most, most),
        Some(Flaw::Play(half)) => {
            *played = played.clamp(effort - half, effort + half);
            *played
        }
        Some(Flaw::Starved(velocity)) => {
            let ratio = place.velocity / velocity;
            effort * (1.0 - ratio * ratio).max(0.0)
        }
        Some(Flaw::Patch(centre, width, share)) => {
            let s = (place.position - centre) / width;
            effort * (1.0 + share * libm::exp(-s * s))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 1.0e-5;

    fn after(drive: &Drive, command: f64, steps: usize) -> Delivered {
        let mut state = DriveState::default();
        let mut delivered = None;
        for _ in 0..steps {
            delivered = Some(drive.step(&mut state, command, Place::default(), STEP_S));
        }
        delivered.unwrap()
    }

    #[test]
    fn a_loop_of_first_order_has_63_percent_after_its_time_constant() {
        let drive = Drive {
            current_loop: CurrentLoop::First(5.0e-4),
            ..Drive::default()
        };
        assert!((after(&drive, 10.0, 50).current - 6.321).abs() < 1.0e-3);
    }

    #[test]
    fn a_loop_of_second_order_overshoots_by_its_damping_and_settles() {
        let drive = Drive {
            current_loop: CurrentLoop::Second(800.0, 0.5),
            ..Drive::default()
        };
        let most = (1..400)
            .map(|n| after(&drive, 1.0, n).current)
            .fold(0.0, f64::max);
        // exp(−πζ/√(1 − ζ²)) = 16.3 %
        assert!((most - 1.163).abs() < 0.01, "{most}");
        assert!((after(&drive, 1.0, 2000).current - 1.0).abs() < 1.0e-6);
    }

    #[test]
    fn a_command_waits_for_its_dead_time() {
        let drive = Drive {
            dead_time_s: 1.0e-3,
            current_loop: CurrentLoop::Ideal,
            ..Drive::default()
        };
        assert_eq!(after(&drive, 3.0, 100).effort, 0.0);
        assert_eq!(after(&drive, 3.0, 101).effort, 3.0);
    }

    #[test]
    fn the_sensor_of_the_drive_sees_neither_droop_nor_ripple() {
        let drive = Drive {
            current_loop: CurrentLoop::Ideal,
            droop: 0.01,
            ripple: Some(ConstantRipple {
                share: 0.1,
                waves: 1.0,
                phase: 0.0,
            }),
            ..Drive::default()
        };
        let delivered = after(&drive, 100.0, 1);
        assert_eq!(delivered.current, 100.0);
        assert!((delivered.effort - 55.0).abs() < 1.0e-12);
    }

    /// At a time and elsewhere at zero.
    fn at_time(time_s: f64) -> Place {
        Place {
            time_s,
            ..Place::default()
        }
    }

    #[test]
    fn on_a_ramp_of_a_hundred_a_second_a_command_of_ten_takes_a_tenth_of_a_second() {
        let drive = Drive {
            current_loop: CurrentLoop::Ideal,
            flaw: Some(Flaw::Ramp(100.0)),
            ..Drive::default()
        };
        assert!((after(&drive, 10.0, 5_000).effort - 5.0).abs() < 1.0e-9);
        assert!((after(&drive, 10.0, 10_001).effort - 10.0).abs() < 1.0e-9);
    }

    #[test]
    fn a_battery_sags_by_63_percent_of_its_share_after_the_time_constant() {
        let drive = Drive {
            current_loop: CurrentLoop::Ideal,
            flaw: Some(Flaw::Sag(0.003, 0.5)),
            ..Drive::default()
        };
        let effort = |command, steps| after(&drive, command, steps).effort;
        assert!((effort(-100.0, 50_000) + 81.036).abs() < 1.0e-3);
        assert!((effort(100.0, 1_000_000) - 70.0).abs() < 1.0e-6);
    }

    #[test]
    fn while_telegrams_are_lost_the_last_command_stays() {
        let drive = Drive {
            current_loop: CurrentLoop::Ideal,
            flaw: Some(Flaw::Silence(0.1, 1.0)),
            ..Drive::default()
        };
        let mut state = DriveState::default();
        let mut effort = |command, time_s| {
            let delivered = drive.step(&mut state, command, at_time(time_s), STEP_S);
            delivered.effort
        };
        assert_eq!([effort(3.0, 0.8), effort(5.0, 0.95)], [3.0, 3.0]);
        assert_eq!(effort(7.0, 1.05), 7.0);
    }

    #[test]
    fn a_motor_that_fades_has_lost_63_percent_of_its_share_after_the_time_constant() {
        let at = |time_s| {
            flawed(
                Some(Flaw::Fading(0.3, 9.0)),
                100.0,
                at_time(time_s),
                &mut 0.0,
            )
        };
        assert_eq!((at(-1.0), at(0.0)), (100.0, 100.0));
        assert!((at(9.0) - 81.036).abs() < 1.0e-3);
        assert!((at(1.0e3) - 70.0).abs() < 1.0e-9);
    }

    #[test]
    fn a_supply_flickers_by_its_share_and_a_limit_clips() {
        let at = |flaw, time_s| flawed(Some(flaw), 100.0, at_time(time_s), &mut 0.0);
        assert!((at(Flaw::Flicker(0.2, 2.0), 0.125) - 120.0).abs() < 1.0e-9);
        assert_eq!(at(Flaw::Limit(60.0), 0.0), 60.0);
    }

    #[test]
    fn a_spool_with_play_stays_behind_by_half_of_it_on_either_way() {
        let mut played = 0.0;
        let mut at = |effort| flawed(Some(Flaw::Play(10.0)), effort, at_time(0.0), &mut played);
        assert_eq!(
            [5.0, 30.0, 15.0, -30.0].map(&mut at),
            [0.0, 20.0, 20.0, -20.0]
        );
    }

    #[test]
    fn a_starved_motor_has_three_quarters_at_half_of_its_velocity_and_a_patch_its_share() {
        let place = Place {
            position: 0.3,
            velocity: -1.0,
            time_s: 0.0,
        };
        let at = |flaw| flawed(Some(flaw), 100.0, place, &mut 0.0);
        assert!((at(Flaw::Starved(2.0)) - 75.0).abs() < 1.0e-9);
        assert_eq!(at(Flaw::Starved(0.5)), 0.0);
        assert!((at(Flaw::Patch(0.3, 0.1, -0.4)) - 60.0).abs() < 1.0e-9);
        let away = 100.0 - 40.0 / std::f64::consts::E;
        assert!((at(Flaw::Patch(0.2, 0.1, -0.4)) - away).abs() < 1.0e-9);
    }

    #[test]
    fn commands_are_rounded_to_the_quantum() {
        assert!((rounded(0.26, 0.1) - 0.3).abs() < 1e-12 && rounded(0.26, 0.0) == 0.26);
    }
}
