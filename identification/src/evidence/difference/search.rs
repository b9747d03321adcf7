//! Searches for a gap and for a pitch error.

use std::ops::Range;

use super::columns::{Apart, FittedWays, Way};
use crate::evidence::few_periods::degree_beside;
use crate::evidence::selection::is_certain;
use crate::evidence::thresholds::{DIFFERENCE_SHARE, FEWEST_COUNTS};
use crate::fit::blocks::{Blocks, Gain};
use crate::fit::plain::Plain;
use crate::fit::rows::Rows;
use crate::fit::search::{descend, smallest};
use crate::model::effects::turning::strongest;
use crate::model::effects::wave;
use crate::model::effects::{geometric, polynomial};
use crate::motion::bodies::minus;
use crate::simulate::load::Behind;

/// Widths that are tried, between the smallest that counts and a hundred times that, or a
/// millimetre.
const WIDTHS: u32 = 24;
/// Shares of the moved mass that stand behind the gap, as tried.
const SHARES: [f64; 5] = [0.02, 0.3, 0.4, 0.5, 0.65];
/// Coefficients of restitution that are tried.
const RESTITUTIONS: [f64; 5] = [0.0, 0.3, 0.5, 0.7, 0.9];
/// First steps of the descent for the width, as shares of it: the grid's, then a narrow one.
const WIDTH_STEPS: [f64; 2] = [0.15, 0.02];

/// What is searched of a gap.
#[derive(Clone, Copy)]
struct Trial {
    gap: f64,
    /// Share of the moved mass behind it.
    share: f64,
    restitution: f64,
}

impl Trial {
    /// The load behind the gap, slowed by all of the friction.
    fn behind(self, plain: &Plain) -> Behind {
        let mass = self.share * plain.inertia;
        Behind {
            gap: self.gap,
            coulomb: plain.coulomb / mass,
            viscous: plain.viscous.max(0.0) / mass,
            restitution: self.restitution,
        }
    }
}

/// The gap that leaves least beside other ways, not narrower than the encoders show.
pub(crate) fn best_gap(apart: &Apart<'_>, ways: &[Way], count: f64) -> Way {
    let narrowest = FEWEST_COUNTS * count;
    let plain = Plain::fit(apart.motion);
    let rows = apart.rows_of(&apart.design(ways));
    let sse = |trial: Trial| left_by(apart, &rows, trial.behind(&plain));
    let mut best = Trial {
        gap: narrowest,
        share: SHARES[2],
        restitution: RESTITUTIONS[0],
    };
    best.gap = smallest(&widths(narrowest), &|gap| sse(Trial { gap, ..best })).unwrap_or(narrowest);
    for step in WIDTH_STEPS {
        best = improved(best, step, narrowest, &sse);
    }
    Way::Play(polished(best, narrowest, &sse).behind(&plain))
}

/// Widths from the narrowest on.
fn widths(narrowest: f64) -> Vec<f64> {
    geometric(narrowest, 1.0e-3_f64.max(100.0 * narrowest), WIDTHS)
}

/// One parameter after the other, from where they stand and in small steps: what the others have
/// come to may ask for another restitution than the grid's.
fn polished(mut best: Trial, narrowest: f64, sse: &(dyn Fn(Trial) -> f64 + Sync)) -> Trial {
    best.restitution = descend(best.restitution, 0.05, (0.0, 0.99), &|restitution| {
        sse(Trial {
            restitution,
            ..best
        })
    });
    let step = 0.005 * best.gap;
    best.gap = descend(best.gap, step, (narrowest, f64::MAX), &|gap| {
        sse(Trial { gap, ..best })
    });
    best.share = descend(best.share, 0.01, (0.01, 0.95), &|share| {
        sse(Trial { share, ..best })
    });
    best
}

/// One parameter after the other.
fn improved(
    mut best: Trial,
    step: f64,
    narrowest: f64,
    sse: &(dyn Fn(Trial) -> f64 + Sync),
) -> Trial {
    best.gap = descend(best.gap, step * best.gap, (narrowest, f64::MAX), &|gap| {
        sse(Trial { gap, ..best })
    });
    best.restitution = smallest(&RESTITUTIONS, &|restitution| {
        sse(Trial {
            restitution,
            ..best
        })
    })
    .unwrap_or(best.restitution);
    best.share = smallest(&SHARES, &|share| sse(Trial { share, ..best })).unwrap_or(best.share);
    best.restitution = descend(best.restitution, 0.1, (0.0, 0.99), &|restitution| {
        sse(Trial {
            restitution,
            ..best
        })
    });
    best.share = descend(best.share, 0.05, (0.01, 0.95), &|share| {
        sse(Trial { share, ..best })
    });
    best
}

