//! Explained or not, and in words what is left.
//!
//! Four things can be left: a structure that was found but has no name, structure in the residual
//! of moving samples, something at reversals that is none of the three shapes, and a motor and a
//! load that move apart otherwise than by a gap, a stiffness or a pitch error. Structure in the
//! residual is always told, but it counts only where it matters to the axis: a share of the
//! residual ([`UNEXPLAINED_SHARE`]) *and* of the effort ([`UNEXPLAINED_PERCENT`]).
//!
//! A gap excuses the residual and the difference. Impacts in a gap leave structure in the force
//! that no column of an inverse model can have.

use crate::evidence::difference::Difference;
use crate::evidence::inverse_dynamics::{Compared, Judgement};
use crate::evidence::residual::{self, Structure};
use crate::evidence::selection::Scored;
use crate::evidence::thresholds::{
    APART_COUNTS, APART_UM, UNEXPLAINED_PERCENT, UNEXPLAINED_SHARE, WHITE_SHARE,
};
use crate::model::name::Called;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;

/// Structure in the residual of moving samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ResidualStructure {
    /// Share of the residual's variance that features or a candidate explain on held-out blocks.
    pub share: Compared<f64>,
    /// What the extended model's residual goes with most.
    pub over: &'static str,
}

impl ResidualStructure {
    /// The share of a model is the larger of the features' and of the best physical candidate's: of
    /// the first round for the declared model, of the last round for the extended one.
    pub(crate) fn of(motion: &Kinematics, train: &Compared<Judgement>, scored: &[Scored]) -> Self {
        let structures = train.each(|judged| residual::structures(motion, &judged.residual));
        let last = scored.iter().map(|scored| scored.round).max().unwrap_or(0);
        let share = |list: &[Structure], round: usize| {
            let features = list.first().map_or(0.0, |structure| structure.share);
            features.max(best_of_round(scored, round))
        };
        Self {
            share: Compared {
                declared: share(&structures.declared, 0),
                extended: share(&structures.extended, last),
            },
            over: structures
                .extended
                .first()
                .map_or("", |structure| structure.over),
        }
    }

    /// Whether too little is left to speak of.
    pub(crate) fn is_white(&self) -> Compared<bool> {
        self.share.each(|share| *share < WHITE_SHARE)
    }
}

fn best_of_round(scored: &[Scored], round: usize) -> f64 {
    let of_round = scored
        .iter()
        .filter(|scored| scored.round == round && scored.physical);
    of_round.map(|scored| scored.gain.share).fold(0.0, f64::max)
}

/// Whether motor and load keep a difference that no encoder makes.
pub(crate) fn moves_apart(dataset: &Dataset, difference: &Difference) -> bool {
    let count = dataset
        .resolution
        .max(dataset.load_resolution)
        .max(f64::MIN_POSITIVE);
    let counts = 1.0e-6 * difference.after_um / count;
    difference.after_um > APART_UM && counts > APART_COUNTS
}

