//! A spring-applied brake on the motor shaft: it holds without current and lets go under current.
//!
//! ```text
//! told to open   ──▶ full strength for open_s, then none             (t2, disengagement)
//! told to close  ──▶ none for close_s − rise_s, then linear to full  (t11, then t12; sum t1)
//! ```
//!
//! The times are those of a data sheet: t2 disengagement, t11 response delay, t12 rise, t1
//! engagement.
//!
//! While it holds it is dry friction: it takes any force up to its rated one and lets the shaft
//! stand exactly still; above that it slips against the rated force. [`crate::mechanics`] solves
//! for that together with the screw, so a held shaft does not chatter and a slipping one never
//! reverses. All forces are at the table, in newtons.
//!
//! `rise_s` is zero unless a data sheet says it: the brake then bites late and at once, which is
//! the longest way that its times allow.

use crate::ranges::ranged;
use protocol::states::BrakeState;

/// Time to open where the machine file names none: the brake of the vertical reference axis.
const OPEN_S: f64 = 0.030;
/// Time to close where the machine file names none.
const CLOSE_S: f64 = 0.040;

ranged! {
    /// Data sheet of a brake. No brake takes a second.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct BrakeParameters {
        /// Force at the table above which it slips.
        pub rated_force_n: f64 [1.0e-3 => 1.0e6],
        /// From the command to open until it lets go.
        #[serde(default = "open_s")]
        pub open_s: f64 [0.0 => 1.0],
        /// From the command to close until it holds with its rated force.
        #[serde(default = "close_s")]
        pub close_s: f64 [0.0 => 1.0],
        /// The last part of `close_s`, in which the force rises linearly.
        #[serde(default)]
        pub rise_s: f64 [0.0 => 1.0],
    }
}

fn open_s() -> f64 {
    OPEN_S
}

fn close_s() -> f64 {
    CLOSE_S
}

/// A brake in use; closed when it is switched on.
#[derive(Clone, Copy, Debug)]
pub struct Brake {
    parameters: BrakeParameters,
    released: bool,
    /// Share of the rated force, 0…1.
    strength: f64,
    /// Time until it has done what it was told; 0 where it has.
    left_s: f64,
}

impl Brake {
    /// A closed brake.
    #[must_use]
    pub const fn new(parameters: BrakeParameters) -> Self {
        Self {
            parameters,
            released: false,
            strength: 1.0,
            left_s: 0.0,
        }
    }

    /// Tells it to open (`release`) or to close. A command that comes before the armature has left
    /// its place costs no time.
    pub fn command(&mut self, release: bool) {
        if release == self.released {
            return;
        }
        self.released = release;
        let target = if release { 0.0 } else { 1.0 };
        let time_s = if release {
            self.parameters.open_s
        } else {
            self.parameters.close_s
        };
        self.left_s = if self.strength == target { 0.0 } else { time_s };
        if self.left_s == 0.0 {
            self.strength = target;
        }
    }

    /// Where it stands.
    #[must_use]
    pub const fn state(&self) -> BrakeState {
        match (self.left_s > 0.0, self.released) {
            (true, _) => BrakeState::Moving,
            (false, true) => BrakeState::Open,
            (false, false) => BrakeState::Closed,
        }
    }

    /// Force up to which it holds at present, N.
    #[must_use]
    pub fn capacity_n(&self) -> f64 {
        self.strength * self.parameters.rated_force_n
    }

    /// Force up to which it holds in the coming sub-step, N; lets the sub-step pass.
    pub fn pass(&mut self, dt_s: f64) -> f64 {
        let capacity = self.capacity_n();
        if self.left_s > 0.0 {
            self.move_on(dt_s);
        }
        capacity
    }

    fn move_on(&mut self, dt_s: f64) {
        self.left_s -= dt_s;
        // Half a sub-step: a sum of sub-steps misses a time by rounding.
        if self.left_s < 0.5 * dt_s {
            self.left_s = 0.0;
            self.strength = if self.released { 0.0 } else { 1.0 };
        } else if !self.released && self.left_s < self.parameters.rise_s {
            self.strength = self
                .strength
                .max(1.0 - self.left_s / self.parameters.rise_s);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT_S: f64 = 1.0e-3 / 16.0;

    fn brake(open_s: f64, close_s: f64, rise_s: f64) -> Brake {
        Brake::new(BrakeParameters {
            rated_force_n: 4000.0,
            open_s,
            close_s,
            rise_s,
        })
    }

    /// Sub-steps until the brake stands in a state, with the capacity in each.
    fn until(brake: &mut Brake, state: BrakeState) -> Vec<f64> {
        let mut capacities = Vec::new();
        while brake.state() != state && capacities.len() < 10_000 {
            capacities.push(brake.pass(DT_S));
        }
        capacities
    }

    #[test]
    fn it_holds_until_it_is_open_and_hangs_loose_until_it_has_closed() {
        let mut brake = brake(0.030, 0.040, 0.0);
        brake.command(true);
        let opening = until(&mut brake, BrakeState::Open);
        assert_eq!(
            (opening.len(), opening.iter().all(|n| *n == 4000.0)),
            (480, true),
            "30 ms at full strength"
        );
        brake.command(false);
        let closing = until(&mut brake, BrakeState::Closed);
        assert_eq!(
            (closing.len(), closing.iter().all(|n| *n == 0.0)),
            (640, true),
            "40 ms without any"
        );
        assert_eq!(brake.capacity_n(), 4000.0);
    }

    #[test]
    fn where_the_data_sheet_has_a_rise_time_the_force_rises_linearly_in_the_end() {
        let mut brake = brake(0.0, 0.040, 0.010);
        brake.command(true);
        brake.command(false);
        let closing = until(&mut brake, BrakeState::Closed);
        assert!(
            closing[480] < 1.0e-6,
            "30 ms response delay: {} N",
            closing[480]
        );
        assert!(
            (closing[560] - 2000.0).abs() < 1.0,
            "half of the force after 35 ms: {} N",
            closing[560]
        );
        assert!(closing.is_sorted());
    }

    #[test]
    fn a_brake_without_delay_acts_in_the_sub_step_of_the_command() {
        let mut brake = brake(0.0, 0.0, 0.0);
        brake.command(true);
        assert_eq!((brake.state(), brake.capacity_n()), (BrakeState::Open, 0.0));
        brake.command(false);
        assert_eq!(
            (brake.state(), brake.capacity_n()),
            (BrakeState::Closed, 4000.0)
        );
    }

    #[test]
    fn a_command_taken_back_in_time_leaves_it_where_it_was() {
        let mut brake = brake(0.030, 0.040, 0.0);
        brake.command(true);
        brake.pass(DT_S);
        brake.command(false);
        assert_eq!(
            (brake.state(), brake.capacity_n()),
            (BrakeState::Closed, 4000.0)
        );
    }
}
