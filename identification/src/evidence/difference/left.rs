//! What motor − load keeps when every accepted effect is out of it.
//!
//! Four things give motor − load a structure: the direction (a gap that was not found), the
//! transmitted force (a spring that stiffens, a hysteresis), the position (a screw, a scale) and
//! the time (a coupling that slips, a part that warms). Each is a set of functions of the motion,
//! fitted to the residual and judged on held-out blocks. What they take away there is structure, in
//! counts of the coarser encoder. A coupling that slips in jumps is no function of time, and
//! neither is a loop that oscillates; but then much of motor − load is left, slower than noise or
//! as a wave. The time is asked where nothing else goes with it. The transmitted force is the one
//! that winds the spring up; without a spring the one that the motion predicts. A gap that a spring
//! has swallowed shows as a step over that force.

use super::columns::{Apart, of_motor};
use crate::evidence::amount::{about_mean, colour};
use crate::evidence::thresholds::{
    APART_COUNTS, APART_LEFT, APART_SHARE, DIFFERENCE_T, NOISE_COLOUR,
};
use crate::fit::blocks::{Blocks, Fit, Gain};
use crate::fit::plain::Plain;

/// A structure in motor − load that nothing explains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Left {
    /// Over what.
    pub over: &'static str,
    /// Rms of the structure, m or rad.
    pub rms: f64,
}

/// Functions of the motion, scaled to about one.
struct Motion {
    ones: Vec<f64>,
    direction: Vec<f64>,
    velocity: Vec<f64>,
    force: Vec<f64>,
    position: Vec<f64>,
    time: Vec<f64>,
}

/// The largest structure in a residual that is beyond the counts; `wound` is the wind-up of a
/// spring.
pub(crate) fn left(
    apart: &Apart<'_>,
    residual: &[f64],
    wound: Option<Vec<f64>>,
    count: f64,
) -> Option<Left> {
    let motion = Motion::of(apart, wound);
    let rest = Rest { apart, residual };
    let all = [
        rest.over_direction(&motion),
        rest.over("the transmitted force", &motion, &laws_of(&motion.force)),
        rest.over("the position", &motion, &laws_of(&motion.position)),
    ];
    let beyond = |left: &Left| left.rms > APART_COUNTS * count;
    let all = all.into_iter().flatten().filter(beyond);
    let largest = all.max_by(|a, b| a.rms.total_cmp(&b.rms));
    largest.or_else(|| rest.over_time(&motion).filter(beyond))
}

impl Motion {
    fn of(apart: &Apart<'_>, wound: Option<Vec<f64>>) -> Self {
        let motion = apart.motion;
        let plain = Plain::fit(motion);
        let [acceleration, direction, velocity] = of_motor(motion);
        let force = |row: usize| {
            plain.inertia * acceleration[row]
                + plain.viscous * velocity[row]
                + plain.coulomb * direction[row]
        };
        Self {
            ones: vec![1.0; motion.len()],
            force: at_most_one(wound.unwrap_or_else(|| (0..motion.len()).map(force).collect())),
            position: about_middle(motion.position_lp.clone()),
            time: about_middle(motion.time_s.clone()),
            velocity,
            direction,
        }
    }
}

/// Values about the middle of their range.
fn about_middle(mut values: Vec<f64>) -> Vec<f64> {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    for value in &mut values {
        *value -= 0.5 * (low + high);
    }
    at_most_one(values)
}

/// Values of which the largest is one.
fn at_most_one(mut values: Vec<f64>) -> Vec<f64> {
    let largest = values
        .iter()
        .fold(f64::MIN_POSITIVE, |most, value| most.max(value.abs()));
    for value in &mut values {
        *value /= largest;
    }
    values
}

/// Laws of values: a step, a line, a fold, a cubic and what is between them.
fn laws_of(values: &[f64]) -> Vec<Vec<f64>> {
    let laws: [fn(f64) -> f64; 5] = [|x| x, f64::abs, |x| x * x, |x| x * x.abs(), |x| x.powi(3)];
    let column = |law: fn(f64) -> f64| values.iter().map(|x| law(*x)).collect();
    laws.into_iter().map(column).collect()
}

/// A residual of motor − load on its record.
struct Rest<'a> {
    apart: &'a Apart<'a>,
    residual: &'a [f64],
}

