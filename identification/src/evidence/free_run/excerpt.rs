//! Some of the blocks that a free run is fitted to, each with what leads into it.
//!
//! A fit takes some hundred simulations, and most of them are far from its end. They run along
//! evenly spread blocks only; the end is found, and everything judged, on all rows. Each block is
//! entered some time before it begins: there the axis starts from where it was recorded.

use std::ops::Range;

use crate::record::samples::Record;
use crate::simulate::drive::Drive;
use crate::simulate::fit::near;
use crate::simulate::model::Simulated;
use crate::simulate::run::{SETTLING_ROWS, error_along};

/// So many blocks at least are enough to come near.
const FEWEST: usize = 4;
/// A block is entered so much earlier, as a part of its length.
const LEAD: usize = 4;

/// Blocks of a record, joined.
pub(super) struct Excerpt {
    record: Record,
    /// Rows that are compared: those of the blocks, not what leads into them.
    compared: Vec<bool>,
}

impl Excerpt {
    /// Of a record whose blocks of so many rows are fitted in turn, the first of two.
    pub(super) fn of(record: &Record, block_rows: usize) -> Self {
        let fitted = (record.len() / block_rows).div_ceil(2);
        let every = 2 * (fitted / FEWEST).max(1);
        let lead = (block_rows / LEAD).max(SETTLING_ROWS).min(block_rows);
        let blocks = (0..record.len().div_ceil(block_rows)).step_by(every);
        let window = |block: usize| {
            let start = block * block_rows;
            start.saturating_sub(lead)..(start + block_rows).min(record.len())
        };
        let windows: Vec<Range<usize>> = blocks.map(window).collect();
        let is_compared = |row: usize| (row / block_rows).is_multiple_of(every);
        Self {
            record: record.windows(&windows),
            compared: windows.into_iter().flatten().map(is_compared).collect(),
        }
    }

    /// A model fitted to them.
    pub(super) fn near(&self, start: &Simulated, drive: &Drive) -> Simulated {
        near(start, drive, &self.record, &|row| self.compared[row])
    }

    /// Rms of the motor position on them.
    pub(super) fn error(&self, model: &Simulated, drive: &Drive) -> f64 {
        error_along(model, drive, &self.record, &|row| self.compared[row])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::made;

    fn of(rows: u32, block_rows: usize) -> Excerpt {
        let positions = (0..rows).map(f64::from).collect();
        Excerpt::of(&made::record(1.0e-3, positions), block_rows)
    }

    #[test]
    fn four_blocks_or_more_are_entered_before_they_begin_and_compared_from_there_on() {
        // Blocks 0, 4, 8 and 12 of fifteen; a quarter of a block leads into each.
        let excerpt = of(30_000, 2000);
        assert_eq!(excerpt.record.joints, [2000, 4500, 7000]);
        assert_eq!(excerpt.record.position[2000], 7500.0);
        assert_eq!(excerpt.record.len(), excerpt.compared.len());
        let compared = |row: usize| excerpt.compared[row];
        assert!(compared(0) && compared(1999) && !compared(2000) && !compared(2499));
        assert!(compared(2500) && compared(9499));
        assert_eq!(of(64_000, 2000).record.joints.len(), 3);
    }

    #[test]
    fn of_a_short_record_every_block_that_is_fitted_is_there() {
        let excerpt = of(6000, 1000);
        assert_eq!(excerpt.record.joints, [1000, 2300]);
        // The simulation settles over 300 rows, however short a block is.
        assert_eq!(excerpt.record.position[1000], 1700.0);
        let tiny = of(700, 100);
        assert_eq!(tiny.record.position[100], 100.0);
    }
}
