//! Motor − load linearised about its fit: wave numbers beyond the grid of their search, and half
//! widths of 95 % intervals by the jackknife over blocks.

use super::columns::{Apart, FittedWays, Way};
use super::search::FEWEST_PERIODS;
use crate::simulate::load::Behind;

/// Step of the derivative by a width, as a share of it.
const WIDTH_STEP: f64 = 0.01;
/// Step of the derivative by a wave number, in periods over the travel.
const PERIODS_STEP: f64 = 0.01;

/// Most steps of a wave number.
const MOST_STEPS: usize = 4;

/// Half widths of a way.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct HalfWidths {
    /// Of its coefficients.
    pub own: Vec<f64>,
    /// Of the width of a gap between rigid flanks, or of a wave number.
    pub searched: Option<f64>,
}

/// The half widths of fitted ways, in their order.
pub(super) fn half_widths(apart: &Apart<'_>, fitted: &FittedWays) -> Vec<HalfWidths> {
    let ways = fitted.ways();
    let known = apart.where_known(&ways);
    let slopes = slopes(&known, fitted);
    let all = known.blocks_of(&design(&known, &ways, &slopes), &known.target);
    let all = all.half_widths();
    let (own, searched) = all.split_at(all.len() - slopes.iter().flatten().count());
    let (mut own, mut searched) = (own.iter().copied(), searched.iter().copied());
    let of_way = |(way, slope): (&Way, &Option<Vec<f64>>)| HalfWidths {
        own: own.by_ref().take(way.width()).collect(),
        searched: slope.as_ref().and_then(|_| searched.next()),
    };
    ways.iter().zip(&slopes).map(of_way).collect()
}

/// Ways with the wave numbers that leave the least, from those of a search (Gauss and Newton). A
/// wave of fewer periods than are searched is one of a known order, and stays.
pub(super) fn with_wave_numbers(apart: &Apart<'_>, mut ways: Vec<Way>) -> Vec<Way> {
    for _ in 0..MOST_STEPS {
        let known = apart.where_known(&ways);
        let fitted = known.fit(&ways);
        let slopes = slopes(&known, &fitted);
        let fit = known.blocks_of(&design(&known, &ways, &slopes), &known.target);
        let mut steps = fit.fit().coefficients;
        let mut steps = steps
            .split_off(steps.len() - slopes.iter().flatten().count())
            .into_iter();
        let moved = ways.iter().zip(&slopes).map(|(way, slope)| {
            let step = slope.as_ref().and_then(|_| steps.next());
            match (*way, step) {
                (Way::Pitch { per_length }, Some(step)) if is_searched(apart, per_length) => {
                    Way::Pitch {
                        per_length: per_length + step,
                    }
                }
                (way, _) => way,
            }
        });
        let moved: Vec<Way> = moved.collect();
        let left = |ways: &[Way]| {
            known
                .blocks_of(&known.design(ways), &known.target)
                .fit()
                .sse
        };
        if left(&moved) >= left(&ways) {
            break;
        }
        ways = moved;
    }
    ways
}

/// Whether a wave number has as many periods within the travel as those of the search.
fn is_searched(apart: &Apart<'_>, per_length: f64) -> bool {
    let (low, high) = apart.motion.span();
    per_length * (high - low) >= FEWEST_PERIODS
}

/// Slopes of what ways make of motor − load over what was searched of them.
fn slopes(apart: &Apart<'_>, fitted: &FittedWays) -> Vec<Option<Vec<f64>>> {
    let of_way = |place: usize| {
        let (way, own) = fitted.at(place)?;
        let (both, distance) = neighbours(apart, way)?;
        let [below, above] = both.map(|way| apart.predicted(way, own));
        let pairs = below.iter().zip(&above);
        Some(
            pairs
                .map(|(below, above)| (above - below) / distance)
                .collect(),
        )
    };
    (0..fitted.ways().len()).map(of_way).collect()
}

/// Columns of ways, and after them the slopes.
fn design(apart: &Apart<'_>, ways: &[Way], slopes: &[Option<Vec<f64>>]) -> Vec<Vec<f64>> {
    let mut columns = apart.design(ways);
    columns.extend(slopes.iter().flatten().cloned());
    columns
}