/// What is left when every stage has spoken.
#[derive(Clone, Debug)]
pub(crate) struct Left<'a> {
    /// Structures that were found and have no name.
    pub nameless: &'a [Called],
    /// Structure in the residual of moving samples.
    pub residual: ResidualStructure,
    /// Force error of the extended model, percent.
    pub force_percent: f64,
    /// Something at reversals that is neither stick nor a bristle nor a gap.
    pub at_reversals: bool,
    /// Motor and load keep a difference.
    pub apart: bool,
    /// A gap was found or is declared.
    pub has_gap: bool,
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
    /// Judges what is left.
    pub(crate) fn of(left: &Left<'_>) -> Self {
        let apart = left.apart && !left.has_gap;
        let explained =
            !(left.matters() || !left.nameless.is_empty() || left.at_reversals || apart);
        Self {
            explained,
            looks_like: left.words(apart).join("; "),
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

impl Left<'_> {
    /// Whether the structure in the residual is large for the residual and for the axis.
    fn matters(&self) -> bool {
        let share = self.residual.share.extended;
        let percent_left = self.force_percent * share.sqrt();
        share >= UNEXPLAINED_SHARE && percent_left >= UNEXPLAINED_PERCENT && !self.has_gap
    }

    fn words(&self, apart: bool) -> Vec<String> {
        let share = self.residual.share.extended;
        let mut parts: Vec<String> = self
            .nameless
            .iter()
            .map(|name| format!("a {name}"))
            .collect();
        if share >= WHITE_SHARE && !self.residual.over.is_empty() {
            parts.push(format!(
                "structure over {} ({:.0} % of the residual)",
                self.residual.over,
                100.0 * share
            ));
        }
        if self.at_reversals {
            parts.push(
                "structure at reversals that is neither stick nor a bristle nor a gap".into(),
            );
        }
        if apart {
            parts.push(
                "motor and load that move apart otherwise than by a gap, a stiffness or a pitch error"
                    .into(),
            );
        }
        parts
    }
}

#[cfg(test)]
mod tests {
    use axis_model::EffectName;

    use super::*;
    use crate::fit::blocks::Gain;
    use crate::fit::made::{axis, usual};
    use crate::simulate::made;

    fn nothing_left() -> Left<'static> {
        Left {
            nameless: &[],
            residual: ResidualStructure {
                share: Compared {
                    declared: 0.6,
                    extended: 0.01,
                },
                over: "position",
            },
            force_percent: 1.0,
            at_reversals: false,
            apart: false,
            has_gap: false,
        }
    }

    fn residual(share: f64) -> ResidualStructure {
        ResidualStructure {
            share: Compared {
                declared: 0.6,
                extended: share,
            },
            over: "position",
        }
    }

    #[test]
    fn each_finding_gives_its_verdict_and_its_words() {
        let reversals = "structure at reversals that is neither stick nor a bristle nor a gap";
        let load =
            "motor and load that move apart otherwise than by a gap, a stiffness or a pitch error";
        let none = nothing_left;
        let table = [
            (none(), true, ""),
            (
                Left {
                    nameless: &[Called::Structure("force over time")],
                    ..none()
                },
                false,
                "a force over time",
            ),
            // Told, but too small a share of the residual.
            (
                Left {
                    residual: residual(0.14),
                    ..none()
                },
                true,
                "structure over position (14 % of the residual)",
            ),
            // 1 % · √0.16 = 0.4 % of the effort.
            (
                Left {
                    residual: residual(0.16),
                    ..none()
                },
                false,
                "structure over position (16 % of the residual)",
            ),
            // 0.7 % · √0.16 = 0.28 % of the effort does not matter to the axis.
            (
                Left {
                    residual: residual(0.16),
                    force_percent: 0.7,
                    ..none()
                },
                true,
                "structure over position (16 % of the residual)",
            ),
            (
                Left {
                    residual: residual(0.16),
                    has_gap: true,
                    ..none()
                },
                true,
                "structure over position (16 % of the residual)",
            ),
            (
                Left {
                    at_reversals: true,
                    has_gap: true,
                    ..none()
                },
                false,
                reversals,
            ),
            (
                Left {
                    apart: true,
                    ..none()
                },
                false,
                load,
            ),
            (
                Left {
                    apart: true,
                    has_gap: true,
                    ..none()
                },
                true,
                "",
            ),
        ];
        for (left, explained, words) in table {
            let wanted = Verdict {
                explained,
                looks_like: words.into(),
            };
            assert_eq!(Verdict::of(&left), wanted, "{left:?}");
        }
    }

    #[test]
    fn the_word_of_the_report_is_explained_or_unexplained() {
        let word = |at_reversals| {
            let left = Left {
                at_reversals,
                ..nothing_left()
            };
            Verdict::of(&left).word()
        };
        assert_eq!([false, true].map(word), ["explained", "unexplained"]);
    }

    #[test]
    fn what_is_left_is_told_in_the_order_of_the_stages() {
        let left = Left {
            nameless: &[
                Called::Structure("force over position"),
                Called::Structure("drifting force"),
            ],
            residual: residual(0.2),
            at_reversals: true,
            apart: true,
            ..nothing_left()
        };
        let words = Verdict::of(&left).looks_like;
        let parts: Vec<&str> = words.split("; ").collect();
        assert_eq!(parts.len(), 5, "{words}");
        assert_eq!(parts[..2], ["a force over position", "a drifting force"]);
        assert!(parts[2].starts_with("structure over position (20 %"));
        assert!(parts[3].starts_with("structure at reversals"));
        assert!(parts[4].starts_with("motor and load"));
    }

    fn scored(round: usize, share: f64, physical: bool) -> Scored {
        Scored {
            effect: EffectName::Delay.into(),
            parameter: 1.0e-3,
            gain: Gain {
                removed: 1.0,
                share,
                percent: 1.0,
                t: 5.0,
            },
            physical,
            accepted: false,
            round,
        }
    }

    /// A judgement with a residual that follows a law of the row.
    fn leaving(rows: usize, law: impl Fn(usize) -> f64) -> Judgement {
        Judgement {
            force_percent: 1.0,
            reversal_rms: 0.0,
            residual: (0..rows).map(law).collect(),
            prediction: Vec::new(),
        }
    }

    #[test]
    fn the_share_of_a_model_is_the_larger_of_features_and_the_best_candidate_of_its_round() {
        let motion = axis(usual).motion;
        let noise = |row: usize| (1.7 * (row * row % 1013) as f64).sin();
        let train = Compared {
            declared: leaving(motion.len(), noise),
            extended: leaving(motion.len(), |row| (motion.time_s[row] - 3.0).powi(2)),
        };
        let of = |scored: &[Scored]| ResidualStructure::of(&motion, &train, scored);
        let alone = of(&[]);
        assert_eq!(alone.over, "time");
        assert!(alone.share.declared < 0.02 && alone.share.extended > 0.9);
        // The declared model is judged by the first round, the extended one by the last.
        let judged = of(&[
            scored(0, 0.3, true),
            scored(1, 0.9999, true),
            scored(2, 0.9995, true),
        ]);
        assert_eq!(
            (judged.share.declared, judged.share.extended),
            (0.3, 0.9995)
        );
        let weak = of(&[scored(0, 0.999, true), scored(1, 0.2, true)]);
        assert_eq!(weak.share.declared, 0.999);
        assert_eq!(weak.share.extended, alone.share.extended);
    }

    #[test]
    fn the_best_candidate_of_a_round_is_the_largest_that_can_be_its_effect() {
        let list = [
            scored(0, 0.4, true),
            scored(0, 0.7, true),
            scored(0, 0.9, false),
            scored(1, 0.2, true),
            scored(2, -0.1, true),
        ];
        let best = [0, 1, 2, 3].map(|round| best_of_round(&list, round));
        assert_eq!(best, [0.7, 0.2, 0.0, 0.0]);
    }

    #[test]
    fn a_residual_is_white_below_the_share_of_the_smallest_accepted_effect() {
        let left = ResidualStructure {
            share: Compared {
                declared: 0.05,
                extended: 0.0499,
            },
            over: "time",
        };
        let white = left.is_white();
        assert!(!white.declared && white.extended);
    }

    #[test]
    fn a_residual_matters_from_both_limits_on() {
        let matters = |share: f64, force_percent: f64| {
            let residual = residual(share);
            let left = Left {
                residual,
                force_percent,
                ..nothing_left()
            };
            left.matters()
        };
        assert!(matters(0.15, 10.0) && !matters(0.1499, 10.0));
        // √0.25 of 0.6 % are 0.3 % of the effort.
        assert!(matters(0.25, 0.6) && !matters(0.25, 0.599));
    }

    #[test]
    fn words_begin_at_a_share_of_a_twentieth() {
        let words = |share: f64| {
            let residual = residual(share);
            let left = Left {
                residual,
                ..nothing_left()
            };
            left.words(false).len()
        };
        assert_eq!((words(0.05), words(0.0499)), (1, 0));
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
