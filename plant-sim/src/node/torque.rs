//! Torque commands on their way to the motor, and what became of each cycle's.
//!
//! Torque k comes during cycle k and acts from SYNC k + 1 on, as a synchronous RPDO does. A cycle
//! whose torque does not come is *bridged*: the last one is held. That is what a drive in cyclic
//! synchronous torque does; extrapolating would multiply the noise of the velocity loop by √5 and
//! cost a full correction at every step of it.

/// Cycles in a row that the plant bridges with the last torque.
pub const TORQUE_MISSES_ALLOWED: u16 = 3;

/// What the plant did in the cycles since its start. `cycles` are those that are over; the present
/// one is not counted yet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Cycles that are over: `computed + bridged + refused`.
    pub cycles: u32,
    /// The torque frame of the cycle came.
    pub computed: u32,
    /// No torque frame came.
    pub bridged: u32,
    /// Only torque frames came that were malformed or carried another cycle's counter.
    pub refused: u32,
    /// Cycles (the present one included) that were begun without SYNC: by the own timer, or because
    /// a torque frame showed that they were on.
    pub by_deadline: u32,
}

/// What came in the present cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Came {
    #[default]
    Nothing,
    Refused,
    Torque,
}

/// Torque of the present and of the next cycle.
#[derive(Clone, Copy, Debug, Default)]
pub struct TorqueInput {
    due_n: f64,
    staged_n: Option<f64>,
    came: Came,
    bridged_in_a_row: u16,
    /// What became of each cycle's torque.
    pub counters: Counters,
}

impl TorqueInput {
    /// Force command that acts, N.
    #[must_use]
    pub const fn due_n(&self) -> f64 {
        self.due_n
    }

    /// Cycles in a row that had to do without a torque of their own.
    #[must_use]
    pub const fn bridged_in_a_row(&self) -> u16 {
        self.bridged_in_a_row
    }

    /// A fresh torque frame: its force acts from the next cycle on, if torque acts at all.
    pub fn take(&mut self, force_n: f64, acts: bool) {
        self.came = Came::Torque;
        if acts {
            self.staged_n = Some(force_n);
        } else {
            self.zero();
        }
    }

    /// A torque frame that cannot be used.
    pub fn refuse(&mut self) {
        if self.came == Came::Nothing {
            self.came = Came::Refused;
        }
    }

    /// Torque goes to zero at once.
    pub fn zero(&mut self) {
        self.due_n = 0.0;
        self.staged_n = None;
        self.bridged_in_a_row = 0;
    }

    /// The present cycle is over; tells whether more torques in a row are missing than may be.
    pub fn close(&mut self, acts: bool) -> bool {
        self.count();
        if !acts {
            self.zero();
            return false;
        }
        match self.staged_n.take() {
            Some(force) => (self.due_n, self.bridged_in_a_row) = (force, 0),
            None => self.bridged_in_a_row += 1,
        }
        self.bridged_in_a_row > TORQUE_MISSES_ALLOWED
    }

    fn count(&mut self) {
        let counters = &mut self.counters;
        counters.cycles += 1;
        match std::mem::take(&mut self.came) {
            Came::Torque => counters.computed += 1,
            Came::Refused => counters.refused += 1,
            Came::Nothing => counters.bridged += 1,
        }
    }

    /// Forgets what came in a cycle that is not counted.
    pub fn forget(&mut self) {
        self.came = Came::Nothing;
    }
}
