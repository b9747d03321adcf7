//! The time that a controlled stop may take. Its ramp is the reference stage's.

/// Cycles that are left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stop {
    cycles_left: u16,
}

impl Stop {
    /// Takes at most `cycles`.
    #[must_use]
    pub const fn within(cycles: u16) -> Self {
        Self { cycles_left: cycles }
    }

    /// Counts a cycle; whether the time is over.
    pub fn is_over(&mut self) -> bool {
        self.cycles_left = self.cycles_left.saturating_sub(1);
        self.cycles_left == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stop_is_over_after_its_cycles() {
        let mut stop = Stop::within(3);
        assert_eq!([stop.is_over(), stop.is_over(), stop.is_over()], [false, false, true]);
    }
}
