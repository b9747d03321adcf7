//! The dot product of two signals.

/// Products that are summed beside each other: one sum would wait for itself.
const LANES: usize = 8;

/// Sum of the products of two signals of one length. It is the same whichever comes first.
#[inline]
#[must_use]
pub(crate) fn dot(one: &[f64], other: &[f64]) -> f64 {
    let (ones, one) = one.as_chunks::<LANES>();
    let (others, other) = other.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (ones, others) in ones.iter().zip(others) {
        for (sum, (one, other)) in sums.iter_mut().zip(ones.iter().zip(others)) {
            *sum += one * other;
        }
    }
    let rest = one.iter().zip(other).map(|(one, other)| one * other);
    sums.into_iter().sum::<f64>() + rest.sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_products_are_summed_whatever_the_length() {
        for rows in [0_u32, 1, 7, 8, 9, 100] {
            let one: Vec<f64> = (0..rows).map(f64::from).collect();
            let other: Vec<f64> = one.iter().map(|value| value + 1.0).collect();
            // Σ k (k + 1) from 0 to n − 1.
            let n = f64::from(rows);
            let wanted = (n - 1.0) * n * (n + 1.0) / 3.0;
            assert_eq!(dot(&one, &other), wanted);
            assert_eq!(dot(&other, &one), wanted);
        }
    }
}
