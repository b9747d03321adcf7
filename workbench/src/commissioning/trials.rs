//! What is tried against the burst on the circle, and what of it is taken: the best, and nothing
//! where nothing helps.

use identification::Identification;
use serde::Serialize;

use crate::compensation::AxisCompensation;
use crate::console;
use crate::error::Outcome;
use crate::progress;
use crate::say;
use crate::session::Stand;
use crate::trajectory::Circle;
use crate::tuning::{self, LEAST_PEAK_UM, Tuned};

/// A compensation that was tried.
#[derive(Clone, Debug)]
pub struct Trial {
    /// Its name.
    pub method: &'static str,
    /// What came of it.
    pub tuned: Tuned,
}

/// A trial in `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub struct TrialSummary {
    /// Its name.
    pub method: &'static str,
    /// Largest burst without it, µm.
    pub burst_before_um: f64,
    /// Largest burst with it, µm.
    pub burst_after_um: f64,
    /// Circles that it took.
    pub circles: u32,
}

/// What was tried and what was taken.
#[derive(Clone, Debug)]
pub struct Trials {
    /// In the order in which they were tried.
    pub all: Vec<Trial>,
    /// What the drive gets.
    pub taken: Vec<AxisCompensation>,
    /// Its name; `none` where nothing helps.
    pub method: &'static str,
}

impl Trials {
    /// In a few words for `summary.json`.
    #[must_use]
    pub fn summaries(&self) -> Vec<TrialSummary> {
        let of = |trial: &Trial| {
            let [burst_before_um, burst_after_um] = trial.tuned.largest_um();
            TrialSummary {
                method: trial.method,
                burst_before_um,
                burst_after_um,
                circles: trial.tuned.circles,
            }
        };
        self.all.iter().map(of).collect()
    }

    /// Circles that all of them took.
    #[must_use]
    pub fn circles(&self) -> u32 {
        self.all.iter().map(|trial| trial.tuned.circles).sum()
    }
}

/// Tries the tuned pulse, the model of friction that was declared, and that with what was found;
/// `declared` is empty where nothing was found.
///
/// # Errors
/// Where a circle cannot be run, or the operator interrupts.
pub fn run(
    stand: &Stand<'_>,
    circle: &Circle,
    declared: &[Identification],
    results: &[Identification],
) -> Outcome<Trials> {
    let mut all = Vec::new();
    progress::step("tuning the pulse on circles");
    if let Some(tuned) = tuning::pulse(stand, circle, 0.0)? {
        all.push(Trial {
            method: "pulse",
            tuned,
        });
    }
    if !declared.is_empty() {
        progress::step("the declared model of friction on a circle");
        let tuned = tuning::model(stand, circle, declared)?;
        all.extend(tuned.map(|tuned| Trial {
            method: DECLARED,
            tuned,
        }));
    }
    progress::step("the model of friction on a circle");
    if let Some(tuned) = tuning::model(stand, circle, results)? {
        progress::step("the drives refine the model on circles at several feeds");
        let refined = tuning::self_tuning::refined(stand, circle, &tuned)?;
        all.push(Trial {
            method: "model",
            tuned,
        });
        all.extend(refined.map(|tuned| Trial {
            method: SELF_TUNED,
            tuned,
        }));
    }
    for trial in &all {
        say!("{}:", trial.method);
        console::print_tuned(&stand.axis_names(), &trial.tuned);
    }
    Ok(chosen(all, stand.uncompensated()))
}

/// The name of the model without what was found.
pub const DECLARED: &str = "model, declared";
/// The name of a model that the drives refine.
pub const SELF_TUNED: &str = "model + self-tuning";

/// A model that the drives refine follows slow change, and may leave so much more than the best,
/// µm.
const WORTH_UM: f64 = 0.2;

/// What leaves more than this share of the burst does not help: noise alone does as much.
const LEFT_AT_MOST: f64 = 0.9;

/// The one that leaves the smallest burst, where there is one and it leaves less of it; a model
/// that is refined may leave a little more.
fn chosen(all: Vec<Trial>, nothing: Vec<AxisCompensation>) -> Trials {
    let helps = |trial: &&Trial| {
        let [before, after] = trial.tuned.largest_um();
        before >= LEAST_PEAK_UM && after < LEFT_AT_MOST * before
    };
    let left = |trial: &&Trial| {
        let worth_um = if trial.method == SELF_TUNED {
            WORTH_UM
        } else {
            0.0
        };
        trial.tuned.largest_um()[1] - worth_um
    };
    let best = all
        .iter()
        .filter(helps)
        .min_by(|one, other| left(one).total_cmp(&left(other)));
    let (taken, method) = best.map_or((nothing, "none"), |trial| {
        (trial.tuned.compensation.clone(), trial.method)
    });
    Trials { all, taken, method }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensation::Compensation;

    fn trial(method: &'static str, force_n: f64, after_um: f64) -> Trial {
        let own = AxisCompensation {
            reversal: Compensation::Coulomb { force_n },
            backlash_m: 0.0,
        };
        Trial {
            method,
            tuned: Tuned {
                compensation: vec![own],
                before_um: [10.0, 9.0],
                after_um: [1.0, after_um],
                circles: 2,
            },
        }
    }

    #[test]
    fn the_best_is_taken_and_nothing_where_nothing_helps() {
        let two = vec![trial("pulse", 1.0, 4.0), trial("model", 2.0, 3.0)];
        let trials = chosen(two, Vec::new());
        assert_eq!(trials.method, "model");
        assert_eq!(trials.taken, trials.all[1].tuned.compensation);
        assert_eq!(trials.circles(), 4);
        for (refined_um, method) in [(3.1, SELF_TUNED), (3.3, "model")] {
            let both = vec![trial("model", 1.0, 3.0), trial(SELF_TUNED, 2.0, refined_um)];
            assert_eq!(chosen(both, Vec::new()).method, method);
        }
        let worse = vec![trial("pulse", 1.0, 9.5), trial("model", 2.0, 30.0)];
        let nothing = vec![AxisCompensation::default()];
        let trials = chosen(worse, nothing.clone());
        assert_eq!(trials.summaries()[1].burst_after_um, 30.0);
        assert_eq!((trials.method, trials.taken), ("none", nothing));
    }
}
