//! A gap between springy flanks, by the balance of forces on the motor.
//!
//! Motor − load d is both the way across the gap and the wind-up of the flanks, so d alone does not
//! tell the two apart. The force does: a gap that is open transmits none.
//!
//! ```text
//! F = M1·a1 + Fc1·sign v1 + Fv1·v1 + F0 + K·D(d − c) + C·ḋ in contact
//! D(d) = d − clamp(d, −gap/2, gap/2)
//! ```
//!
//! M1, Fc1 and Fv1 are mass and friction of the motor's own side, K and C stiffness and damping of
//! the flanks, c the zero between the two scales. The contact state needs no simulation, since d is
//! measured: the flank turns over where the transmitted force does. Friction of the load and
//! impacts are in d already, so the balance holds for every law of them. For a width and a zero the
//! fit is linear. A width that is too large leaves the force of wound-up flanks unexplained, one
//! that is too small that of a gap without force.
//!
//! The rivals of a gap are a spring without one, `K·d`, and one that stiffens, `K·d + K₃·d³`.
//! Units: m or rad, s, unit of the effort.

use super::columns::{Apart, of_motor};
use super::edges::Flanks;
use super::known::Known;
use crate::evidence::thresholds::{DIFFERENCE_SHARE, FEWEST_COUNTS};
use crate::fit::blocks::{Blocks, Fit, Gain};
use crate::fit::rows::Rows;
use crate::fit::search::descend;
use crate::fit::side_by_side::side_by_side;
use crate::motion::derivatives::without_bow;
use crate::motion::kinematics::Kinematics;
use crate::record::units::EffortHold;

/// Widths that are tried, as shares of the range of motor − load.
const WIDTHS: [f64; 11] = [0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.96];
/// Places of the middle that are tried, as shares of the range from its own middle.
const MIDDLES: [f64; 5] = [-0.3, -0.15, 0.0, 0.15, 0.3];
/// First step of each edge's descent, as a share of the range: that of the grid.
const EDGE_STEP: f64 = 0.04;
/// Descents of both edges: each begins with half the steps of the one before.
const DESCENTS: i32 = 3;
/// Share of the samples that lie beyond the range at either end: impacts.
const BEYOND: f64 = 0.005;

/// Place of the motor's own Coulomb friction among the columns of its own side.
const OWN_FRICTION: usize = 1;
/// Places of all that the motor's own side has: mass, Coulomb and viscous friction, offset.
const OWN: [usize; 4] = [0, OWN_FRICTION, 2, 3];
/// Places of what it has without Coulomb friction.
pub(super) const OWN_WITHOUT_COULOMB: [usize; 3] = [0, 2, 3];
/// Places of what it has without friction.
pub(super) const OWN_WITHOUT_FRICTION: [usize; 2] = [0, 3];
/// Seconds with so many times the effort of the median one are left out. Chosen: between slow and
/// fast strokes it differs by up to four times, and a loop that bounces between the flanks brings
/// ten.
const VIOLENT: f64 = 5.0;

/// Flanks with what speaks for a gap between them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Judged {
    /// The best edges.
    pub flanks: Flanks,
    /// What the gap removes of the effort beside a spring, stiffening or not, on held-out blocks.
    pub gain: Gain,
    /// Whether the force shows the flanks at all: without them the fit is worse, and stiffness and
    /// motor mass come out positive.
    pub sees_flanks: bool,
}

/// The motor's balance of forces on a record.
pub(super) struct Balance<'a> {
    motion: &'a Kinematics,
    /// Low-passed, as the acceleration of the motor sees it beside smooth forces.
    effort: Vec<f64>,
    hold: EffortHold,
    /// Motor − load at the rows.
    difference: &'a [f64],
    /// Columns of the motor's own side, low-passed.
    own: Vec<Vec<f64>>,
    mask: Vec<bool>,
}

