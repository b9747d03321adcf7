//! When putting columns right explains what was left.

/// Share of the effort's variance that the rigid axis must leave before a cause is looked for: 7 %
/// of the effort. Less is the size of an effect, and effects have names of their own.
pub(crate) const WORTH_A_CAUSE: f64 = 0.005;
/// Putting the columns right must leave at most this share of what was left.
pub(crate) const LARGEST_REST: f64 = 0.1;

/// Whether putting columns right explains what was left.
pub(crate) fn explains(before: f64, after: f64) -> bool {
    before - after >= WORTH_A_CAUSE && after <= LARGEST_REST * before
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn putting_right_explains_from_a_share_of_the_effort_on_and_nine_tenths_of_the_rest() {
        assert!(explains(0.02, 0.002) && explains(0.5, 0.05));
        assert!(!explains(0.02, 0.0021) && !explains(0.0052, 0.0005));
    }
}
