//! How a position goes from row to row: what no axis does and what a log does.
//!
//! An encoder that passes many counts a row has another value in every row, and its steps differ
//! little from one row to the next. Where a step is nothing or twice its neighbours, a row stands
//! twice or is missing. Where most steps are nothing, the column was held. Where velocity bends at
//! even distances only, it was interpolated. A step that is alone and ten times the fastest motion
//! is no motion: another run begins, or the count wraps around. A motion that ends in one row was
//! cut off.

/// Counts per row from which every row must differ: rounding is then a tenth of a step.
const FAST_COUNTS: f64 = 5.0;
/// Share of fast rows with one oddity from which it is no chance.
const ODD_SHARE: f64 = 0.005;
/// And their number.
const FEWEST: usize = 10;
/// Neighbouring steps are alike within this share.
const ALIKE: f64 = 0.1;
/// Share of fast rows without a step from which a column was held.
const HELD_SHARE: f64 = 0.5;
/// Rows about one over which its mean step is taken.
const ABOUT: usize = 50;
/// A jump is so many times its neighbours and the fastest twentieth of all steps.
const JUMP: f64 = 10.0;
/// Neighbours of a jump, rows.
const BESIDE: usize = 3;
/// Bends at even distances are at least so many rows apart: fewer are two clocks of one device.
const FEWEST_BETWEEN: usize = 5;
/// Share of distances that are the usual one.
const EVEN_SHARE: f64 = 0.8;
/// A bend is so many times the median one.
const BEND: f64 = 20.0;
/// Rows at an end of the range that are a stop.
const STOP_ROWS: usize = 10;
/// Stops in full motion that no axis survives.
const FEWEST_STOPS: usize = 3;

/// What is odd about a position, in words that follow the column's name.
pub(crate) fn oddity(position: &[f64], resolution: f64) -> Option<String> {
    let steps = Steps::of(position, resolution);
    steps
        .held()
        .or_else(|| steps.jumps())
        .or_else(|| steps.cut_off(position))
        .or_else(|| steps.doubled_or_missing())
        .or_else(|| steps.interpolated())
}

struct Steps {
    steps: Vec<f64>,
    /// A step from which every row must differ.
    fast: f64,
}

impl Steps {
    fn of(position: &[f64], resolution: f64) -> Self {
        let steps: Vec<f64> = position.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let moving = quantile(steps.iter().map(|step| step.abs()), 0.95);
        Self {
            fast: (FAST_COUNTS * resolution).max(ALIKE * moving),
            steps,
        }
    }

    /// Mean steps about each row: sums between two places of the position.
    fn held(&self) -> Option<String> {
        let rows = ABOUT..self.steps.len().saturating_sub(ABOUT);
        let (mut sum, mut fast, mut still) = (0.0, 0_usize, 0_usize);
        for row in rows {
            if row == ABOUT {
                sum = self.steps[..=2 * ABOUT].iter().sum();
            } else {
                sum += self.steps[row + ABOUT] - self.steps[row - ABOUT - 1];
            }
            if sum.abs() / (2 * ABOUT + 1) as f64 > self.fast {
                fast += 1;
                still += usize::from(self.steps[row] == 0.0);
            }
        }
        let is_held = fast >= FEWEST && still as f64 > HELD_SHARE * fast as f64;
        is_held.then(|| {
            let rows = fast as f64 / (fast - still).max(1) as f64;
            format!("is held: in motion it changes at every {rows:.0}th row only; record it at the rate of the rows")
        })
    }

