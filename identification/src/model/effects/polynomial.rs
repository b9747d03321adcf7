//! What grows with a scaled quantity u and its powers: `a u + b u²`, or more of them.
//!
//! The nonlinear parameter of such an effect is a choice: 1 for the linear term alone, 2 for two.

use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;

/// The usual choices.
pub(crate) const TERMS: [f64; 2] = [1.0, 2.0];

/// Number of columns at a choice.
#[must_use]
pub(crate) fn width(terms: f64) -> usize {
    (terms.round() as usize).max(1)
}

/// `weight·u`, `weight·u²` and so on, as many as are chosen; pairs of u and weight.
pub(crate) fn columns(pairs: impl Iterator<Item = (f64, f64)>, terms: f64) -> Vec<Vec<f64>> {
    let pairs: Vec<(f64, f64)> = pairs.collect();
    let power = |n: i32| pairs.iter().map(|(u, weight)| weight * u.powi(n)).collect();
    let powers = (1..).take(width(terms));
    powers.map(power).collect()
}

/// `a u + b u²` and so on, as far as there are coefficients.
#[must_use]
pub(crate) fn value(own: &[f64], u: f64) -> f64 {
    own.iter()
        .rev()
        .fold(0.0, |sum, coefficient| u * (coefficient + sum))
}

/// `weight·T₁(u)` … `weight·Tₙ(u)`, the polynomials of Chebyshev: any polynomial of that degree, in
/// columns that are not alike.
pub(crate) fn of_degree(pairs: impl Iterator<Item = (f64, f64)>, degree: usize) -> Vec<Vec<f64>> {
    let mut columns = vec![Vec::new(); degree];
    for (u, weight) in pairs {
        let (mut before, mut at) = (1.0, u);
        for column in &mut columns {
            column.push(weight * at);
            (before, at) = (at, 2.0 * u * at - before);
        }
    }
    columns
}

/// Position scaled to −1…1 over the travel of the training record, so that a validation record uses
/// the same scale.
pub(crate) fn over_travel<'a>(
    motion: &'a Kinematics,
    dataset: &Dataset,
) -> impl Iterator<Item = f64> + 'a {
    let (middle, half) = dataset.travel();
    let positions = motion.position_lp.iter();
    positions.map(move |x| (x - middle) / half)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_of_a_degree_has_a_column_for_each_and_each_is_a_cosine() {
        let u = 0.3_f64;
        let columns = of_degree([(u, 2.0)].into_iter(), 5);
        assert_eq!(columns.len(), 5);
        for (column, degree) in columns.iter().zip(1..) {
            let exact = 2.0 * (f64::from(degree) * u.acos()).cos();
            assert!((column[0] - exact).abs() < 1.0e-12, "{degree}");
        }
    }
}
