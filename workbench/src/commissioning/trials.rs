//! What is tried against the burst on the circle, and what of it is taken: the best that makes no
//! circle at another feed worse, and nothing where nothing helps.

use identification::Identification;
use serde::Serialize;

use super::feeds::{Feeds, OtherFeeds};
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
    /// Why it was not taken where it makes a circle at another feed worse.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub harm: Option<String>,
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
    /// Circles at other feeds with it.
    pub feeds: Feeds,
    /// What leaves less of the circle, but makes it worse at another feed: names and sentences.
    pub harmful: Vec<(&'static str, String)>,
}

impl Trials {
    /// In a few words for `summary.json`.
    #[must_use]
    pub fn summaries(&self) -> Vec<TrialSummary> {
        let of = |trial: &Trial| {
            let [burst_before_um, burst_after_um] = trial.tuned.largest_um();
            let mut harmful = self.harmful.iter();
            let harm = harmful.find(|(method, _)| *method == trial.method);
            TrialSummary {
                harm: harm.map(|(_, harm)| harm.clone()),
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
    let all = tried(stand, circle, declared, results)?;
    progress::step("circles at other feeds");
    let others = OtherFeeds::run(stand, circle)?;
    let trials = chosen(all, stand.uncompensated(), |own| others.with(own))?;
    for (method, harm) in &trials.harmful {
        say!("{}", not_taken(method, harm));
    }
    Ok(trials)
}

/// Why a method is not taken, in a sentence.
#[must_use]
pub fn not_taken(method: &str, harm: &str) -> String {
    format!("Not taken: {method}; {harm}.")
}

fn tried(
    stand: &Stand<'_>,
    circle: &Circle,
    declared: &[Identification],
    results: &[Identification],
) -> Outcome<Vec<Trial>> {
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
            method: EXTENDED,
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
    Ok(all)
}

/// The name of the model with what was found, where anything was.
pub const EXTENDED: &str = "model";
/// The name of the model without what was found.
pub const DECLARED: &str = "model, declared";
/// The name of a model that the drives refine.
pub const SELF_TUNED: &str = "model + self-tuning";

/// A model by all that is known of the axis may leave so much more than anything else, as a share:
/// pitch errors and squareness are in a burst as well, and hide what is left of friction.
const ALIKE: f64 = 0.02;
/// One that the drives refine follows slow change, and may leave so much more beyond that, µm.
const WORTH_UM: f64 = 0.2;

/// What leaves more than this share of the burst does not help: noise alone does as much.
const LEFT_AT_MOST: f64 = 0.9;

/// The one that leaves the smallest burst, where there is one that leaves less of it and makes no
/// other feed worse; a model that is refined may leave a little more.
fn chosen(
    all: Vec<Trial>,
    nothing: Vec<AxisCompensation>,
    at_other_feeds: impl Fn(&[AxisCompensation]) -> Outcome<Feeds>,
) -> Outcome<Trials> {
    let mut harmful = Vec::new();
    for trial in by_what_is_left(&all) {
        let taken = trial.tuned.compensation.clone();
        let feeds = at_other_feeds(&taken)?;
        let Some(harm) = feeds.harm() else {
            let method = trial.method;
            return Ok(Trials {
                all,
                taken,
                method,
                feeds,
                harmful,
            });
        };
        harmful.push((trial.method, harm));
    }
    Ok(Trials {
        all,
        feeds: at_other_feeds(&nothing)?,
        taken: nothing,
        method: "none",
        harmful,
    })
}

/// Those that help, the best first.
fn by_what_is_left(all: &[Trial]) -> Vec<&Trial> {
    let helps = |trial: &&Trial| {
        let [before, after] = trial.tuned.largest_um();
        before >= LEAST_PEAK_UM && after < LEFT_AT_MOST * before
    };
    let left = |trial: &Trial| {
        let [_, left_um] = trial.tuned.largest_um();
        match trial.method {
            SELF_TUNED => (1.0 - ALIKE) * left_um - WORTH_UM,
            EXTENDED => (1.0 - ALIKE) * left_um,
            _ => left_um,
        }
    };
    let mut helping: Vec<&Trial> = all.iter().filter(helps).collect();
    helping.sort_by(|one, other| left(one).total_cmp(&left(other)));
    helping
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

    /// What is taken of trials that do no harm at other feeds.
    fn taken_of(all: Vec<Trial>, nothing: Vec<AxisCompensation>) -> Trials {
        chosen(all, nothing, |_| Ok(Feeds::default())).unwrap()
    }

    #[test]
    fn the_best_is_taken_and_nothing_where_nothing_helps() {
        let two = vec![trial("pulse", 1.0, 4.0), trial("model", 2.0, 3.0)];
        let trials = taken_of(two, Vec::new());
        assert_eq!(trials.method, "model");
        assert_eq!(trials.taken, trials.all[1].tuned.compensation);
        assert_eq!(trials.circles(), 4);
        for (refined_um, method) in [(3.1, SELF_TUNED), (3.3, "model")] {
            let both = vec![trial("model", 1.0, 3.0), trial(SELF_TUNED, 2.0, refined_um)];
            assert_eq!(taken_of(both, Vec::new()).method, method);
        }
        for (extended_um, method) in [(7.3, EXTENDED), (7.5, "pulse")] {
            let beside_pitch = vec![
                trial(DECLARED, 1.0, 7.22),
                trial(EXTENDED, 2.0, extended_um),
                trial("pulse", 3.0, 7.2),
            ];
            assert_eq!(taken_of(beside_pitch, Vec::new()).method, method);
        }
        let worse = vec![trial("pulse", 1.0, 9.5), trial("model", 2.0, 30.0)];
        let nothing = vec![AxisCompensation::default()];
        let trials = taken_of(worse, nothing.clone());
        assert_eq!(trials.summaries()[1].burst_after_um, 30.0);
        assert_eq!((trials.method, trials.taken), ("none", nothing));
    }

    #[test]
    fn what_makes_another_feed_worse_is_not_taken() {
        let nothing = vec![AxisCompensation::default()];
        let taken_with = |harmful: &'static [&'static str]| {
            let two = vec![trial("pulse", 1.0, 2.0), trial("model", 2.0, 3.0)];
            let harm = two.clone().into_iter();
            let harm: Vec<_> = harm
                .filter(|own| harmful.contains(&own.method))
                .map(|own| own.tuned.compensation)
                .collect();
            let at_other_feeds = |own: &[AxisCompensation]| {
                let is_harmful = harm.iter().any(|harm| harm == own);
                Ok(Feeds::with_spike([8.0, if is_harmful { 9.1 } else { 8.9 }]))
            };
            chosen(two, nothing.clone(), at_other_feeds).unwrap()
        };
        for (harmful, method) in [
            ([].as_slice(), "pulse"),
            (&["pulse"], "model"),
            (&["pulse", "model"], "none"),
        ] {
            let trials = taken_with(harmful);
            assert_eq!(trials.method, method);
            let summaries = trials.summaries().into_iter();
            let told = summaries.filter(|own| own.harm.is_some()).count();
            assert_eq!(told, harmful.len());
            let names: Vec<&str> = trials.harmful.iter().map(|(name, _)| *name).collect();
            assert_eq!(names, harmful);
            for (_, harm) in &trials.harmful {
                let said = "at F 500 mm/min the reversal spike would be 9.10 instead of 8.00 µm";
                assert_eq!(harm, said);
            }
        }
    }
}
