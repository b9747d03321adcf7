//! What the leaf that runs the node knows and the node does not: objects 2203h.

/// Why the node started.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum StartedBy {
    /// Power came, or a program began.
    #[default]
    Power = 0,
    /// The reset pin, or a debugger.
    Pin = 1,
    /// Software asked for it.
    Software = 2,
    /// The watchdog: the control executor missed a deadline beyond its contract, or hung.
    Watchdog = 3,
    /// A panic.
    Panic = 4,
    /// A fault of the processor.
    HardFault = 5,
    /// The supply fell below its limit.
    LowVoltage = 6,
}

impl StartedBy {
    /// All of them; the place of each is its code.
    pub const ALL: [Self; 7] = [
        Self::Power,
        Self::Pin,
        Self::Software,
        Self::Watchdog,
        Self::Panic,
        Self::HardFault,
        Self::LowVoltage,
    ];

    /// The code of the object.
    #[must_use]
    #[expect(clippy::as_conversions, reason = "the discriminant")]
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The cause of a code.
    #[must_use]
    pub fn from_code(code: u8) -> Option<Self> {
        Self::ALL.get(usize::from(code)).copied()
    }
}

/// What a leaf reports.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LeafReport {
    /// Why it started.
    pub started_by: StartedBy,
    /// Deadlines that it missed since.
    pub missed_deadlines: u32,
    /// The latest that it was, µs.
    pub latest_us: u32,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cause_is_its_code_and_back() {
        for cause in StartedBy::ALL {
            assert_eq!(StartedBy::from_code(cause.code()), Some(cause));
        }
        assert_eq!(StartedBy::from_code(7), None);
    }
}