/// The gap between springy flanks that the motor's balance shows best.
pub(crate) fn judged(apart: &Apart<'_>, count: f64) -> Option<Judged> {
    let balance = Balance::of(apart);
    let range = balance.range()?;
    let flanks = balance.best(range, FEWEST_COUNTS * count);
    Some(balance.judged(flanks))
}

impl<'a> Balance<'a> {
    pub(super) fn of(apart: &Apart<'a>) -> Self {
        let motion = apart.motion;
        let pairs = motion.fitted.iter().zip(&motion.slow);
        let mask: Vec<bool> = pairs.map(|(fitted, slow)| *fitted || *slow).collect();
        let lacking = motion.lacking;
        let [acceleration, direction, velocity] = of_motor(motion);
        let acceleration = without_bow(&acceleration, lacking.force);
        let steps = lacking.force - lacking.effort;
        Self {
            motion,
            effort: without_bow(apart.path.transmitted, steps),
            hold: apart.path.hold,
            difference: apart.raw,
            own: vec![acceleration, direction, velocity, vec![1.0; motion.len()]],
            mask: calm(motion, mask),
        }
    }

    /// Between which values motor − load lies, but for a few samples.
    fn range(&self) -> Option<(f64, f64)> {
        let rows = self.difference.iter().zip(&self.mask);
        let mut inside: Vec<f64> = rows.filter(|(_, mask)| **mask).map(|(d, _)| *d).collect();
        inside.sort_by(f64::total_cmp);
        let beyond = (BEYOND * inside.len() as f64) as usize;
        let low = *inside.get(beyond)?;
        let high = *inside.get(inside.len().checked_sub(1 + beyond)?)?;
        (high > low).then_some((low, high))
    }

    /// What is told of each row, at the time at which the effort of the row acts: its mean over a
    /// hold, as that of a cubic through four rows is.
    fn held(&self, at_row: impl Fn(usize) -> f64) -> Vec<f64> {
        let last = self.difference.len() - 1;
        let rows = 0..=last;
        match self.hold {
            EffortHold::Instant => rows.map(at_row).collect(),
            EffortHold::ZeroOrder => rows
                .map(|row| {
                    let inside = at_row(row) + at_row((row + 1).min(last));
                    let outside = at_row(row.saturating_sub(1)) + at_row((row + 2).min(last));
                    (13.0 * inside - outside) / 24.0
                })
                .collect(),
        }
    }

    /// A function of motor − load at the time at which the effort of a row acts; low-passed.
    fn column(&self, at_row: impl Fn(usize) -> f64) -> Vec<f64> {
        self.motion.low_passed(&self.held(at_row))
    }

    /// Sum of squares of the effort that columns at the rows, low-passed, leave beside the motor's
    /// own side.
    pub(super) fn left_by_all(&self, columns: &[Vec<f64>]) -> f64 {
        self.blocks(&self.at_efforts(columns)).fit().sse
    }

    /// The same of one column, that of the wind-up, beside friction of the motor's own side that is
    /// rigid or bends in one of these ways, whichever leaves least; the first column of each is its
    /// bend. It only holds back: where it would have to push, there is none.
    pub(super) fn left_by(&self, wound: &[f64], bends: &[Vec<Vec<f64>>]) -> f64 {
        let held = [self.held(|row| wound[row])];
        let rigid = self.blocks(&held).fit();
        let rigid = (rigid.coefficients.get(OWN_FRICTION).copied(), rigid.sse);
        let bent = bends.iter().map(|bend| {
            let columns = self.at_efforts(&[&[wound.to_vec()], bend.as_slice()].concat());
            let fit = self.blocks_beside(&OWN_WITHOUT_COULOMB, &columns).fit();
            let own = fit.coefficients.get(OWN_WITHOUT_COULOMB.len() + 1);
            (own.copied(), fit.sse)
        });
        let left = bent
            .chain([rigid])
            .filter(|(own, _)| own.is_some_and(|own| own >= 0.0))
            .map(|(_, sse)| sse)
            .min_by(f64::total_cmp);
        left.unwrap_or_else(|| self.blocks_beside(&OWN_WITHOUT_COULOMB, &held).fit().sse)
    }

