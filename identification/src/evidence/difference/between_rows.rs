//! The load's path between its rows: a bristle gives way with every micrometre, also where the path
//! turns within a row.
//!
//! A part of a row is a step of the position: `x(s)` of the cubic through positions and velocities
//! of both rows (Hermite). Where both velocities have one sign nothing turns back in between.
//!
//! A scale gives counts. Where the load hardly moves they go to and fro, and a bristle that follows
//! them relaxes as a real one does under real vibration. How much of it was real nobody recorded:
//! [`without_small_turns`] takes all of it away.
//!
//! Units: m or rad, s.

/// Parts of a row. With eight a Stribeck fall and a damping that were found move by a tenth of a
/// percent, with one by three.
const PARTS: usize = 4;

/// Steps of a path in the parts of each row; none in the first row, which nothing comes before.
pub(super) struct Steps {
    steps: Vec<[f64; PARTS]>,
    /// Length of a part, s.
    pub(super) part_s: f64,
}

impl Steps {
    /// Of a path with such velocities at the rows.
    pub(super) fn of(position: &[f64], velocity: &[f64], period_s: f64) -> Self {
        let ends = position.windows(2).zip(velocity.windows(2));
        let first = position.iter().take(1).map(|_| [0.0; PARTS]);
        let others = ends.map(|(x, v)| steps([x[0], x[1]], [v[0] * period_s, v[1] * period_s]));
        Self {
            steps: first.chain(others).collect(),
            part_s: period_s / PARTS as f64,
        }
    }

    /// Number of rows.
    pub(super) const fn len(&self) -> usize {
        self.steps.len()
    }

    /// Velocity in each part of each row.
    pub(super) fn velocities(&self) -> impl Iterator<Item = f64> {
        let steps = self.steps.iter().flatten();
        steps.map(|step| step / self.part_s)
    }

    /// A state at the rows that goes on by the step of each part and a value that belongs to it.
    pub(super) fn followed<T: Copy + Default>(
        &self,
        by_part: &[f64],
        mut on: impl FnMut(f64, f64) -> T,
    ) -> Vec<T> {
        let mut state = T::default();
        let rows = self.steps.iter().zip(by_part.as_chunks::<PARTS>().0);
        let rows = rows.map(|(steps, values)| {
            for (step, value) in steps.iter().zip(values) {
                state = on(*step, *value);
            }
            state
        });
        rows.collect()
    }
}

/// The steps of a row between two positions, with the velocities at both times the period.
fn steps(x: [f64; 2], slope: [f64; 2]) -> [f64; PARTS] {
    let goes_on = slope[0] * slope[1] > 0.0;
    let mut before = x[0];
    std::array::from_fn(|part| {
        let s = (part + 1) as f64 / PARTS as f64;
        let (there, back) = (s * s * (3.0 - 2.0 * s), s * (1.0 - s));
        let bow = back * ((1.0 - s) * slope[0] - s * slope[1]);
        let at = x[0] + there * (x[1] - x[0]) + bow;
        let at = if goes_on {
            at.clamp(before.min(x[1]), before.max(x[1]))
        } else {
            at
        };
        let step = at - before;
        before = at;
        step
    })
}

/// A path that goes one way between turns that are larger than a size: halfway between the farthest
/// it has come and the least it will be. Without a size it is the path.
pub(super) fn without_small_turns(path: &[f64], size: f64) -> Vec<f64> {
    let mut smooth = path.to_vec();
    if size == 0.0 {
        return smooth;
    }
    for pair in turns(path, size).windows(2) {
        let part = &path[pair[0]..=pair[1]];
        let is_up = part[part.len() - 1] >= part[0];
        let farther = |a: f64, b: f64| if is_up { a.max(b) } else { a.min(b) };
        let nearer = |a: f64, b: f64| if is_up { a.min(b) } else { a.max(b) };
        let come = running(part.iter(), farther);
        let will = running(part.iter().rev(), nearer).into_iter().rev();
        let both = come.into_iter().zip(will);
        let inner = smooth[pair[0]..=pair[1]].iter_mut();
        inner.zip(both).for_each(|(x, (a, b))| *x = 0.5 * (a + b));
    }
    smooth
}

