//! Explained or not, and in words what is left.
//!
//! Every stage gives its reasons: what it saw that no accepted effect explains. A reason either
//! counts, and then the record is `unexplained`, or it is told only. The limit of a reason stands
//! where the reason does. Reasons are structure in the residual of moving samples
//! ([`crate::evidence::residual`]), a structure that was found but has no name, something at
//! reversals that is none of the three shapes, and a motor and a load that move apart otherwise
//! than by a gap, a stiffness or a pitch error.

use crate::evidence::difference::Difference;
use crate::evidence::thresholds::{APART_COUNTS, APART_UM};
use crate::record::dataset::Dataset;

/// One thing that is left.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Reason {
    /// In words, what it looks like.
    pub words: String,
    /// Whether it makes the record `unexplained`.
    pub counts: bool,
}

impl Reason {
    /// Something that no effect explains.
    pub(crate) fn unexplained(words: impl Into<String>) -> Self {
        Self {
            words: words.into(),
            counts: true,
        }
    }

    /// Something that is too small to count, or explained otherwise; it is told.
    pub(crate) fn told(words: impl Into<String>) -> Self {
        Self {
            words: words.into(),
            counts: false,
        }
    }
}

/// The judgement of the whole.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Verdict {
    /// Whether the extended model explains the record.
    pub explained: bool,
    /// In words, what the rest looks like; empty where there is no rest.
    pub looks_like: String,
}

impl Verdict {
    /// The verdict that reasons give; what counts is told first.
    pub(crate) fn of(mut reasons: Vec<Reason>) -> Self {
        reasons.sort_by_key(|reason| !reason.counts);
        let words: Vec<&str> = reasons.iter().map(|reason| reason.words.as_str()).collect();
        Self {
            explained: !reasons.iter().any(|reason| reason.counts),
            looks_like: words.join("; "),
        }
    }

    /// The word of the report.
    pub(crate) const fn word(&self) -> &'static str {
        if self.explained {
            "explained"
        } else {
            "unexplained"
        }
    }
}

/// Motor and load that keep a difference which no encoder makes; a gap excuses it.
pub(crate) fn of_difference(
    dataset: &Dataset,
    difference: &Difference,
    has_gap: bool,
) -> Option<Reason> {
    let apart = moves_apart(dataset, difference) && !has_gap;
    apart.then(|| {
        Reason::unexplained(
            "motor and load that move apart otherwise than by a gap, a stiffness or a pitch error",
        )
    })
}

/// Whether motor and load keep a difference that no encoder makes.
fn moves_apart(dataset: &Dataset, difference: &Difference) -> bool {
    let count = dataset
        .resolution
        .max(dataset.load_resolution)
        .max(f64::MIN_POSITIVE);
    let counts = 1.0e-6 * difference.after_um / count;
    difference.after_um > APART_UM && counts > APART_COUNTS
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::made;

    #[test]
    fn a_reason_that_counts_makes_a_record_unexplained_and_is_told_first() {
        let [counts, told] = [Reason::unexplained("a spring"), Reason::told("a ripple")];
        let verdict = |reasons: &[&Reason]| {
            let verdict = Verdict::of(reasons.iter().map(|reason| (*reason).clone()).collect());
            (verdict.word(), verdict.looks_like)
        };
        assert_eq!(verdict(&[]), ("explained", String::new()));
        assert_eq!(verdict(&[&told]), ("explained", "a ripple".into()));
        assert_eq!(verdict(&[&counts]), ("unexplained", "a spring".into()));
        let both = ("unexplained", "a spring; a ripple".into());
        assert_eq!(verdict(&[&told, &counts]), both);
    }

    #[test]
    fn a_gap_excuses_a_difference() {
        let mut difference = Difference::default();
        difference.after_um = 50.0;
        let dataset = made::dataset(made::record(1.0e-3, made::two_sines(10)), None);
        let reason = |has_gap| of_difference(&dataset, &difference, has_gap);
        assert!(reason(false).is_some_and(|reason| reason.counts));
        assert_eq!(reason(true), None);
    }

    /// A difference counts beyond 3 µm *and* ten counts of the coarser encoder.
    #[test]
    fn motor_and_load_move_apart_beyond_both_limits_only() {
        let table = [
            // µm left, counts of motor and load in µm, apart
            (3.5, [0.1, 0.34], true),
            (2.9, [0.1, 0.1], false),
            (3.0, [0.1, 0.1], false),
            (3.5, [0.1, 0.36], false),
            (3.5, [0.36, 0.1], false),
            (50.0, [4.9, 0.0], true),
        ];
        for (after_um, [motor_um, load_um], apart) in table {
            let record = made::record(1.0e-3, made::two_sines(10));
            let dataset = Dataset {
                resolution: 1.0e-6 * motor_um,
                load_resolution: 1.0e-6 * load_um,
                ..made::dataset(record, None)
            };
            let mut difference = Difference::default();
            difference.after_um = after_um;
            let case = format!("{after_um} µm, counts of {motor_um} and {load_um} µm");
            assert_eq!(moves_apart(&dataset, &difference), apart, "{case}");
        }
    }
}