    /// Columns of what is wound up, between flanks or without a gap: its rate in contact, itself.
    pub(super) fn wound(&self, flanks: Option<Flanks>) -> [Vec<f64>; 2] {
        let wind_up = |row: usize| {
            let apart = self.difference[row];
            flanks.map_or(apart, |flanks| flanks.wind_up(apart))
        };
        let touches = |d| flanks.is_none_or(|flanks| flanks.touches(d));
        [self.rate(touches), self.column(wind_up)]
    }

    /// Columns at the rows, low-passed, at the times at which the effort acts.
    pub(super) fn at_efforts(&self, columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let held = columns.iter().map(|column| self.held(|row| column[row]));
        held.collect()
    }

    /// The rows of a mask that are judged, with columns beside some of the motor's own side.
    pub(super) fn rows(&self, own: &[usize], columns: &[Vec<f64>], mask: &[bool]) -> Rows {
        let own = own.iter().map(|place| self.own[*place].as_slice());
        let all: Vec<&[f64]> = own.chain(columns.iter().map(Vec::as_slice)).collect();
        let pairs = mask.iter().zip(&self.mask);
        let mask: Vec<bool> = pairs.map(|(mask, own)| *mask && *own).collect();
        Rows::new(&all, &self.effort, &mask, self.motion.period_s)
    }

    /// Rate of motor − load where a condition on it holds.
    fn rate(&self, holds: impl Fn(f64) -> bool) -> Vec<f64> {
        let (d, last) = (self.difference, self.difference.len() - 1);
        let slope = |row: usize| {
            let (before, after) = (row.saturating_sub(1), (row + 1).min(last));
            (d[after] - d[before]) / (2.0 * self.motion.period_s)
        };
        self.column(|row| if holds(d[row]) { slope(row) } else { 0.0 })
    }

    fn blocks(&self, columns: &[Vec<f64>]) -> Blocks {
        self.blocks_beside(&OWN, columns)
    }

    /// Columns beside some of the motor's own side, by their places.
    fn blocks_beside(&self, own: &[usize], columns: &[Vec<f64>]) -> Blocks {
        Blocks::with(&self.rows(own, columns, &self.mask), &[])
    }

    /// Width of a gap and stiffness of its flanks with their intervals, the edges linearised.
    pub(super) fn known(&self, flanks: Flanks) -> (Known, Known) {
        let beyond = |edge: f64, side: f64| {
            let is_beyond = move |d: f64| side * (d - edge) > 0.0;
            self.column(|row| f64::from(u8::from(is_beyond(self.difference[row]))))
        };
        let (high, low) = (beyond(flanks.high, 1.0), beyond(flanks.low, -1.0));
        let pairs = high.iter().zip(&low);
        let by_middle = pairs
            .clone()
            .map(|(high, low)| -flanks.stiffness * (high + low));
        let by_width = pairs.map(|(high, low)| 0.5 * flanks.stiffness * (low - high));
        let columns = [
            by_middle.collect(),
            self.rate(|d| flanks.touches(d)),
            self.column(|row| flanks.wind_up(self.difference[row])),
            by_width.collect(),
        ];
        let half_widths = self.blocks(&columns).half_widths();
        let [.., stiffness, gap] = half_widths[..] else {
            return (
                Known::new(flanks.gap(), 0.0),
                Known::new(flanks.stiffness, 0.0),
            );
        };
        (
            Known::new(flanks.gap(), gap),
            Known::new(flanks.stiffness, stiffness),
        )
    }

