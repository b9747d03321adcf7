//! The latency contract of a drive board, without the board.
//!
//! - From the interrupt that takes a frame to the end of what it causes, its torque in a mailbox
//!   included: [`RECEIVE_TO_TORQUE_US`].
//! - From when something is due to the end of it: the same.
//! - Beyond contract, with torque, where nobody may rely on this board any more: [`BEYOND_US`].
//!
//! What is later than the bound is a missed deadline, which is counted and can be read (objects
//! 2203h). What is beyond contract ends the feeding of the watchdog, which resets the board: its
//! torque stops coming, and the plant's own watchdog acts. Without torque nobody relies on it, and
//! being late is counted only.
//!
//! Nothing is late before it was known to be due: a heartbeat that was hidden behind a running
//! cycle, or a deadline that another period puts into the past, is due when the node says so
//! ([`Due`]).

/// From the last frame that is needed to the torque in a mailbox, µs; the same for a wake-up.
pub const RECEIVE_TO_TORQUE_US: u64 = 250;
/// Three periods of 1 kHz, which plant and drive bridge.
pub const BEYOND_US: u64 = 3000;
/// The watchdog's time without being fed, µs.
pub const WATCHDOG_US: u32 = 20_000;
/// The control executor wakes at least so often to feed it, µs.
pub const LONGEST_SLEEP_US: u64 = 2_000;
/// The same while a frame waits for a mailbox, µs: a frame of eight bytes takes 130 at 1 Mbit/s.
pub const LONGEST_WAIT_US: u64 = 200;
/// Transmit elements of the peripheral (RM0440 §44.4.12).
pub const MAILBOXES: u32 = 3;

/// How the contract was kept so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Contract {
    missed: u32,
    latest_us: u32,
    is_broken: bool,
}

impl Contract {
    /// Something was due, or came, at a time, and was done at another, with torque or without.
    pub fn done(&mut self, due_us: u64, now_us: u64, has_torque: bool) {
        let late_us = now_us.saturating_sub(due_us);
        self.latest_us = self
            .latest_us
            .max(u32::try_from(late_us).unwrap_or(u32::MAX));
        self.missed = self
            .missed
            .saturating_add(u32::from(late_us > RECEIVE_TO_TORQUE_US));
        self.is_broken |= has_torque && late_us > BEYOND_US;
    }

    /// Deadlines that were missed.
    #[must_use]
    pub const fn missed(&self) -> u32 {
        self.missed
    }

    /// The latest that anything was, µs.
    #[must_use]
    pub const fn latest_us(&self) -> u32 {
        self.latest_us
    }

    /// Whether the watchdog may be fed.
    #[must_use]
    pub const fn is_kept(&self) -> bool {
        !self.is_broken
    }
}

/// What is due next, and since when that is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Due {
    at_us: Option<u64>,
    known_us: u64,
}

impl Due {
    /// The node says what is due next.
    pub fn says(&mut self, at_us: Option<u64>, now_us: u64) {
        if self.at_us != at_us {
            *self = Self {
                at_us,
                known_us: now_us,
            };
        }
    }

    /// From when on it is late, where it is due now.
    #[must_use]
    pub fn since_us(&self, now_us: u64) -> Option<u64> {
        let at_us = self.at_us.filter(|at_us| *at_us <= now_us)?;
        Some(at_us.max(self.known_us))
    }

    /// When to look again: at what is due, and after so long at the latest.
    #[must_use]
    pub fn until_us(&self, now_us: u64, longest_us: u64) -> u64 {
        let latest_us = now_us.saturating_add(longest_us);
        self.at_us.map_or(latest_us, |at_us| at_us.min(latest_us))
    }
}

/// Whether a frame that is no torque may take a mailbox when so many are taken: one is left to the
/// torque.
#[must_use]
pub const fn has_room_beside_torque(taken: u32) -> bool {
    taken + 1 < MAILBOXES
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_late_is_counted_and_what_is_beyond_contract_is_never_forgiven() {
        let mut contract = Contract::default();
        for (due_us, now_us) in [(1000, 900), (1000, 1000), (1000, 1250)] {
            contract.done(due_us, now_us, true);
        }
        assert_eq!((contract.missed(), contract.latest_us()), (0, 250));
        contract.done(2000, 2251, true);
        contract.done(3000, 6000, true);
        contract.done(3000, 9000, false);
        assert_eq!((contract.missed(), contract.is_kept()), (3, true));
        contract.done(4000, 7001, true);
        contract.done(5000, 5000, true);
        assert_eq!(
            (contract.missed(), contract.latest_us(), contract.is_kept()),
            (4, 6000, false)
        );
        contract.done(0, u64::MAX, true);
        assert_eq!(contract.latest_us(), u32::MAX);
    }

    #[test]
    fn nothing_is_late_before_it_is_known() {
        let mut due = Due::default();
        assert_eq!((due.since_us(0), due.until_us(0, 2000)), (None, 2000));
        due.says(Some(600), 100);
        assert_eq!((due.since_us(599), due.until_us(599, 2000)), (None, 600));
        due.says(Some(600), 700);
        assert_eq!(due.since_us(700), Some(600));
        // A heartbeat that was due long ago comes out of hiding.
        due.says(Some(200), 7000);
        assert_eq!(due.since_us(7003), Some(7000));
    }

    #[test]
    fn other_frames_take_two_mailboxes_at_most() {
        assert!(has_room_beside_torque(0) && has_room_beside_torque(1));
        assert!(!has_room_beside_torque(2) && !has_room_beside_torque(3));
    }
}
