//! As many points of a curve as paper can show, and never a peak less.

/// A tenth of a millimetre on paper, where a picture of 1080 px is as wide as A4 between its
/// margins.
pub(super) const COLUMN_PX: f64 = 0.1 * 1080.0 / 186.0;
/// A place so near to the line between its neighbours shows nothing.
const STRAIGHT_PX: f64 = 0.03;

/// The smallest and the largest of every tenth of a millimetre, in the order in which they came; a
/// curve that turns back in x begins a new column each time it leaves one.
pub(super) fn by_columns(points: impl IntoIterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    without_straight(extremes(points))
}

/// The same with those on a straight line.
pub(super) fn extremes(points: impl IntoIterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let mut kept = Vec::new();
    let mut column: Vec<(f64, f64)> = Vec::new();
    let mut last = None;
    let number = |at: &(f64, f64)| (at.0 / COLUMN_PX).floor();
    for point in points {
        if last.is_none() {
            kept.push(point);
        }
        last = Some(point);
        if column
            .first()
            .is_some_and(|first| number(first) != number(&point))
        {
            keep_extremes(&column, &mut kept);
            column.clear();
        }
        column.push(point);
    }
    keep_extremes(&column, &mut kept);
    // A curve ends where its last point is.
    kept.extend(last);
    kept
}

/// A column in which a curve turns round more often than this is a band of noise.
const TURNS: usize = 1;

/// Smallest and largest of a column, in the order in which they came; of a smooth curve its ends as
/// well, since nothing else hides them.
fn keep_extremes(column: &[(f64, f64)], kept: &mut Vec<(f64, f64)>) {
    let by_height = |a: &usize, b: &usize| column[*a].1.total_cmp(&column[*b].1);
    let places = || 0..column.len();
    let (Some(low), Some(high)) = (places().min_by(by_height), places().max_by(by_height)) else {
        return;
    };
    let mut places = vec![low, high];
    if turns(column) <= TURNS {
        places.extend([0, column.len() - 1]);
    }
    places.sort_unstable();
    places.dedup();
    kept.extend(places.into_iter().map(|place| column[place]));
}

/// How often a curve turns round.
fn turns(column: &[(f64, f64)]) -> usize {
    let steps: Vec<f64> = column
        .windows(2)
        .map(|pair| pair[1].1 - pair[0].1)
        .collect();
    steps
        .windows(2)
        .filter(|pair| pair[0] * pair[1] < 0.0)
        .count()
}

/// A curve without the places that lie on the line between what is kept before and after them.
pub(super) fn without_straight(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let mut kept: Vec<(f64, f64)> = Vec::new();
    // Places since the last one that was kept.
    let mut since: Vec<(f64, f64)> = Vec::new();
    for point in points {
        if let Some(from) = kept.last()
            && since
                .iter()
                .any(|at| off_line_px(*from, point, *at) > STRAIGHT_PX)
        {
            kept.extend(since.pop());
            since.clear();
        }
        if kept.is_empty() {
            kept.push(point);
        } else {
            since.push(point);
        }
        if since.len() > LONGEST {
            kept.extend(since.pop());
            since.clear();
        }
    }
    kept.extend(since.pop());
    kept
}

/// Places that are looked back at.
const LONGEST: usize = 200;

/// How far a place is from the way between two others.
fn off_line_px(from: (f64, f64), to: (f64, f64), at: (f64, f64)) -> f64 {
    let way = (to.0 - from.0, to.1 - from.1);
    let own = (at.0 - from.0, at.1 - from.1);
    let square = way.0 * way.0 + way.1 * way.1;
    let along = if square > 0.0 {
        ((own.0 * way.0 + own.1 * way.1) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (own.0 - along * way.0).hypot(own.1 - along * way.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_peak_among_many_points_is_kept() {
        let with_peak = |i: u32| (f64::from(i) * 1.0e-3, if i == 123_457 { 50.0 } else { 0.0 });
        let kept = by_columns((0..300_000).map(with_peak));
        assert!(kept.contains(&with_peak(123_457)));
        assert!(kept.len() < 20, "{}", kept.len());
    }

    #[test]
    fn noise_keeps_its_width_in_every_column() {
        let noise = |i: u32| {
            (
                f64::from(i) * 0.01,
                f64::from(i.wrapping_mul(2_654_435_761) >> 24),
            )
        };
        let points: Vec<_> = (0..10_000).map(noise).collect();
        let kept = by_columns(points.iter().copied());
        let width = |points: &[(f64, f64)], column: f64| {
            let own = points
                .iter()
                .filter(|at| (at.0 / COLUMN_PX).floor() == column)
                .map(|at| at.1);
            own.fold((f64::MAX, f64::MIN), |(low, high), y| {
                (low.min(y), high.max(y))
            })
        };
        for column in 0..170 {
            let column = f64::from(column);
            assert_eq!(width(&kept, column), width(&points, column));
        }
        assert!(kept.len() <= 2 * 174 + 2, "{}", kept.len());
    }

    #[test]
    fn a_circle_is_drawn_within_a_few_hundredths_of_a_pixel() {
        let at = |i: u32| {
            let (sin, cos) = (f64::from(i) * 1.0e-3).sin_cos();
            (200.0 * cos, 200.0 * sin)
        };
        let kept = without_straight((0..6284).map(at).collect());
        assert!(kept.len() < 400, "{}", kept.len());
        let worst = kept.windows(2).map(|pair| {
            let middle = (0.5 * (pair[0].0 + pair[1].0), 0.5 * (pair[0].1 + pair[1].1));
            200.0 - middle.0.hypot(middle.1)
        });
        assert!(worst.fold(0.0, f64::max) <= STRAIGHT_PX + 1.0e-6);
    }
}