    fn between(&self, flanks: Flanks) -> Blocks {
        self.blocks(&[
            self.column(|row| flanks.wind_up(self.difference[row])),
            self.rate(|d| flanks.touches(d)),
        ])
    }

    /// A spring without a gap, of a constant stiffness or one that grows with the wind-up.
    fn spring(&self, stiffens: bool) -> Blocks {
        let middle = self.range().map_or(0.0, |(low, high)| 0.5 * (low + high));
        let mut columns = vec![
            self.column(|row| self.difference[row] - middle),
            self.rate(|_| true),
        ];
        if stiffens {
            columns.push(self.column(|row| (self.difference[row] - middle).powi(3)));
        }
        self.blocks(&columns)
    }

    /// The edges that leave least, not nearer than `narrowest`.
    fn best(&self, (low, high): (f64, f64), narrowest: f64) -> Flanks {
        let range = high - low;
        let left = |flanks: Flanks| self.between(flanks).fit().sse;
        let mut best = self.best_of_grid((low, high), narrowest);
        for descent in 0..DESCENTS {
            let step = EDGE_STEP * range * 0.25_f64.powi(descent);
            let lowest_high = best.low + narrowest;
            best.high = descend(best.high, step, (lowest_high, high + range), &|high| {
                left(Flanks { high, ..best })
            });
            let highest_low = best.high - narrowest;
            best.low = descend(best.low, step, (low - range, highest_low), &|low| {
                left(Flanks { low, ..best })
            });
        }
        best
    }

    fn best_of_grid(&self, (low, high): (f64, f64), narrowest: f64) -> Flanks {
        let range = high - low;
        let of = |(width, middle): (f64, f64)| {
            let half = 0.5 * (width * range).max(narrowest);
            let middle = 0.5 * (low + high) + middle * range;
            Flanks {
                low: middle - half,
                high: middle + half,
                stiffness: 0.0,
            }
        };
        let middles = |width: f64| MIDDLES.map(|middle| of((width, middle)));
        let tried: Vec<Flanks> = WIDTHS.into_iter().flat_map(middles).collect();
        let left = side_by_side(&tried, |flanks| self.between(*flanks).fit().sse);
        let pairs = tried.into_iter().zip(left);
        let best = pairs.min_by(|a, b| a.1.total_cmp(&b.1));
        best.map_or_else(Flanks::default, |(flanks, _)| flanks)
    }

    fn judged(&self, flanks: Flanks) -> Judged {
        let fit = self.between(flanks).cross_validate();
        let spring = self.spring(false).cross_validate();
        let stiffening = self.spring(true).cross_validate();
        let rigid = self.blocks(&[]).cross_validate();
        let stiffness = fit.coefficients[self.own.len()];
        let gain = Gain::of(&spring, &fit).smaller(&Gain::of(&stiffening, &fit));
        let sees = |fit: &Fit| {
            let seen = Gain::of(&rigid, fit).share >= DIFFERENCE_SHARE;
            seen && fit.coefficients[0] > 0.0 && fit.coefficients[self.own.len()] > 0.0
        };
        Judged {
            flanks: Flanks {
                stiffness,
                ..flanks
            },
            gain,
            sees_flanks: sees(&fit) && stiffness > 0.0,
        }
    }
}