/// Sum of squares beside a gap, of the rows of other ways. A gap is as wide as it is: its lag is
/// subtracted, not scaled.
fn left_by(apart: &Apart<'_>, others: &Rows, behind: Behind) -> f64 {
    let lag = apart.columns(Way::Play(behind)).concat();
    Blocks::toward(others, &minus(&apart.target, &lag))
        .fit()
        .sse
}

/// Every so many samples are scanned for a pitch error.
const STRIDE: usize = 8;
/// Fewest periods within the travel of a pitch that is searched: fewer are no pitch, unless the
/// order per revolution is known.
pub(crate) const FEWEST_PERIODS: f64 = 4.0;
/// The same in half periods.
const FEWEST_HALF_PERIODS: usize = 2 * FEWEST_PERIODS as usize;
/// Most half periods that are scanned, and those of a pitch of half a millimetre.
const MOST_HALF_PERIODS: usize = 4000;
const HALF_PERIODS_PER_LENGTH: f64 = 4000.0;

/// The period with the strongest component in what other ways leave.
pub(crate) fn best_pitch(apart: &Apart<'_>, fitted: &FittedWays) -> Option<Way> {
    let (low, high) = apart.motion.span();
    let step = 0.5 / (high - low);
    let residual = apart.residual(fitted);
    let rows = (0..residual.len()).step_by(STRIDE);
    let inside = rows.filter(|row| apart.mask[*row]);
    let samples: Vec<(f64, f64)> = inside
        .map(|row| (apart.path.position[row], residual[row]))
        .collect();
    let scanned = half_periods(high - low);
    let best = strongest(&samples, step * scanned.start as f64, step, scanned.len())?;
    let per_length = strongest(&samples, best - step, step / 8.0, 17)?;
    Some(Way::Pitch { per_length })
}

/// Of the wave numbers of known orders the one that leaves least beside other ways, where it beats
/// what a smooth error over the travel would leave: a scale that stretches, a bed that sags.
pub(crate) fn best_order(apart: &Apart<'_>, ways: &[Way], orders: &[f64]) -> Option<Way> {
    if orders.is_empty() {
        return None;
    }
    let residual = apart.residual(&apart.fit(ways));
    let left = |per_length: f64| {
        let pair = [Way::Constant, Way::Pitch { per_length }];
        apart.blocks_of(&apart.design(&pair), &residual).fit().sse
    };
    let per_length = smallest(orders, &left)?;
    let pitch = Way::Pitch { per_length };
    let degree = degree_beside(wave::periods(apart.motion, per_length), 1);
    let design = [apart.design(ways), smooth(apart, degree)].concat();
    let smooth = apart.blocks_of(&design, &apart.target).cross_validate();
    let fit = apart.cross_validate(&[ways, &[pitch]].concat());
    let gain = Gain::of(&smooth, &fit);
    let in_sample = 1.0 - fit.sse / smooth.sse;
    let is_better = gain.share.min(in_sample) >= DIFFERENCE_SHARE && is_certain(&gain);
    is_better.then_some(pitch)
}

/// Columns of a polynomial over the travel, low-passed.
fn smooth(apart: &Apart<'_>, degree: usize) -> Vec<Vec<f64>> {
    let (low, high) = apart.motion.span();
    let scaled = |x: &f64| ((2.0 * x - low - high) / (high - low), 1.0);
    let columns = polynomial::of_degree(apart.path.position.iter().map(scaled), degree);
    apart.motion.all_low_passed(&columns)
}

