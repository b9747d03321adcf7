//! Setpoints of a record, and when a drive takes its acceleration from them.
//!
//! The setpoint velocity of a row is the backward difference `v_n = (r_n − r_{n−1})/T`. The second
//! difference about a row is `a_n = (v_{n+1} − v_n)/T`. Drives mean different times by "the
//! acceleration of row n" (T is the period of the record):
//!
//! | timing   | acceleration          | meant time          |
//! |----------|-----------------------|---------------------|
//! | central  | (a_n + a_{n−1})/2     | half a row back     |
//! | backward | a_{n−1}               | a row back          |
//! | ahead    | a_n + 1.5 (a_n − a_{n−1}) | 1.5 rows ahead  |

use crate::record::samples::Record;

/// When a drive takes the acceleration of its feedforward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Timing {
    /// Central difference of the velocity, half a row back.
    Central,
    /// Second difference of the newest three setpoints: a drive without preview.
    Backward,
    /// Second difference about the row and 1.5 times its change: a drive that has the next setpoint
    /// and looks to the middle of the cycle in which its effort acts.
    Ahead,
}

/// Every timing, the usual one first.
pub(crate) const TIMINGS: [Timing; 3] = [Timing::Central, Timing::Backward, Timing::Ahead];

/// From the newest second difference to the middle of the cycle in which the effort acts, rows: one
/// of preview, half of the hold.
const ROWS_AHEAD: f64 = 1.5;

/// Setpoints of a record.
#[derive(Clone, Copy)]
pub(crate) struct Setpoints<'a> {
    positions: &'a [f64],
    period_s: f64,
}

impl<'a> Setpoints<'a> {
    /// The setpoints of a record; none where it has none.
    #[inline]
    #[must_use]
    pub(crate) fn of(record: &'a Record) -> Self {
        Self {
            positions: record.reference.as_deref().unwrap_or(&[]),
            period_s: record.period_s,
        }
    }

    /// Period of the rows, s.
    #[inline]
    #[must_use]
    pub(crate) const fn period_s(&self) -> f64 {
        self.period_s
    }

    /// Position; the last one holds beyond the end.
    #[inline]
    #[must_use]
    pub(crate) fn position(&self, row: usize) -> f64 {
        let held = self.positions.get(row).or(self.positions.last());
        held.copied().unwrap_or(0.0)
    }

    /// Velocity; beyond both ends the setpoint goes on as it was.
    #[inline]
    #[must_use]
    pub(crate) fn velocity(&self, row: usize) -> f64 {
        let last = self.positions.len().saturating_sub(1).max(1);
        let row = row.clamp(1, last);
        (self.position(row) - self.position(row - 1)) / self.period_s
    }

    /// Second difference about a row.
    #[inline]
    fn second_difference(&self, row: usize) -> f64 {
        (self.velocity(row + 1) - self.velocity(row)) / self.period_s
    }

    /// Acceleration that a drive of a timing takes in a row.
    #[inline]
    #[must_use]
    pub(crate) fn acceleration(&self, timing: Timing, row: usize) -> f64 {
        let now = self.second_difference(row);
        let before = self.second_difference(row.saturating_sub(1));
        match timing {
            Timing::Central => 0.5 * (now + before),
            Timing::Backward => before,
            Timing::Ahead => now + ROWS_AHEAD * (now - before),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of 0.5 s. Velocities 2, 6, 14, 26; second differences 8, 16, 24 about rows 1, 2, 3.
    const SETPOINTS: Setpoints<'static> = Setpoints {
        positions: &[0.0, 1.0, 4.0, 11.0, 24.0],
        period_s: 0.5,
    };

    #[test]
    fn beyond_both_ends_the_position_holds_and_the_velocity_goes_on() {
        assert_eq!(
            [0, 4, 9].map(|row| SETPOINTS.position(row)),
            [0.0, 24.0, 24.0]
        );
        assert_eq!(
            [0, 1, 2, 4, 9].map(|row| SETPOINTS.velocity(row)),
            [2.0, 2.0, 6.0, 26.0, 26.0]
        );
    }

    #[test]
    fn each_timing_weighs_the_two_newest_second_differences() {
        for (timing, wanted) in [
            (Timing::Central, 20.0),
            (Timing::Backward, 16.0),
            (Timing::Ahead, 24.0 + 1.5 * 8.0),
        ] {
            assert_eq!(SETPOINTS.acceleration(timing, 3), wanted, "{timing:?}");
        }
    }

    #[test]
    fn at_the_ends_there_is_no_acceleration_beyond_the_setpoints() {
        assert_eq!(SETPOINTS.acceleration(Timing::Central, 0), 0.0);
        assert_eq!(SETPOINTS.acceleration(Timing::Backward, 1), 0.0);
        assert_eq!(SETPOINTS.acceleration(Timing::Backward, 5), 0.0);
    }

    #[test]
    fn without_setpoints_everything_is_zero() {
        let none = Setpoints {
            positions: &[],
            period_s: 0.5,
        };
        assert_eq!((none.position(3), none.velocity(3)), (0.0, 0.0));
    }
}