/// A way a little below and a little above what was searched of it, and how far these are apart.
fn neighbours(apart: &Apart<'_>, way: Way) -> Option<([Way; 2], f64)> {
    match way {
        Way::Play(behind) => {
            let step = WIDTH_STEP * behind.gap;
            let with = |gap: f64| Way::Play(Behind { gap, ..behind });
            Some((
                [with(behind.gap - step), with(behind.gap + step)],
                2.0 * step,
            ))
        }
        Way::Pitch { per_length } => {
            let (low, high) = apart.motion.span();
            let step = PERIODS_STEP / (high - low);
            let with = |per_length: f64| Way::Pitch { per_length };
            let both = [with(per_length - step), with(per_length + step)];
            (step.is_finite() && step > 0.0).then_some((both, 2.0 * step))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::columns::Path;
    use super::*;
    use crate::fit::made::{axis, usual};
    use crate::record::units::EffortHold;
    use std::f64::consts::TAU;

    #[test]
    fn a_wave_is_known_as_far_as_the_noise_lets_it() {
        let noise = |row: usize| 0.4e-6 * (1.7 * (row * row % 1013) as f64).sin();
        let mut errors = Vec::new();
        for phase in 0..20 {
            let mut axis = axis(usual);
            let position = axis.dataset.train.position.clone();
            let wave = |x: f64| 2.0e-6 * (TAU * 500.0 * x + 0.3 * f64::from(phase)).cos();
            let apart = position.iter().enumerate();
            axis.motion.difference = Some(
                apart
                    .map(|(row, x)| wave(*x) + noise(row + 97 * phase as usize))
                    .collect(),
            );
            let path = Path {
                position: &position,
                transmitted: &axis.motion.effort_lp,
                hold: EffortHold::Instant,
            };
            let apart = Apart::on(&axis.motion, path).unwrap();
            let fitted = apart.fit(&[Way::Constant, Way::Pitch { per_length: 500.0 }]);
            let widths = half_widths(&apart, &fitted);
            assert_eq!((widths[0].own.len(), widths[0].searched), (1, None));
            let (_, own) = fitted.at(1).unwrap();
            let half = widths[1].own[0].hypot(widths[1].own[1]);
            assert!(half < 0.2e-6, "{half}");
            // 60 mm are 30 periods: a hundredth of one is a small part of the wave number.
            assert!(widths[1].searched.unwrap() < 0.01 * 500.0, "{widths:?}");
            errors.push((own[0].hypot(own[1]) - 2.0e-6).abs() / half);
        }
        let held = errors.iter().filter(|error| **error <= 1.0).count();
        assert!(held >= 17, "{errors:?}");
    }

    #[test]
    fn a_wave_number_goes_beyond_the_grid_of_its_search() {
        let mut axis = axis(usual);
        let position = axis.dataset.train.position.clone();
        let wave = |x: &f64| 2.0e-6 * (TAU * 500.0 * x + 0.3).cos();
        axis.motion.difference = Some(position.iter().map(wave).collect());
        let path = Path {
            position: &position,
            transmitted: &axis.motion.effort_lp,
            hold: EffortHold::Instant,
        };
        let apart = Apart::on(&axis.motion, path).unwrap();
        let refined = |per_length: f64| {
            let ways = vec![Way::Constant, Way::Pitch { per_length }];
            let Way::Pitch { per_length } = with_wave_numbers(&apart, ways)[1] else {
                panic!("a pitch error stays one");
            };
            per_length
        };
        let (low, high) = axis.motion.span();
        let grid = 1.0 / (high - low) / 16.0;
        for off in [-1.0, 0.0, 1.0] {
            let found = refined(500.0 + off * grid);
            assert!((found / 500.0 - 1.0).abs() < 1.0e-6, "{off} {found}");
        }
        // One of a known order stays.
        let known = 0.5 * FEWEST_PERIODS / (high - low);
        assert_eq!(refined(known), known);
    }
}
