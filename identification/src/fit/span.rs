//! What columns span over some rows, and what of a signal lies outside of it.
//!
//! Modified Gram–Schmidt, twice ("twice is enough": Giraud, Langou, Rozložník, Computers and
//! Mathematics with Applications 50, 2005). A column that lies in the span of earlier ones adds
//! nothing, so equal and nearly equal columns do no harm.

use crate::motion::dot::dot;

/// A column of which less than this share stands outside of the span is in it.
const OUTSIDE: f64 = 1.0e-3;

/// An orthonormal basis over the rows of a mask; zero elsewhere.
#[derive(Clone, Debug)]
pub(crate) struct Span<'a> {
    mask: &'a [bool],
    basis: Vec<Vec<f64>>,
}

impl<'a> Span<'a> {
    /// The span of columns over the rows of a mask.
    #[must_use]
    pub(crate) fn of(columns: impl IntoIterator<Item = Vec<f64>>, mask: &'a [bool]) -> Self {
        let mut span = Self {
            mask,
            basis: Vec::new(),
        };
        for column in columns {
            span.add(&column);
        }
        span
    }

    /// Adds a column; says whether it was new.
    pub(crate) fn add(&mut self, column: &[f64]) -> bool {
        let before = norm(&self.masked(column));
        let outside = self.outside(column);
        let after = norm(&outside);
        let is_new = after > OUTSIDE * before && after > 0.0;
        if is_new {
            self.basis
                .push(outside.iter().map(|value| value / after).collect());
        }
        is_new
    }

    /// What of a signal lies outside, over the rows of the mask.
    #[must_use]
    pub(crate) fn outside(&self, signal: &[f64]) -> Vec<f64> {
        let mut rest = self.masked(signal);
        for direction in self.basis.iter().chain(&self.basis) {
            let along = dot(&rest, direction);
            let pairs = rest.iter_mut().zip(direction);
            pairs.for_each(|(value, unit)| *value -= along * unit);
        }
        rest
    }

    /// The directions that were added after the first ones.
    #[must_use]
    pub(crate) fn beyond(&self, first: usize) -> Vec<&[f64]> {
        self.basis[first..].iter().map(Vec::as_slice).collect()
    }

    /// Number of directions.
    #[must_use]
    pub(crate) fn dimension(&self) -> usize {
        self.basis.len()
    }

    fn masked(&self, signal: &[f64]) -> Vec<f64> {
        let pairs = signal.iter().zip(self.mask);
        pairs
            .map(|(value, inside)| if *inside { *value } else { 0.0 })
            .collect()
    }
}

fn norm(signal: &[f64]) -> f64 {
    dot(signal, signal).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    const MASK: [bool; 4] = [true, true, true, false];

    #[test]
    fn what_columns_span_is_taken_away_and_the_rest_stays() {
        let span = Span::of([vec![1.0, 1.0, 1.0, 9.0], vec![0.0, 1.0, 2.0, 9.0]], &MASK);
        assert_eq!(span.dimension(), 2);
        let outside = span.outside(&[5.0, 7.0, 9.0, 100.0]);
        assert!(
            outside.iter().all(|value| value.abs() < 1.0e-12),
            "{outside:?}"
        );
        // 1, −2, 1 is orthogonal to a line.
        let outside = span.outside(&[5.0 + 1.0, 7.0 - 2.0, 9.0 + 1.0, 100.0]);
        let wanted = [1.0, -2.0, 1.0, 0.0];
        let pairs = outside.iter().zip(wanted);
        assert!(
            pairs.clone().all(|(a, b)| (a - b).abs() < 1.0e-12),
            "{outside:?}"
        );
    }

    #[test]
    fn a_column_that_is_nearly_in_the_span_adds_nothing() {
        let mut span = Span::of([vec![1.0, 0.0, 0.0, 0.0]], &MASK);
        assert!(!span.add(&[2.0, 0.0, 0.0, 50.0]));
        assert!(!span.add(&[1.0, 0.9e-3, 0.0, 0.0]));
        assert!(!span.add(&[0.0, 0.0, 0.0, 1.0]));
        assert!(span.add(&[1.0, 1.1e-3, 0.0, 0.0]));
        assert_eq!(span.beyond(1), [&[0.0, 1.0, 0.0, 0.0][..]]);
    }
}