/// The outermost of all values up to each.
fn running<'a>(values: impl Iterator<Item = &'a f64>, outer: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let mut most = None;
    let so_far = values.map(|value| *most.insert(most.map_or(*value, |most| outer(most, *value))));
    so_far.collect()
}

/// The rows at which a path turns by more than a size, with its first and its last row.
fn turns(path: &[f64], size: f64) -> Vec<usize> {
    let mut turns = vec![0];
    let (mut lowest, mut highest, mut direction) = (0, 0, 0.0);
    for (row, x) in path.iter().enumerate() {
        if *x < path[lowest] {
            lowest = row;
        }
        if *x > path[highest] {
            highest = row;
        }
        if direction >= 0.0 && x + size < path[highest] {
            (direction, lowest) = (-1.0, row);
            turns.push(highest);
        } else if direction <= 0.0 && x - size > path[lowest] {
            (direction, highest) = (1.0, row);
            turns.push(lowest);
        }
    }
    turns.push(path.len().saturating_sub(1));
    turns.dedup();
    turns
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_S: f64 = 1.0e-3;

    #[test]
    fn parts_of_a_row_follow_a_cubic_and_end_at_its_rows() {
        let at = |t: f64| 2.0 + 30.0 * t - 4.0e3 * t.powi(2) + 5.0e6 * t.powi(3);
        let slope = |t: f64| 30.0 - 8.0e3 * t + 1.5e7 * t.powi(2);
        let rows = |f: &dyn Fn(f64) -> f64| -> Vec<f64> {
            (0..5).map(|row| f(PERIOD_S * f64::from(row))).collect()
        };
        let steps = Steps::of(&rows(&at), &rows(&slope), PERIOD_S);
        assert_eq!(steps.steps[0], [0.0; PARTS]);
        let mut x = at(0.0);
        for (place, step) in steps.steps[1..].iter().flatten().enumerate() {
            x += step;
            let wanted = at(PERIOD_S / PARTS as f64 * (place + 1) as f64);
            assert!((x - wanted).abs() < 1.0e-12, "{place}: {x}, {wanted}");
        }
        // A state that adds up all steps is the path itself.
        let mut sum = 0.0;
        let velocities: Vec<f64> = steps.velocities().collect();
        let summed = steps.followed(&velocities, |step, velocity| {
            assert!((velocity * PERIOD_S - step * PARTS as f64).abs() < 1.0e-12);
            sum += step;
            sum
        });
        let path = rows(&at).into_iter().zip(summed);
        assert!(
            path.into_iter()
                .all(|(x, sum)| (x - 2.0 - sum).abs() < 1e-12)
        );
    }

    #[test]
    fn only_a_row_at_whose_ends_the_path_goes_other_ways_turns_within() {
        let turned = steps([0.0, 0.0], [1.0, -1.0]);
        assert_eq!(turned, [0.1875, 0.0625, -0.0625, -0.1875]);
        // A cubic through these goes beyond both ends.
        let on = steps([0.0, 0.1], [1.0, 1.0]);
        assert!(on.iter().all(|step| *step >= 0.0), "{on:?}");
        assert!((on.iter().sum::<f64>() - 0.1).abs() < 1.0e-15);
    }

    #[test]
    fn small_turns_go_and_large_ones_stay_where_they_are() {
        let path = [
            0.0, 1.0, 0.0, 1.0, 2.0, 1.0, 2.0, 5.0, 4.0, 1.0, 2.0, 1.0, 0.0,
        ];
        let smooth = [
            0.0, 0.5, 0.5, 1.0, 1.5, 1.5, 2.0, 5.0, 4.0, 1.5, 1.5, 1.0, 0.0,
        ];
        assert_eq!(turns(&path, 1.5), [0, 7, 12]);
        assert_eq!(without_small_turns(&path, 1.5), smooth);
        assert_eq!(without_small_turns(&path, 0.5), path);
        assert!(without_small_turns(&[], 1.0).is_empty());
        assert_eq!(without_small_turns(&[3.0], 1.0), [3.0]);
    }
}
