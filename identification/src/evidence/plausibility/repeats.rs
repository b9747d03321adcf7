//! Rows that stand in a file twice: position and effort equal to the last digit over a stretch.
//!
//! Noise of a measurement never comes again. So even a fifth of a second of motion that does is a
//! copy, whatever motion it is.

use std::collections::HashMap;

use crate::record::samples::Record;

/// Rows in a row that make a place.
const PLACE_ROWS: usize = 3;
/// Shortest stretch that is a copy, rows.
const FEWEST_ROWS: usize = 100;
/// And s.
const SHORTEST_S: f64 = 0.2;

/// The first stretch that stands twice, in words.
pub(crate) fn copy(record: &Record) -> Option<String> {
    let wanted = FEWEST_ROWS.max((SHORTEST_S / record.period_s) as usize);
    let mut places: HashMap<[u64; 2 * PLACE_ROWS], usize> = HashMap::new();
    let (mut length, mut offset) = (0, 0);
    for row in 0..record.len().saturating_sub(PLACE_ROWS) {
        let Some(place) = place(record, row) else {
            continue;
        };
        let first = *places.entry(place).or_insert(row);
        let apart = row - first;
        length = if apart > 0 && apart == offset {
            length + 1
        } else {
            0
        };
        offset = apart;
        if length >= wanted {
            // The header is line 1.
            return Some(format!(
                "lines {} to {} stand in it twice, again from line {} on, to the last digit of position and effort; is it one run several times, end to end?",
                first + 2 - length,
                first + 2,
                row + 2 - length
            ));
        }
    }
    None
}

/// What stands in some rows, if anything changes in them.
fn place(record: &Record, row: usize) -> Option<[u64; 2 * PLACE_ROWS]> {
    let mut place = [0; 2 * PLACE_ROWS];
    let rows = row..row + PLACE_ROWS;
    let (positions, efforts) = (&record.position[rows.clone()], &record.effort[rows]);
    let changes = positions.windows(2).all(|pair| pair[0] != pair[1]);
    let values = positions.iter().chain(efforts);
    for (bits, value) in place.iter_mut().zip(values) {
        *bits = value.to_bits();
    }
    changes.then_some(place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::made;

    /// A motion with noise on its effort.
    fn record() -> Record {
        let mut record = made::record(1.0e-3, made::two_sines(3000));
        let noise = |row: usize| (0.37 * (row * row % 1009) as f64).sin();
        record.effort = (0..3000)
            .map(|row| 3.0 * noise(row) + 0.01 * row as f64)
            .collect();
        record
    }

    #[test]
    fn a_copy_of_a_fifth_of_a_second_is_found_and_a_shorter_one_is_not() {
        assert_eq!(copy(&record()), None);
        let with_copy = |rows: usize| record().windows(&[0..1500, 1000..1000 + rows, 1500..3000]);
        assert_eq!(copy(&with_copy(190)), None);
        let said = copy(&with_copy(300)).unwrap();
        assert!(
            said.starts_with("lines 1002 to 1202 stand in it twice, again from line 1502"),
            "{said}"
        );
    }

    #[test]
    fn rest_is_no_copy() {
        let mut still = record();
        still.position.fill(1.0);
        still.effort.fill(2.0);
        assert_eq!(copy(&still), None);
    }
}
