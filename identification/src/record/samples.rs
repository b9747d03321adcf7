//! A record: samples on a uniform time base, and the rows of the file that they were made from.
//!
//! A record is one piece, or several whose joints are known: windows of a longer one. Time stays
//! true in every piece; what has a memory (a filter, a bristle, a simulation) begins again in each.

use std::ops::Range;

/// A record on a uniform time base.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Sample period, s.
    pub period_s: f64,
    /// Motor position.
    pub position: Vec<f64>,
    /// Load position, if it was measured.
    pub load: Option<Vec<f64>>,
    /// Velocity of the motor as the drive gives it, if it was recorded.
    pub velocity: Option<Vec<f64>>,
    /// Setpoint, if it was recorded.
    pub reference: Option<Vec<f64>>,
    /// Effort.
    pub effort: Vec<f64>,
    /// Time of each sample since the first row of the file (or since power-on, where the file
    /// counts from there), s.
    pub time_s: Vec<f64>,
    /// The rows of the file that this record was made from: time stamp and effort as they stand
    /// there.
    pub rows: Vec<(f64, f64)>,
    /// Whether the time stamps jittered, so that the samples were interpolated.
    pub jittered: bool,
    /// Samples that stand in a hole of the file and were interpolated; they are not fitted.
    pub interpolated: Vec<bool>,
    /// Samples before which time was left out on purpose: a new piece begins there.
    pub joints: Vec<usize>,
}

/// Samples further apart than so many periods do not follow on each other.
const NEXT_WITHIN_PERIODS: f64 = 1.5;

impl Record {
    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// Whether there is nothing in it.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }

    /// The contiguous pieces, in order: the whole record where it has no joints.
    #[must_use]
    pub fn pieces(&self) -> Vec<Range<usize>> {
        let starts = std::iter::once(0).chain(self.joints.iter().copied());
        let ends = self.joints.iter().copied().chain([self.len()]);
        starts.zip(ends).map(|(start, end)| start..end).collect()
    }

    /// Samples that are at least so many rows after the start of their piece.
    pub(crate) fn settled(&self, rows: usize) -> impl Iterator<Item = usize> {
        let after = move |piece: Range<usize>| (piece.start + rows).min(piece.end)..piece.end;
        self.pieces().into_iter().flat_map(after)
    }