/// Half periods within a travel that are scanned.
fn half_periods(travel: f64) -> Range<usize> {
    let most = ((HALF_PERIODS_PER_LENGTH * travel) as usize).min(MOST_HALF_PERIODS);
    FEWEST_HALF_PERIODS..most.max(FEWEST_HALF_PERIODS + 1)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::evidence::difference::Path;
    use crate::fit::made::{Axis, axis, usual};

    fn near(value: f64, wanted: f64, within: f64) {
        assert!((value - wanted).abs() <= within, "{value}, not {wanted}");
    }

    /// An axis with a difference, row by row.
    fn apart_by(difference: Vec<f64>) -> Axis {
        let mut axis = axis(usual);
        axis.motion.difference = Some(difference);
        axis
    }

    fn apart(axis: &Axis) -> Apart<'_> {
        let path = Path {
            position: &axis.dataset.train.position,
            transmitted: &axis.motion.effort_lp,
            hold: axis.dataset.hold,
        };
        Apart::on(&axis.motion, path).unwrap()
    }

    #[test]
    fn all_of_the_friction_slows_the_share_of_the_mass_behind_the_gap() {
        let plain = |viscous| Plain {
            inertia: 90.0,
            viscous,
            coulomb: 27.0,
        };
        let trial = Trial {
            gap: 2.0e-6,
            share: 0.4,
            restitution: 0.3,
        };
        let behind = trial.behind(&plain(180.0));
        assert_eq!((behind.gap, behind.restitution), (2.0e-6, 0.3));
        // 36 kg.
        near(behind.coulomb, 0.75, 1.0e-12);
        near(behind.viscous, 5.0, 1.0e-12);
        assert_eq!(trial.behind(&plain(-180.0)).viscous, 0.0);
    }

    #[test]
    fn widths_reach_a_millimetre_or_a_hundred_times_the_narrowest() {
        for (narrowest, widest) in [(2.0e-7, 1.0e-3), (1.0e-4, 1.0e-2)] {
            let widths = widths(narrowest);
            assert_eq!((widths.len(), widths[0]), (24, narrowest));
            near(widths[23] / widest, 1.0, 1.0e-9);
        }
    }

    #[test]
    fn the_lag_of_a_gap_is_taken_off_the_difference_as_it_is() {
        let behind = |gap: f64| Behind {
            gap,
            coulomb: 0.7,
            viscous: 5.0,
            restitution: 0.3,
        };
        let position = axis(usual).dataset.train.position;
        let axis = apart_by(behind(20.0e-6).follow(&position, 1.0e-3));
        let apart = apart(&axis);
        let others = apart.rows_of(&apart.design(&[Way::Constant]));
        let left = |gap: f64| left_by(&apart, &others, behind(gap));
        let all = apart.blocks(&[Way::Constant]).fit().sse;
        assert!(left(20.0e-6) < 1.0e-9 * all);
        // Half the width leaves about a quarter of the squares, twice the width all of them.
        assert!(
            (0.2..0.4).contains(&(left(10.0e-6) / all)),
            "{}",
            left(10.0e-6) / all
        );
        assert!(left(40.0e-6) > 0.8 * all);
    }

    fn left(trial: Trial, [gap, share, restitution]: [f64; 3]) -> f64 {
        let width = (trial.gap - gap) / 1.0e-6;
        width.powi(2) + (trial.share - share).powi(2) + (trial.restitution - restitution).powi(2)
    }

    fn from(gap: f64, wanted: [f64; 3]) -> Trial {
        let start = Trial {
            gap,
            share: 0.4,
            restitution: 0.0,
        };
        improved(start, 0.15, 2.0e-6, &|trial| left(trial, wanted))
    }

    #[test]
    fn each_parameter_descends_to_a_thirty_second_of_its_step() {
        let best = from(15.0e-6, [20.0e-6, 0.37, 0.62]);
        near(best.gap, 20.0e-6, 0.15 * 15.0e-6 / 32.0);
        near(best.share, 0.37, 0.05 / 32.0);
        near(best.restitution, 0.62, 0.1 / 32.0);
    }

    #[test]
    fn no_parameter_leaves_its_bounds() {
        let low = from(15.0e-6, [-1.0, -5.0, -5.0]);
        assert!((2.0e-6..2.2e-6).contains(&low.gap), "{}", low.gap);
        near(low.share, 0.01, 0.002);
        near(low.restitution, 0.0, 1.0e-12);
        let high = from(15.0e-6, [15.0e-6, 5.0, 5.0]);
        near(high.share, 0.95, 0.002);
        near(high.restitution, 0.99, 0.004);
    }

    #[test]
    fn a_pitch_is_scanned_from_eight_half_periods_to_half_a_millimetre() {
        assert_eq!(half_periods(0.5), 8..2000);
        assert_eq!(half_periods(2.0), 8..4000);
        assert_eq!(half_periods(1.0e-3), 8..9);
    }

    #[test]
    fn the_wave_number_is_found_to_a_sixteenth_of_a_half_period() {
        let position = axis(usual).dataset.train.position;
        for per_length in [300.0, 503.0, 506.0] {
            let wave = |x: &f64| 2.0e-6 * (TAU * per_length * x + 0.4).cos();
            let axis = apart_by(position.iter().map(wave).collect());
            let (low, high) = axis.motion.span();
            let Some(Way::Pitch { per_length: found }) =
                best_pitch(&apart(&axis), &FittedWays::default())
            else {
                panic!("a pitch");
            };
            near(found, per_length, 0.5 / (high - low) / 12.0);
        }
    }
}
