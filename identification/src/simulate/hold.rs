//! Efforts on their way to the axis: held from row to row, and late.
//!
//! A drive gives one effort a row and holds it until the next one. It acts a delay τ later. Over a
//! sub-step from s to s + h after a row, the axis feels the mean of what is held between `s − τ`
//! and `s + h − τ`; a change in between counts by the fraction of the sub-step in which it acts.

/// Efforts of the newest rows.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct HeldEfforts {
    newest_first: Vec<f64>,
    period_s: f64,
    delay_s: f64,
}

/// What a sub-step feels: the efforts of two rows, so many rows back, and the share of the first.
/// It is the same in every row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Felt {
    back: [usize; 2],
    share: f64,
}

impl HeldEfforts {
    /// As if the first effort had been there for ever.
    #[must_use]
    pub(crate) fn new(first: f64, period_s: f64, delay_s: f64) -> Self {
        let rows = (delay_s / period_s).ceil() as usize + 2;
        Self {
            newest_first: vec![first; rows],
            period_s,
            delay_s,
        }
    }

    /// The effort of a new row.
    #[inline]
    pub(crate) fn push(&mut self, effort: f64) {
        let oldest = self.newest_first.len() - 1;
        self.newest_first.copy_within(..oldest, 1);
        self.newest_first[0] = effort;
    }

    /// What is felt over a sub-step of less than a row, given by its middle after the newest row
    /// and its length, s.
    #[must_use]
    pub(crate) fn felt(&self, middle_s: f64, length_s: f64) -> Felt {
        let from = (middle_s - 0.5 * length_s - self.delay_s) / self.period_s;
        let length = length_s / self.period_s;
        let edge = from.floor() + 1.0;
        Felt {
            back: [from, edge].map(|rows| self.back(rows)),
            share: (edge - from).min(length) / length,
        }
    }

    /// Mean of what is felt.
    #[inline]
    #[must_use]
    pub(crate) fn mean(&self, felt: Felt) -> f64 {
        let [before, after] = felt.back.map(|back| self.newest_first[back]);
        felt.share * before + (1.0 - felt.share) * after
    }

    /// Where that stands which is held a number of rows after the newest one (before it: negative).
    fn back(&self, rows: f64) -> usize {
        let back = (-rows.floor()).max(0.0) as usize;
        back.min(self.newest_first.len() - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of 1 s with efforts 0, …, 0, 10, 20, 40; the last is the newest.
    fn held(delay_s: f64) -> HeldEfforts {
        let mut held = HeldEfforts::new(0.0, 1.0, delay_s);
        for effort in [10.0, 20.0, 40.0] {
            held.push(effort);
        }
        held
    }

    fn mean(held: &HeldEfforts, middle_s: f64, length_s: f64) -> f64 {
        held.mean(held.felt(middle_s, length_s))
    }

    #[test]
    fn without_a_delay_the_newest_effort_acts_over_the_whole_row() {
        for middle_s in [0.125, 0.5, 0.875] {
            assert_eq!(mean(&held(0.0), middle_s, 0.25), 40.0);
        }
    }

    #[test]
    fn a_delay_of_whole_rows_gives_the_effort_of_an_earlier_row() {
        for (delay_s, wanted) in [(1.0, 20.0), (2.0, 10.0), (3.0, 0.0)] {
            assert_eq!(mean(&held(delay_s), 0.125, 0.25), wanted, "{delay_s} s");
            assert_eq!(mean(&held(delay_s), 0.875, 0.25), wanted, "{delay_s} s");
        }
    }

    #[test]
    fn a_change_within_the_sub_step_counts_by_its_fraction() {
        // The sub-step from 0.25 to 0.5 s; the change acts at the delay.
        for (delay_s, wanted) in [
            (0.25, 40.0),
            (0.3125, 0.25 * 20.0 + 0.75 * 40.0),
            (0.4375, 0.75 * 20.0 + 0.25 * 40.0),
            (0.5, 20.0),
            (1.3125, 0.25 * 10.0 + 0.75 * 20.0),
        ] {
            let mean = mean(&held(delay_s), 0.375, 0.25);
            assert!((mean - wanted).abs() < 1.0e-12, "{delay_s} s: {mean}");
        }
    }

    #[test]
    fn the_mean_over_a_row_is_that_of_the_sub_steps() {
        let held = held(0.4);
        let sum: f64 = (0..4)
            .map(|step| mean(&held, 0.25 * (f64::from(step) + 0.5), 0.25))
            .sum();
        assert!(
            (0.25 * sum - (0.4 * 20.0 + 0.6 * 40.0)).abs() < 1.0e-12,
            "{sum}"
        );
    }

    #[test]
    fn before_the_record_the_first_effort_was_held() {
        let mut held = HeldEfforts::new(7.0, 1.0, 1.5);
        held.push(8.0);
        assert!((mean(&held, 0.25, 0.5) - 7.0).abs() < 1.0e-12);
        assert!((mean(&held, 0.75, 0.5) - 7.0).abs() < 1.0e-12);
        assert_eq!(
            [-99.0, -0.5, 0.5].map(|rows| held.newest_first[held.back(rows)]),
            [7.0, 7.0, 8.0]
        );
        // As many rows are kept as a delay needs.
        assert_eq!(HeldEfforts::new(0.0, 1.0, 1.5).newest_first.len(), 4);
        assert_eq!(HeldEfforts::new(0.0, 1.0, 2.0).newest_first.len(), 4);
    }
}