    /// Steps that are alone and far beyond the motion.
    fn jumps(&self) -> Option<String> {
        let fastest = quantile(self.steps.iter().map(|step| step.abs()), 0.95);
        let is_jump = |row: &usize| {
            let step = self.steps[*row].abs();
            let beside = row.saturating_sub(BESIDE)..(row + BESIDE + 1).min(self.steps.len());
            let others = beside.filter(|other| other != row);
            let most = others
                .map(|other| self.steps[other].abs())
                .fold(0.0, f64::max);
            step > JUMP * most.max(fastest).max(0.1 * self.fast)
        };
        let jumps: Vec<usize> = (0..self.steps.len()).filter(is_jump).collect();
        let size = |row: &usize| self.steps[*row];
        let (first, sizes) = (*jumps.first()?, jumps.iter().map(|row| size(row).abs()));
        let (least, most) = crate::record::extent::range(&sizes.collect::<Vec<_>>());
        let both_ways =
            jumps.iter().any(|row| size(row) > 0.0) && jumps.iter().any(|row| size(row) < 0.0);
        let is_wrap = both_ways && most - least < ALIKE * most;
        let looks = if is_wrap {
            "it wraps around; count its turns".to_owned()
        } else {
            "the file holds several runs end to end, or rows are lost there; split it".to_owned()
        };
        // The header is line 1, and the step goes to the row after.
        Some(format!(
            "jumps {} times, first by {:.4e} in line {}: {looks}",
            jumps.len(),
            size(&first),
            first + 3
        ))
    }

    /// Stops at an end of the range, out of full motion.
    fn cut_off(&self, position: &[f64]) -> Option<String> {
        let (low, high) = crate::record::extent::range(position);
        [low, high].into_iter().find_map(|end| {
            let stops = (3..position.len().saturating_sub(STOP_ROWS)).filter(|row| {
                let is_stop = position[*row - 1] != end
                    && position[*row..row + STOP_ROWS].iter().all(|x| *x == end);
                is_stop && self.steps[row - 3].abs().min(self.steps[row - 2].abs()) > self.fast
            });
            let count = stops.count();
            (count >= FEWEST_STOPS).then(|| {
                format!("is cut off at {end:.6}: {count} times it stops there within one row out of full motion")
            })
        })
    }

    /// Steps of nothing, or of twice their neighbours.
    fn doubled_or_missing(&self) -> Option<String> {
        let (mut asked, mut still, mut twice) = (0_usize, 0_usize, 0_usize);
        for triple in self.steps.windows(3) {
            let (before, step, after) = (triple[0], triple[1], triple[2]);
            let mean = 0.5 * (before + after);
            if (before - after).abs() > ALIKE * mean.abs() || mean.abs() < self.fast {
                continue;
            }
            asked += 1;
            still += usize::from(step.abs() < ALIKE * mean.abs());
            twice += usize::from((step / mean - 2.0).abs() < 2.0 * ALIKE);
        }
        let is_odd = |count: usize| count >= FEWEST && count as f64 > ODD_SHARE * asked as f64;
        if is_odd(still) {
            let words = "rows stand twice: the position rests for one row in full motion";
            return Some(format!("says that {words} ({still} of {asked})"));
        }
        is_odd(twice).then(|| {
            let words =
                "rows are missing, or the loop oscillates: the position makes two steps in one row";
            format!("says that {words} ({twice} of {asked})")
        })
    }

    /// Bends of the motion at even distances.
    fn interpolated(&self) -> Option<String> {
        let bends: Vec<f64> = self
            .steps
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).abs())
            .collect();
        let usual = quantile(bends.iter().copied(), 0.5).max(1.0e-3 * self.fast);
        let kinks = (0..bends.len()).filter(|row| bends[*row] > BEND * usual);
        let kinks: Vec<usize> = kinks.collect();
        let gaps: Vec<f64> = kinks
            .windows(2)
            .map(|pair| (pair[1] - pair[0]) as f64)
            .collect();
        let gap = quantile(gaps.iter().copied(), 0.5);
        let even = gaps.iter().filter(|one| **one == gap).count();
        let is_even = gaps.len() >= FEWEST && even as f64 >= EVEN_SHARE * gaps.len() as f64;
        (is_even && gap >= FEWEST_BETWEEN as f64).then(|| {
            format!("is interpolated: its velocity changes at every {gap:.0}th row only; record it at the rate of the rows")
        })
    }
}

