//! What a drive's leaf has timed of itself: objects 2204h and 2205h.

use protocol::leaf::Durations;
use protocol::sdo::{Address, Expedited};
use serde::Serialize;
use servo::objects::{CONTROL_CYCLE_INDEX, RECEIVE_TO_TORQUE_INDEX};

use crate::error::Outcome;
use crate::network::link::Link;
use crate::network::master::Master;

/// Durations of one kind, µs.
#[derive(Clone, Debug, Serialize, PartialEq)]
pub struct DriveTimes {
    /// What was timed.
    pub of: &'static str,
    /// So many.
    pub count: u32,
    /// Least.
    pub min_us: f64,
    /// Mean.
    pub mean_us: f64,
    /// Largest.
    pub max_us: f64,
    /// Upper end of each class, µs, and how many are in it; the last class has no end. Classes
    /// without any are left out beyond either end.
    pub histogram: Vec<(Option<f64>, u32)>,
}

/// What is timed, with its index.
const TIMED: [(u16, &str); 2] = [
    (RECEIVE_TO_TORQUE_INDEX, "frame received to torque sent"),
    (CONTROL_CYCLE_INDEX, "control cycle"),
];

/// Their last subindex.
const LAST: u8 = Durations::NUMBERS as u8;

/// Lets a drive begin anew.
///
/// # Errors
/// Where it does not answer.
pub fn clear<L: Link>(master: &mut Master<L>, axis: usize) -> Outcome<()> {
    TIMED
        .into_iter()
        .try_for_each(|(index, _)| master.download(axis, Address::new(index, 1), Expedited::u32(0)))
}

/// What a drive has timed since; nothing where nobody times it, as in the workbench's own process.
///
/// # Errors
/// Where it does not answer.
pub fn read<L: Link>(master: &mut Master<L>, axis: usize) -> Outcome<Vec<DriveTimes>> {
    let mut list = Vec::new();
    for (index, of) in TIMED {
        let mut numbers = [0; Durations::NUMBERS];
        // Cycles go on meanwhile: the sum next to the count that it is of.
        for subindex in [1, 4, 2, 3].into_iter().chain(5..=LAST) {
            let value = master.upload(axis, Address::new(index, subindex))?;
            numbers[usize::from(subindex) - 1] = value.to_u32();
        }
        list.extend(DriveTimes::of(of, &numbers));
    }
    Ok(list)
}

impl DriveTimes {
    /// From the numbers of the objects, subindex 1 and on.
    fn of(of: &'static str, numbers: &[u32; Durations::NUMBERS]) -> Option<Self> {
        let [count, least_ns, greatest_ns, sum_us, classes @ ..] = numbers;
        let ends_us = (0..).map(|class| f64::from(1_u32 << class));
        let ends_us = ends_us.take(classes.len() - 1).map(Some).chain([None]);
        let all: Vec<(Option<f64>, u32)> = ends_us.zip(classes.iter().copied()).collect();
        let is_some = |(_, count): &(Option<f64>, u32)| *count > 0;
        if *count == 0 {
            return None;
        }
        let first = all.iter().position(is_some)?;
        let last = all.iter().rposition(is_some)?;
        Some(Self {
            of,
            count: *count,
            min_us: 1.0e-3 * f64::from(*least_ns),
            mean_us: f64::from(*sum_us) / f64::from(*count),
            max_us: 1.0e-3 * f64::from(*greatest_ns),
            histogram: all[first..=last].to_vec(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_numbers_of_a_drive_become_durations_and_their_classes_without_empty_ends() {
        let mut durations = Durations::default();
        assert_eq!(DriveTimes::of("nothing", &durations.in_order()), None);
        for ns in [3000, 5000, 5000, 17_000] {
            durations.took(ns);
        }
        let times = DriveTimes::of("some", &durations.in_order()).unwrap();
        assert_eq!((times.count, times.min_us, times.max_us), (4, 3.0, 17.0));
        assert_eq!(times.mean_us, 7.5);
        let wanted = [(4.0, 1), (8.0, 2), (16.0, 0), (32.0, 1)];
        let wanted = wanted.map(|(end_us, count)| (Some(end_us), count));
        assert_eq!(times.histogram, wanted);
        durations.took(2_000_000);
        let times = DriveTimes::of("late", &durations.in_order()).unwrap();
        assert_eq!(times.histogram.last(), Some(&(None, 1)));
    }
}