    /// Time from the first sample to the end of the last one, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        match (
            self.joints.is_empty(),
            self.time_s.first(),
            self.time_s.last(),
        ) {
            (false, Some(first), Some(last)) => last - first + self.period_s,
            _ => self.period_s * self.len() as f64,
        }
    }

    /// Ranges of the record (in rising order) joined to one.
    #[must_use]
    pub fn windows(&self, ranges: &[Range<usize>]) -> Self {
        let mut parts = ranges.iter().map(|range| self.part(range.clone()));
        let first = parts.next().unwrap_or_else(|| self.part(0..0));
        parts.fold(first, |joined, next| joined.followed_by(&next))
    }

    /// A part of the record; time goes on from the whole.
    #[must_use]
    pub fn part(&self, range: Range<usize>) -> Self {
        let cut = |values: &[f64]| values[range.clone()].to_vec();
        Self {
            period_s: self.period_s,
            position: cut(&self.position),
            load: self.load.as_deref().map(cut),
            velocity: self.velocity.as_deref().map(cut),
            reference: self.reference.as_deref().map(cut),
            effort: cut(&self.effort),
            time_s: cut(&self.time_s),
            rows: self.rows[self.row_of(range.start)..self.row_of(range.end)].to_vec(),
            interpolated: self.interpolated[range.clone()].to_vec(),
            jittered: self.jittered,
            joints: self.joints_within(&range),
        }
    }

    /// The record before a sample and the record from it on, without a second copy of either.
    #[must_use]
    pub fn split_at(mut self, sample: usize) -> (Self, Self) {
        let row = self.row_of(sample);
        let joints = self.joints_within(&(sample..self.len()));
        let before = self.joints_within(&(0..sample));
        self.joints = before;
        let after = Self {
            period_s: self.period_s,
            position: self.position.split_off(sample),
            load: self.load.as_mut().map(|load| load.split_off(sample)),
            velocity: self.velocity.as_mut().map(|own| own.split_off(sample)),
            reference: self.reference.as_mut().map(|path| path.split_off(sample)),
            effort: self.effort.split_off(sample),
            time_s: self.time_s.split_off(sample),
            rows: self.rows.split_off(row),
            interpolated: self.interpolated.split_off(sample),
            jittered: self.jittered,
            joints,
        };
        (self, after)
    }

    /// This record and a later one; where that does not go on at the end of this, with a joint.
    #[must_use]
    pub fn followed_by(&self, next: &Self) -> Self {
        let join = |a: &[f64], b: &[f64]| [a, b].concat();
        let both = |a: &Option<Vec<f64>>, b: &Option<Vec<f64>>| {
            a.as_deref().zip(b.as_deref()).map(|(a, b)| join(a, b))
        };
        Self {
            period_s: self.period_s,
            position: join(&self.position, &next.position),
            load: both(&self.load, &next.load),
            velocity: both(&self.velocity, &next.velocity),
            reference: both(&self.reference, &next.reference),
            effort: join(&self.effort, &next.effort),
            time_s: join(&self.time_s, &next.time_s),
            rows: [&self.rows[..], &next.rows[..]].concat(),
            interpolated: [&self.interpolated[..], &next.interpolated[..]].concat(),
            jittered: self.jittered,
            joints: self.joints_with(next),
        }
    }

    fn joints_with(&self, next: &Self) -> Vec<usize> {
        let step_s = match (self.time_s.last(), next.time_s.first()) {
            (Some(last), Some(first)) => first - last,
            _ => self.period_s,
        };
        let apart = step_s > NEXT_WITHIN_PERIODS * self.period_s;
        let later = next.joints.iter().map(|joint| self.len() + joint);
        let seam = apart.then_some(self.len());
        self.joints
            .iter()
            .copied()
            .chain(seam)
            .chain(later)
            .collect()
    }

    fn joints_within(&self, range: &Range<usize>) -> Vec<usize> {
        let inside = self
            .joints
            .iter()
            .filter(|joint| **joint > range.start && **joint < range.end);
        inside.map(|joint| joint - range.start).collect()
    }

    /// The first row of the file that belongs to a sample: half a period before it at most. Those
    /// before the first sample belong to none, those after the last one to the last.
    fn row_of(&self, sample: usize) -> usize {
        let (Some(row), Some(first)) = (self.rows.first(), self.time_s.first()) else {
            return 0;
        };
        let origin_s = row.0 - first;
        let from_s = self
            .time_s
            .get(sample)
            .map_or(f64::INFINITY, |t| t - 0.5 * self.period_s);
        self.rows.partition_point(|(t, _)| t - origin_s < from_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten samples at 0.1 s from twenty rows at 0.05 s that begin at 3 s.
    fn record() -> Record {
        let ramp = |count: i32, step: f64| (0..count).map(|i| step * f64::from(i)).collect();
        let time_s: Vec<f64> = ramp(10, 0.1);
        let rows: Vec<f64> = ramp(20, 0.05);
        Record {
            period_s: 0.1,
            position: ramp(10, 1.0),
            load: Some(ramp(10, 2.0)),
            velocity: Some(ramp(10, 3.0)),
            reference: None,
            effort: ramp(10, -1.0),
            rows: rows.iter().map(|t| (3.001 + t, 7.0 * t)).collect(),
            jittered: true,
            joints: Vec::new(),
            interpolated: (0..10).map(|i| i == 4).collect(),
            time_s,
        }
    }

    #[test]
    fn a_part_has_the_rows_that_are_nearest_to_its_samples() {
        let part = record().part(4..6);
        assert_eq!(part.position, [4.0, 5.0]);
        assert_eq!(part.interpolated, [true, false]);
        let times: Vec<f64> = part.rows.iter().map(|(t, _)| t - 3.001).collect();
        // From 0.35 s to 0.55 s, the second not included.
        assert_eq!(times.len(), 4);
        assert!((times[0] - 0.35).abs() < 1.0e-9 && (times[3] - 0.50).abs() < 1.0e-9);
    }

    #[test]
    fn halves_are_the_parts_and_make_the_whole_again() {
        let whole = record();
        let (before, after) = whole.clone().split_at(6);
        assert_eq!(before, whole.part(0..6));
        assert_eq!(after, whole.part(6..10));
        assert_eq!(before.followed_by(&after), whole);
    }

    #[test]
    fn windows_know_their_joints_and_keep_their_time() {
        let windows = record().windows(&[0..3, 5..7, 7..10]);
        assert_eq!(windows.position, [0.0, 1.0, 2.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
        // 5..7 and 7..10 go on: one piece.
        assert_eq!(windows.pieces(), [0..3, 3..8]);
        assert!((windows.time_s[3] - 0.5).abs() < 1.0e-12);
        assert!((windows.duration_s() - record().duration_s()).abs() < 1.0e-12);
        assert_eq!(windows.settled(2).collect::<Vec<_>>(), [2, 5, 6, 7]);
    }

    #[test]
    fn parts_and_halves_keep_the_joints_that_are_inside_them() {
        let windows = record().windows(&[0..3, 5..7, 8..10]);
        assert_eq!(windows.joints, [3, 5]);
        assert_eq!(windows.part(1..4).joints, [2]);
        assert_eq!(windows.part(3..5).joints, [0; 0]);
        let (before, after) = windows.clone().split_at(4);
        assert_eq!(
            (&before.joints[..], &after.joints[..]),
            (&[3][..], &[1][..])
        );
        assert_eq!(before.followed_by(&after), windows);
    }
}