impl Rest<'_> {
    fn fit(&self, columns: &[&[f64]]) -> Fit {
        let (mask, period_s) = (&self.apart.mask, self.apart.motion.period_s);
        Blocks::new(columns, self.residual, mask, period_s).cross_validate()
    }

    fn over_direction(&self, motion: &Motion) -> Option<Left> {
        let base = self.fit(&[&motion.ones]);
        let full = self.fit(&[&motion.ones, &motion.direction, &motion.velocity]);
        self.structure("the direction", &base, &full)
    }

    /// Structure over something, beside direction and velocity.
    fn over(&self, what: &'static str, motion: &Motion, columns: &[Vec<f64>]) -> Option<Left> {
        let mut all: Vec<&[f64]> = vec![&motion.ones, &motion.direction, &motion.velocity];
        let base = self.fit(&all);
        all.extend(columns.iter().map(Vec::as_slice));
        self.structure(what, &base, &self.fit(&all))
    }

    /// Structure over the time; the largest is all that is left, where that is much and no noise.
    fn over_time(&self, motion: &Motion) -> Option<Left> {
        let mask = &self.apart.mask;
        let [left, all] = [self.residual, &self.apart.target].map(|x| about_mean(x, mask));
        let is_much = left > APART_LEFT * all;
        let is_coloured = || colour(self.apart.motion, self.residual, mask) > NOISE_COLOUR;
        let over = "the time";
        if is_much && is_coloured() {
            return Some(Left { over, rms: left });
        }
        self.over(over, motion, &laws_of(&motion.time))
    }

    fn structure(&self, over: &'static str, base: &Fit, full: &Fit) -> Option<Left> {
        let gain = Gain::of(base, full);
        let rows = self.apart.mask.iter().filter(|inside| **inside).count() as f64;
        let rms = (gain.removed.max(0.0) / rows.max(1.0)).sqrt();
        let is_seen = gain.share >= APART_SHARE && gain.t >= DIFFERENCE_T;
        is_seen.then_some(Left { over, rms })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::difference::columns::Path;
    use crate::fit::made::{Axis, axis, usual};

    /// What is left where motor − load follows a law of force and position, on a scale of 0.1 µm.
    fn left_by(law: impl Fn(&Axis, usize) -> f64) -> Option<Left> {
        let mut axis = axis(usual);
        let rows = 0..axis.motion.len();
        let noise = |row: usize| 0.3e-7 * (1.7 * (row * row % 1013) as f64).sin();
        let apart: Vec<f64> = rows.map(|row| law(&axis, row) + noise(row)).collect();
        axis.motion.difference = Some(apart);
        let path = Path {
            position: &axis.dataset.train.position,
            transmitted: &axis.motion.effort_lp,
            hold: axis.dataset.hold,
        };
        let apart = Apart::on(&axis.motion, path).unwrap();
        left(&apart, &apart.target, None, 1.0e-7)
    }

    #[test]
    fn noise_is_no_structure_and_neither_is_a_structure_within_three_counts() {
        assert_eq!(left_by(|_, _| 0.0), None);
        let small = |axis: &Axis, row: usize| 0.25e-6 * axis.motion.direction[row];
        assert_eq!(left_by(small), None);
    }

    #[test]
    fn each_structure_is_told_with_what_it_goes_with() {
        let step = |axis: &Axis, row: usize| 2.0e-6 * axis.motion.direction[row];
        let fold = |axis: &Axis, row: usize| 4.0e-6 * (axis.motion.effort_lp[row] / 80.0).powi(2);
        let bow = |axis: &Axis, row: usize| 2.0e-3 * axis.motion.position_lp[row].powi(2);
        let found = [left_by(step), left_by(fold), left_by(bow)].map(Option::unwrap);
        let over = ["the direction", "the transmitted force", "the position"];
        assert_eq!(found.map(|left| left.over), over);
        let sizes = found.map(|left| left.rms);
        assert!(
            sizes.iter().all(|rms| (0.3e-6..3.0e-6).contains(rms)),
            "{sizes:?}"
        );
    }

    #[test]
    fn what_drifts_slips_or_rings_goes_with_the_time_and_noise_with_nothing() {
        let drift = |axis: &Axis, row: usize| 1.0e-6 * axis.motion.time_s[row];
        let slip = |axis: &Axis, row: usize| 4.0e-6 * (axis.motion.time_s[row] / 0.7).floor().sin();
        let ring = |_: &Axis, row: usize| 4.0e-6 * (0.6 * row as f64).sin();
        for left in [left_by(drift), left_by(slip), left_by(ring)].map(Option::unwrap) {
            assert_eq!(left.over, "the time");
            assert!((1.0e-6..4.0e-6).contains(&left.rms), "{left:?}");
        }
        // Most of it is left, but it is noise.
        let noise = |_: &Axis, row: usize| 4.0e-6 * (1.7 * (row * row % 1013) as f64).sin();
        assert_eq!(left_by(noise), None);
    }
}