/// A quantile of values; zero where there are none.
pub(crate) fn quantile(values: impl Iterator<Item = f64>, share: f64) -> f64 {
    let mut values: Vec<f64> = values.collect();
    if values.is_empty() {
        return 0.0;
    }
    let place = (share * (values.len() - 1) as f64) as usize;
    *values.select_nth_unstable_by(place, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::made::two_sines;

    const COUNT: f64 = 1.0e-7;

    /// Two sines in counts, twelve seconds.
    fn motion() -> Vec<f64> {
        let path = two_sines(12_000).into_iter();
        path.map(|x| COUNT * (x / COUNT).round()).collect()
    }

    fn said(position: &[f64]) -> String {
        oddity(position, COUNT).unwrap_or_default()
    }

    #[test]
    fn a_motion_in_counts_is_not_odd_nor_is_one_with_rests() {
        assert_eq!(said(&motion()), "");
        let with_rests: Vec<f64> = motion().iter().map(|x| x.clamp(-0.019, 0.019)).collect();
        // Cut off where it is slow: it rests.
        assert_eq!(said(&with_rests[..800]), "");
        let coarse: Vec<f64> = motion()
            .iter()
            .map(|x| 2.0e-5 * (x / 2.0e-5).round())
            .collect();
        assert_eq!(oddity(&coarse, 2.0e-5), None);
    }

    #[test]
    fn a_held_position_is_told_with_its_rows() {
        let motion = motion();
        let held: Vec<f64> = (0..motion.len())
            .map(|row| motion[row - row % 20])
            .collect();
        assert!(
            said(&held).contains("is held: in motion it changes at every 20th row"),
            "{}",
            said(&held)
        );
    }

    #[test]
    fn rows_that_stand_twice_and_rows_that_are_missing_are_told() {
        let twice = motion().into_iter().enumerate();
        let twice: Vec<f64> = twice
            .flat_map(|(row, x)| std::iter::repeat_n(x, if row % 10 == 0 { 2 } else { 1 }))
            .collect();
        assert!(
            said(&twice).contains("rows stand twice"),
            "{}",
            said(&twice)
        );
        let missing = motion().into_iter().enumerate();
        let missing: Vec<f64> = missing
            .filter(|(row, _)| row % 7 != 3)
            .map(|(_, x)| x)
            .collect();
        assert!(
            said(&missing).contains("rows are missing"),
            "{}",
            said(&missing)
        );
    }

    #[test]
    fn a_second_run_and_a_count_that_wraps_are_jumps() {
        let runs = [&motion()[..5300], &motion()[700..6000]].concat();
        assert!(
            said(&runs).contains("several runs end to end"),
            "{}",
            said(&runs)
        );
        assert!(said(&runs).contains("in line 5302"), "{}", said(&runs));
        let wrapped: Vec<f64> = motion()
            .iter()
            .map(|x| x - 0.02 * (x / 0.02).round())
            .collect();
        assert!(
            said(&wrapped).contains("wraps around"),
            "{}",
            said(&wrapped)
        );
    }

    #[test]
    fn a_motion_that_ends_within_a_row_is_cut_off() {
        let cut: Vec<f64> = motion().iter().map(|x| x.min(0.01)).collect();
        assert!(
            said(&cut).contains("is cut off at 0.010000"),
            "{}",
            said(&cut)
        );
    }

    #[test]
    fn lines_between_rows_far_apart_are_an_interpolation() {
        let motion = two_sines(12_000);
        let lines: Vec<f64> = (0..11_900)
            .map(|row| {
                let (from, share) = (row - row % 100, (row % 100) as f64 / 100.0);
                motion[from] + share * (motion[from + 100] - motion[from])
            })
            .collect();
        assert!(
            said(&lines).contains("at every 100th row"),
            "{}",
            said(&lines)
        );
    }

    #[test]
    fn a_quantile_is_a_value_of_the_list() {
        assert_eq!(quantile([3.0, 1.0, 2.0].into_iter(), 0.5), 2.0);
        assert_eq!(quantile([3.0, 1.0, 2.0].into_iter(), 1.0), 3.0);
        assert_eq!(quantile(std::iter::empty(), 0.5), 0.0);
    }
}
