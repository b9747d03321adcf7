//! What the leaf that runs the node knows and the node does not: objects 2203h to 2205h.

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

/// What a leaf times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Timed {
    /// From the interrupt that takes a frame, or where there is none from when the program has it,
    /// to the end of what it causes, where a torque is among that.
    ReceiveToTorque,
    /// From when the node begins with what closes a cycle to when its torque is ready.
    ControlCycle,
}

/// Durations since they were cleared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Durations {
    count: u32,
    least_ns: u32,
    greatest_ns: u32,
    sum_us: u32,
    rest_ns: u32,
    classes: [u32; Self::CLASSES],
}

impl Durations {
    /// Classes of the histogram: below 1 µs, below 2, 4, 8 … 1024 µs, and what is longer.
    pub const CLASSES: usize = 12;
    /// Numbers of [`Self::in_order`].
    pub const NUMBERS: usize = 4 + Self::CLASSES;

    /// One more.
    pub fn took(&mut self, ns: u32) {
        self.least_ns = match self.count {
            0 => ns,
            _ => self.least_ns.min(ns),
        };
        self.greatest_ns = self.greatest_ns.max(ns);
        self.count = self.count.saturating_add(1);
        let rest_ns = self.rest_ns.saturating_add(ns % 1000);
        let us = ns / 1000;
        self.rest_ns = rest_ns % 1000;
        self.sum_us = self
            .sum_us
            .saturating_add(us)
            .saturating_add(rest_ns / 1000);
        let class = 32_u32.saturating_sub(us.leading_zeros());
        let last = Self::CLASSES.saturating_sub(1);
        let class = usize::try_from(class).unwrap_or(last).min(last);
        if let Some(count) = self.classes.get_mut(class) {
            *count = count.saturating_add(1);
        }
    }

    /// Count, least and greatest in ns, sum in µs, then the classes: subindex 1 and on of their
    /// object.
    #[must_use]
    pub fn in_order(&self) -> [u32; Self::NUMBERS] {
        let mut numbers = [0; Self::NUMBERS];
        let head = [self.count, self.least_ns, self.greatest_ns, self.sum_us];
        let all = head.into_iter().chain(self.classes);
        for (to, from) in numbers.iter_mut().zip(all) {
            *to = from;
        }
        numbers
    }
}

/// What a leaf has timed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LeafTimes {
    /// [`Timed::ReceiveToTorque`].
    pub receive_to_torque: Durations,
    /// [`Timed::ControlCycle`].
    pub control_cycle: Durations,
}

impl LeafTimes {
    /// Those of one kind.
    #[must_use]
    pub const fn of(&self, timed: Timed) -> &Durations {
        match timed {
            Timed::ReceiveToTorque => &self.receive_to_torque,
            Timed::ControlCycle => &self.control_cycle,
        }
    }

    /// The same, to add to or to clear.
    pub const fn of_mut(&mut self, timed: Timed) -> &mut Durations {
        match timed {
            Timed::ReceiveToTorque => &mut self.receive_to_torque,
            Timed::ControlCycle => &mut self.control_cycle,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_are_counted_by_classes_that_double_from_a_microsecond_on() {
        let mut durations = Durations::default();
        for ns in [
            999,
            1000,
            1999,
            2000,
            511_999,
            512_000,
            1_023_999,
            1_024_000,
            u32::MAX,
        ] {
            durations.took(ns);
        }
        let [count, least_ns, greatest_ns, sum_us, classes @ ..] = durations.in_order();
        assert_eq!((count, least_ns, greatest_ns), (9, 999, u32::MAX));
        assert_eq!(classes, [1, 2, 1, 0, 0, 0, 0, 0, 0, 1, 2, 2]);
        let exact: u64 = [
            999, 1000, 1999, 2000, 511_999, 512_000, 1_023_999, 1_024_000,
        ]
        .into_iter()
        .sum::<u64>()
            + u64::from(u32::MAX);
        assert_eq!(u64::from(sum_us), exact / 1000);
        durations.took(5000);
        assert_eq!(durations.in_order()[1], 999);
    }

    #[test]
    fn a_cause_is_its_code_and_back() {
        for cause in StartedBy::ALL {
            assert_eq!(StartedBy::from_code(cause.code()), Some(cause));
        }
        assert_eq!(StartedBy::from_code(7), None);
    }
}
