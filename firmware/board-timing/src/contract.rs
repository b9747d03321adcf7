//! The latency contract of a drive board, without the board.
//!
//! | what | bound |
//! |---|---|
//! | from the frame that completes a cycle to its torque in a mailbox | [`RECEIVE_TO_TORQUE_US`] |
//! | the control executor runs after what was due | [`RECEIVE_TO_TORQUE_US`] |
//! | beyond contract: nobody may rely on this board any more | [`BEYOND_US`] |
//!
//! What is later than the bound is a missed deadline, which is counted and can be read (objects
//! 2203h). What is beyond contract ends the feeding of the watchdog, which resets the board: its
//! torque stops coming, and the plant's own watchdog acts.

/// From the last frame that is needed to the torque in a mailbox, µs; the same for a wake-up.
pub const RECEIVE_TO_TORQUE_US: u64 = 250;
/// Three periods of 1 kHz, which plant and drive bridge. A commit of parameters takes one, so that
/// a cycle in which one is made is a missed deadline and no more.
pub const BEYOND_US: u64 = 3000;
/// The watchdog's time without being fed, µs.
pub const WATCHDOG_US: u32 = 20_000;
/// The control executor wakes at least so often to feed it, µs.
pub const LONGEST_SLEEP_US: u64 = 2_000;
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
    /// Something was due, or came, at a time, and was done at another.
    pub fn done(&mut self, due_us: u64, now_us: u64) {
        let late_us = now_us.saturating_sub(due_us);
        self.latest_us = self
            .latest_us
            .max(u32::try_from(late_us).unwrap_or(u32::MAX));
        self.missed = self
            .missed
            .saturating_add(u32::from(late_us > RECEIVE_TO_TORQUE_US));
        self.is_broken |= late_us > BEYOND_US;
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
            contract.done(due_us, now_us);
        }
        assert_eq!((contract.missed(), contract.latest_us()), (0, 250));
        contract.done(2000, 2251);
        contract.done(3000, 6000);
        assert_eq!((contract.missed(), contract.is_kept()), (2, true));
        contract.done(4000, 7001);
        contract.done(5000, 5000);
        assert_eq!(
            (contract.missed(), contract.latest_us(), contract.is_kept()),
            (3, 3001, false)
        );
        contract.done(0, u64::MAX);
        assert_eq!(contract.latest_us(), u32::MAX);
    }

    #[test]
    fn other_frames_take_two_mailboxes_at_most() {
        assert!(has_room_beside_torque(0) && has_room_beside_torque(1));
        assert!(!has_room_beside_torque(2) && !has_room_beside_torque(3));
    }
}
