//! A smooth curve over the travel through values at evenly spaced knots, zero at the middle one.
//!
//! Between its knots it is the cubic convolution of Keys (IEEE Trans. Acoustics, Speech and Signal
//! Processing 29, 1981, a = −1/2): a coefficient is the value at its knot, quadratic curves are
//! exact, and each knot acts on four intervals. Beyond the ends the values go on in a line.
//!
//! The nonlinear parameter of such an effect is the number of intervals, which is even.

/// The numbers of intervals, from coarse to fine.
pub(crate) const INTERVALS: [f64; 3] = [4.0, 8.0, 16.0];

/// Position of a coefficient's knot, −1…1.
#[must_use]
pub(crate) fn knot(place: usize, intervals: usize) -> f64 {
    let index = if place < intervals / 2 {
        place
    } else {
        place + 1
    };
    2.0 * index as f64 / intervals as f64 - 1.0
}

/// `weight` times each coefficient's part in the curve; pairs of u, −1…1, and weight.
pub(crate) fn columns(pairs: impl Iterator<Item = (f64, f64)>, intervals: usize) -> Vec<Vec<f64>> {
    let mut columns = vec![Vec::new(); intervals];
    for (row, (u, weight)) in pairs.enumerate() {
        for column in &mut columns {
            column.push(0.0);
        }
        for (place, share) in parts(u, intervals) {
            columns[place][row] += weight * share;
        }
    }
    columns
}

/// The curve at a position.
#[must_use]
pub(crate) fn value(own: &[f64], u: f64) -> f64 {
    let parts = parts(u, own.len());
    parts.map(|(place, share)| share * own[place]).sum()
}

/// The coefficients that act at a position, and their shares in the curve there.
fn parts(u: f64, intervals: usize) -> impl Iterator<Item = (usize, f64)> {
    let (first, shares) = kernel(u, intervals);
    let last = intervals as isize;
    let knots = shares
        .into_iter()
        .zip(first..)
        .flat_map(move |(share, knot)| {
            // What lies beyond an end is twice the end less the knot before it.
            match knot {
                knot if knot < 0 => [(0, 2.0 * share), (-knot, -share)],
                knot if knot > last => [(last, 2.0 * share), (2 * last - knot, -share)],
                knot => [(knot, share), (knot, 0.0)],
            }
        });
    let middle = last / 2;
    let known = knots.filter(move |(knot, share)| *knot != middle && *share != 0.0);
    known.map(move |(knot, share)| {
        let place = if knot > middle { knot - 1 } else { knot };
        (place.unsigned_abs(), share)
    })
}

/// The first of the four knots about a position, and the share of each.
fn kernel(u: f64, intervals: usize) -> (isize, [f64; 4]) {
    let along = 0.5 * (u.clamp(-1.0, 1.0) + 1.0) * intervals as f64;
    let interval = along.floor().min(intervals as f64 - 1.0);
    let f = along - interval;
    let shares = [
        f * (f * (1.0 - 0.5 * f) - 0.5),
        f * f * (1.5 * f - 2.5) + 1.0,
        f * (f * (2.0 - 1.5 * f) + 0.5),
        0.5 * f * f * (f - 1.0),
    ];
    (interval as isize - 1, shares)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values at the knots of a curve that is zero in the middle.
    fn at_knots(intervals: usize, curve: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..intervals)
            .map(|place| curve(knot(place, intervals)))
            .collect()
    }

    #[test]
    fn a_curve_has_its_coefficients_at_the_knots_and_zero_in_the_middle() {
        for intervals in [4, 8, 16] {
            let own: Vec<f64> = (0..intervals).map(|place| 3.0 + place as f64).collect();
            for (place, wanted) in own.iter().enumerate() {
                let found = value(&own, knot(place, intervals));
                assert!(
                    (found - wanted).abs() < 1.0e-12,
                    "{intervals} {place} {found}"
                );
            }
            assert!(value(&own, 0.0).abs() < 1.0e-12);
        }
    }

    #[test]
    fn lines_are_exact_everywhere_and_parabolas_away_from_the_ends() {
        let own = at_knots(8, |u| 2.0 * u);
        let bent = at_knots(8, |u| u * u - 3.0 * u);
        for i in -20..=20 {
            let u = f64::from(i) / 20.0;
            assert!((value(&own, u) - 2.0 * u).abs() < 1.0e-12, "{u}");
            if u.abs() <= 0.75 {
                assert!((value(&bent, u) - (u * u - 3.0 * u)).abs() < 1.0e-12, "{u}");
            }
        }
        // Beyond the travel it stays what it is at the end.
        assert_eq!(value(&own, 1.3), value(&own, 1.0));
    }

    #[test]
    fn columns_are_the_curve_by_its_coefficients_times_the_weight() {
        let own = at_knots(16, |u| (5.0 * u).sin());
        let pairs = [
            (-1.0, 1.0),
            (-0.93, -1.0),
            (0.02, 2.0),
            (0.71, 1.0),
            (1.0, -3.0),
        ];
        let columns = columns(pairs.into_iter(), 16);
        assert_eq!(columns.len(), 16);
        for (row, (u, weight)) in pairs.into_iter().enumerate() {
            let sum: f64 = columns.iter().zip(&own).map(|(c, own)| c[row] * own).sum();
            assert!((sum - weight * value(&own, u)).abs() < 1.0e-12, "{u}");
        }
    }

    #[test]
    fn a_bump_over_a_third_of_the_travel_is_seen_within_two_percent() {
        let bump = |u: f64| (-((u - 0.4) / 0.33).powi(2)).exp();
        let bump = |u: f64| bump(u) - bump(0.0);
        let own = at_knots(16, bump);
        for i in -100..=100 {
            let u = f64::from(i) / 100.0;
            assert!((value(&own, u) - bump(u)).abs() < 0.02, "{u}");
        }
    }
}
