//! How much structure is left in a residual.
//!
//! Rows are correlated, so no row-wise whiteness test is honest. Judged instead by the share of the
//! residual's variance that general features (velocity by direction, position, time: piecewise
//! linear) explain on held-out blocks, and by the share of the best single candidate; the larger of
//! the two counts. General features alone miss ripple and delay, and over-fit into negative shares.

use crate::evidence::inverse_dynamics::{Compared, Judgement};
use crate::evidence::selection::Scored;
use crate::evidence::thresholds::{UNEXPLAINED_PERCENT, UNEXPLAINED_SHARE, WHITE_SHARE};
use crate::evidence::verdict::Reason;
use crate::fit::blocks::Blocks;
use crate::motion::kinematics::Kinematics;

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
        let structures = train.each(|judged| structures(motion, &judged.residual));
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

    /// What it says of an extended model with such a force error, percent; a gap excuses it, since
    /// impacts leave structure in the force that no column of an inverse model can have.
    pub(crate) fn reason(&self, force_percent: f64, has_gap: bool) -> Option<Reason> {
        let share = self.share.extended;
        let percent_left = force_percent * share.sqrt();
        let counts = share >= UNEXPLAINED_SHARE && percent_left >= UNEXPLAINED_PERCENT && !has_gap;
        let words = format!(
            "structure over {} ({:.0} % of the residual)",
            self.over,
            100.0 * share
        );
        let is_seen = share >= WHITE_SHARE && !self.over.is_empty();
        if counts {
            Some(Reason::unexplained(words))
        } else {
            is_seen.then(|| Reason::told(words))
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

/// Features of one kind.
#[derive(Clone, Debug)]
pub(crate) struct Structure {
    /// Over what.
    pub over: &'static str,
    /// Share of the residual's variance on held-out blocks, floored at zero.
    pub share: f64,
}

/// Shares by kind of feature, largest first.
#[must_use]
pub(crate) fn structures(motion: &Kinematics, residual: &[f64]) -> Vec<Structure> {
    let forwards = split(&motion.velocity_lp, 1.0);
    let backwards = split(&motion.velocity_lp, -1.0);
    let kinds: [(&'static str, Vec<Vec<f64>>); 3] = [
        (
            "velocity by direction",
            [hats(&forwards, motion, 8), hats(&backwards, motion, 8)].concat(),
        ),
        ("position", hats(&motion.position_lp, motion, 12)),
        ("time", hats(&motion.time_s, motion, 8)),
    ];
    let mut shares: Vec<Structure> = kinds
        .into_iter()
        .map(|(over, columns)| Structure {
            over,
            share: share(motion, residual, &columns),
        })
        .collect();
    shares.sort_by(|a, b| b.share.total_cmp(&a.share));
    shares
}

fn split(values: &[f64], sign: f64) -> Vec<f64> {
    values
        .iter()
        .map(|v| if v * sign > 0.0 { *v } else { f64::NAN })
        .collect()
}

/// Piecewise linear features with knots at quantiles of the moving samples; `NaN` stands outside.
fn hats(values: &[f64], motion: &Kinematics, count: usize) -> Vec<Vec<f64>> {
    let moving = values
        .iter()
        .zip(&motion.moving)
        .filter(|(v, moving)| **moving && v.is_finite());
    let mut sorted: Vec<f64> = moving.map(|(v, _)| *v).collect();
    sorted.sort_by(f64::total_cmp);
    if sorted.len() < 100 {
        return Vec::new();
    }
    let mut knots: Vec<f64> = (0..count)
        .map(|i| sorted[i * (sorted.len() - 1) / (count - 1)])
        .collect();
    knots.dedup_by(|a, b| (*a - *b).abs() <= 1.0e-12);
    (0..knots.len())
        .map(|at| values.iter().map(|v| hat(&knots, at, *v)).collect())
        .collect()
}

fn hat(knots: &[f64], at: usize, value: f64) -> f64 {
    if !value.is_finite() {
        return 0.0;
    }
    let rise = at.checked_sub(1).map_or(
        if value <= knots[at] {
            1.0
        } else {
            f64::INFINITY
        },
        |left| (value - knots[left]) / (knots[at] - knots[left]),
    );
    let fall = knots.get(at + 1).map_or(
        if value >= knots[at] {
            1.0
        } else {
            f64::INFINITY
        },
        |right| (right - value) / (right - knots[at]),
    );
    rise.min(fall).clamp(0.0, 1.0)
}

fn share(motion: &Kinematics, residual: &[f64], columns: &[Vec<f64>]) -> f64 {
    if columns.is_empty() {
        return 0.0;
    }
    let views: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    let fit = Blocks::new(&views, residual, &motion.moving, motion.period_s).cross_validate();
    let left: f64 = fit.held_out.iter().sum();
    (1.0 - left / fit.total.max(f64::MIN_POSITIVE)).max(0.0)
}

#[cfg(test)]
mod tests {
    use axis_model::EffectName;

    use super::*;
    use crate::fit::blocks::Gain;
    use crate::fit::made::{axis, usual};

    #[test]
    fn a_hat_is_one_at_its_knot_zero_at_its_neighbours_and_flat_beyond_the_ends() {
        let knots = [1.0, 2.0, 4.0];
        for (at, value, wanted) in [
            (1, 2.0, 1.0),
            (1, 1.5, 0.5),
            (1, 3.0, 0.5),
            (1, 1.0, 0.0),
            (1, 4.5, 0.0),
            (0, 0.0, 1.0),
            (0, 1.25, 0.75),
            (2, 9.0, 1.0),
            (2, 3.5, 0.75),
            (0, f64::NAN, 0.0),
        ] {
            assert!(
                (hat(&knots, at, value) - wanted).abs() < 1.0e-12,
                "{at} {value}"
            );
        }
        // Together they are one everywhere.
        for value in [0.0, 1.3, 2.0, 3.7, 8.0] {
            let sum: f64 = (0..3).map(|at| hat(&knots, at, value)).sum();
            assert!((sum - 1.0).abs() < 1.0e-12);
        }
    }

    #[test]
    fn knots_stand_at_quantiles_of_moving_samples_the_ends_among_them() {
        let mut axis = axis(usual);
        let motion = &mut axis.motion;
        motion.moving.fill(false);
        motion.moving[..701].fill(true);
        // Squares of 0, 1 … 700: a seventh of the samples from knot to knot. Others are outside.
        let squares: Vec<f64> = (0..motion.len()).map(|row| (row as f64).powi(2)).collect();
        let hats = hats(&squares, motion, 8);
        assert_eq!(hats.len(), 8);
        for (at, hat) in hats.iter().enumerate() {
            let ones: Vec<usize> = (0..=700).filter(|row| hat[*row] == 1.0).collect();
            assert_eq!(ones, [100 * at]);
        }
        assert_eq!(hats[7][5000], 1.0);
        // Half way from 100² to 200² are 25 000.
        assert!((hats[1][158] - (40_000.0 - 24_964.0) / 30_000.0).abs() < 1.0e-12);
        assert_eq!(self::hats(&vec![3.0; motion.len()], motion, 8).len(), 1);
    }

    #[test]
    fn values_of_the_other_sign_stand_outside() {
        let forwards = split(&[1.0, -2.0, 0.0], 1.0);
        assert!(forwards[0] == 1.0 && forwards[1].is_nan() && forwards[2].is_nan());
        let backwards = split(&[1.0, -2.0, 0.0], -1.0);
        assert!(backwards[0].is_nan() && backwards[1] == -2.0);
    }

    #[test]
    fn a_residual_goes_most_with_what_made_it() {
        let axis = axis(usual);
        let motion = &axis.motion;
        let first = |law: &dyn Fn(usize) -> f64| {
            let residual: Vec<f64> = (0..motion.len()).map(law).collect();
            let structures = structures(motion, &residual);
            let shares: Vec<f64> = structures.iter().map(|structure| structure.share).collect();
            assert!(shares.windows(2).all(|pair| pair[0] >= pair[1]) && shares.len() == 3);
            (structures[0].over, structures[0].share)
        };
        let (over, share) = first(&|row| motion.velocity_lp[row].abs());
        assert!(
            over == "velocity by direction" && share > 0.95,
            "{over} {share}"
        );
        let (over, share) = first(&|row| motion.position_lp[row].powi(2));
        assert!(over == "position" && share > 0.9, "{over} {share}");
        let (over, share) = first(&|row| (motion.time_s[row] - 3.0).powi(2));
        assert!(over == "time" && share > 0.9, "{over} {share}");
    }

    #[test]
    fn noise_goes_with_nothing_and_no_share_is_negative() {
        let axis = axis(usual);
        let noise = |row: usize| (1.7 * (row * row % 1013) as f64).sin();
        let residual: Vec<f64> = (0..axis.motion.len()).map(noise).collect();
        let structures = structures(&axis.motion, &residual);
        let small = |one: &Structure| (0.0..0.02).contains(&one.share);
        assert!(structures.iter().all(small), "{structures:?}");
    }

    #[test]
    fn a_hundred_moving_samples_are_needed_for_features() {
        let mut axis = axis(usual);
        let moving: Vec<usize> = (0..axis.motion.len())
            .filter(|row| axis.motion.moving[*row])
            .collect();
        let count =
            |axis: &crate::fit::made::Axis| hats(&axis.motion.time_s, &axis.motion, 8).len();
        axis.motion.moving.fill(false);
        moving[..99]
            .iter()
            .for_each(|row| axis.motion.moving[*row] = true);
        assert_eq!(count(&axis), 0);
        axis.motion.moving[moving[99]] = true;
        assert_eq!(count(&axis), 8);
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

    fn structure(share: f64) -> ResidualStructure {
        ResidualStructure {
            share: Compared {
                declared: 0.6,
                extended: share,
            },
            over: "position",
        }
    }

    #[test]
    fn a_residual_counts_from_both_limits_on_and_a_gap_excuses_it() {
        let counts = |share: f64, force_percent: f64, has_gap: bool| {
            let reason = structure(share).reason(force_percent, has_gap);
            reason.is_some_and(|reason| reason.counts)
        };
        assert!(counts(0.15, 10.0, false) && !counts(0.1499, 10.0, false));
        // √0.25 of 0.6 % are 0.3 % of the effort.
        assert!(counts(0.25, 0.6, false) && !counts(0.25, 0.599, false));
        assert!(!counts(0.25, 10.0, true));
    }

    #[test]
    fn a_structure_is_told_from_a_share_of_a_twentieth_on() {
        let words = |share: f64| {
            structure(share)
                .reason(1.0, false)
                .map(|reason| reason.words)
        };
        let wanted = "structure over position (5 % of the residual)";
        assert_eq!(words(0.05).as_deref(), Some(wanted));
        assert_eq!(words(0.0499), None);
    }
}
