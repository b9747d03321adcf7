//! Explained or not, and in words what is left.
//!
//! Every stage gives its reasons: what it saw that no accepted effect explains. A reason either
//! counts, and then the record is `unexplained`, or it is told only. The limit of a reason stands
//! where the reason does. Reasons are structure in the residual of moving samples
//! ([`crate::evidence::residual`]), a structure that was found but has no name, something at
//! reversals that is none of the three shapes, and a motor and a load that move apart otherwise
//! than by a gap, a stiffness or a pitch error ([`crate::evidence::difference`]).

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

#[cfg(test)]
mod tests {
    use super::*;

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
}