/// A mask without the seconds in which the axis bounces between its flanks: there the strokes are
/// faster than the samples, and their force hides that of all others.
fn calm(motion: &Kinematics, mut mask: Vec<bool>) -> Vec<bool> {
    let second = ((1.0 / motion.period_s).round() as usize).max(1);
    let rms = |(efforts, mask): (&[f64], &[bool])| {
        let inside = efforts.iter().zip(mask).filter(|(_, inside)| **inside);
        let (sum, count) = inside.fold((0.0, 0.0), |(sum, count), (effort, _)| {
            (sum + effort.powi(2), count + 1.0)
        });
        (count > 0.0).then(|| f64::sqrt(sum / count))
    };
    let seconds = motion.effort.chunks(second).zip(mask.chunks(second));
    let efforts: Vec<Option<f64>> = seconds.map(rms).collect();
    let mut sorted: Vec<f64> = efforts.iter().copied().flatten().collect();
    sorted.sort_by(f64::total_cmp);
    let Some(median) = sorted.get(sorted.len() / 2) else {
        return mask;
    };
    for (mask, effort) in mask.chunks_mut(second).zip(&efforts) {
        if effort.is_some_and(|effort| effort > VIOLENT * median) {
            mask.fill(false);
        }
    }
    mask
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::difference::columns::Path;
    use crate::fit::made::{Axis, axis, usual};

    /// 30 of 90 kg on the motor; the rest, all friction and 30 N that change with position behind
    /// 5 N/µm with a gap. What changes with position is no motion of the motor: without it the
    /// balance would not see the flanks.
    fn sprung(gap: f64) -> Axis {
        with_law(gap, |force| force / 5.0e6)
    }

    /// The same with another wind-up by the transmitted force.
    fn with_law(gap: f64, wind_up: impl Fn(f64) -> f64) -> Axis {
        let mut axis =
            axis(|motion, row| usual(motion, row) + 30.0 * (700.0 * motion.position_lp[row]).sin());
        let motion = &mut axis.motion;
        let rows = motion.effort.iter().zip(&motion.acceleration);
        let apart = rows.map(|(effort, a)| {
            let force = effort - 30.0 * a;
            wind_up(force) + 0.5 * gap * force.signum() + 3.0e-6
        });
        motion.difference = Some(apart.collect());
        axis
    }

    fn judged(axis: &Axis) -> Judged {
        let path = Path {
            position: &axis.dataset.train.position,
            transmitted: &axis.motion.effort_lp,
            hold: axis.dataset.hold,
        };
        super::judged(&Apart::on(&axis.motion, path).unwrap(), 1.0e-8).unwrap()
    }

    #[test]
    fn a_gap_is_told_from_the_spring_beside_it_by_the_force() {
        for gap in [2.0e-6, 20.0e-6] {
            let Judged {
                flanks,
                gain,
                sees_flanks,
            } = judged(&sprung(gap));
            assert!((flanks.gap() / gap - 1.0).abs() < 0.03, "{flanks:?}");
            assert!((flanks.stiffness / 5.0e6 - 1.0).abs() < 0.02, "{flanks:?}");
            assert!(sees_flanks && gain.share > 0.5 && gain.t > 2.0, "{gain:?}");
        }
    }

    #[test]
    fn a_spring_alone_has_no_gap() {
        let Judged {
            gain, sees_flanks, ..
        } = judged(&sprung(0.0));
        assert!(sees_flanks && gain.share < 0.05, "{gain:?}");
    }

    #[test]
    fn a_spring_that_stiffens_is_no_gap() {
        // Half as stiff about zero as at 100 N.
        let stiffening = with_law(0.0, |force| {
            force / 5.0e6 * (1.0 + (-(force / 50.0).powi(2)).exp())
        });
        let Judged { gain, .. } = judged(&stiffening);
        assert!(gain.share < 0.1, "{gain:?}");
    }

    #[test]
    fn the_lag_is_what_stands_between_the_edges() {
        let flanks = Flanks {
            low: -1.0,
            high: 3.0,
            stiffness: 1.0,
        };
        assert_eq!(flanks.gap(), 4.0);
        assert_eq!(flanks.lag(&[-5.0, 0.0, 1.0, 9.0]), [-2.0, -1.0, 0.0, 2.0]);
        let wound: Vec<f64> = [-5.0, 0.0, 9.0].map(|d| flanks.wind_up(d)).to_vec();
        assert_eq!(wound, [-4.0, 0.0, 6.0]);
        assert!(flanks.touches(3.0) && flanks.touches(-1.5) && !flanks.touches(0.0));
    }
}
