//! The steps of an identification, for those who wait for it.
//!
//! Each step knows the share of the work that is done when it begins. The shares are those of a
//! record of 25 000 rows with everything at its reversals (Stribeck, ripple, presliding, known
//! controller), one core; what takes longer on another record makes them a guess, never a lie: they
//! only grow. Time is the listener's: nothing here has a clock.

use std::fmt;

/// What is being done.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// The declared model is fitted.
    Declared,
    /// Candidate effects are scored.
    Candidates,
    /// An effect came in; more are looked for.
    Found {
        /// Which one.
        effect: String,
        /// How much of the held-out residual it removes, percent.
        percent: f64,
        /// Effects that came in before it.
        round: usize,
    },
    /// The difference of motor and load is looked at.
    MotorAndLoad,
    /// Reversals are simulated with rigid friction.
    Rigid,
    /// With a bristle.
    Bristle,
    /// With a gap.
    Gap,
    /// With a bristle behind a gap.
    BristleAndGap,
    /// Both models are judged on both records.
    Validating,
    /// All rows of a long record are judged and predicted.
    AllRows,
}

impl Step {
    /// Share of the work that is done when the step begins, 0…1.
    #[must_use]
    pub fn done(&self) -> f64 {
        match self {
            Self::Declared | Self::Candidates => 0.0,
            // Half of what is left of the selection's share with every effect.
            Self::Found { round, .. } => 0.18 * (1.0 - 0.5_f64.powi(*round as i32 + 1)),
            Self::MotorAndLoad => 0.18,
            Self::Rigid => 0.20,
            Self::Bristle => 0.26,
            Self::Gap => 0.36,
            Self::BristleAndGap => 0.75,
            Self::Validating => 0.90,
            Self::AllRows => 0.93,
        }
    }
}

impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Declared => "fitting the declared model",
            Self::Candidates => "scoring candidate effects",
            Self::Found {
                effect, percent, ..
            } => {
                return write!(
                    f,
                    "{effect} removes {percent:.0} % of the held-out residual"
                );
            }
            Self::MotorAndLoad => "looking at motor and load",
            Self::Rigid => "simulating reversals: stick",
            Self::Bristle => "simulating reversals: bristle",
            Self::Gap => "simulating reversals: gap",
            Self::BristleAndGap => "simulating reversals: a bristle behind a gap",
            Self::Validating => "validating",
            Self::AllRows => "judging all rows",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_that_is_done_only_grows() {
        let found = |round| Step::Found {
            effect: "stribeck".into(),
            percent: 59.4,
            round,
        };
        let steps = [
            Step::Declared,
            Step::Candidates,
            found(0),
            found(7),
            Step::MotorAndLoad,
            Step::Rigid,
            Step::Bristle,
            Step::Gap,
            Step::BristleAndGap,
            Step::Validating,
            Step::AllRows,
        ];
        assert!(
            steps
                .windows(2)
                .all(|pair| pair[0].done() <= pair[1].done())
        );
        assert!(steps.iter().all(|step| (0.0..1.0).contains(&step.done())));
        assert_eq!(
            found(0).to_string(),
            "stribeck removes 59 % of the held-out residual"
        );
    }
}
