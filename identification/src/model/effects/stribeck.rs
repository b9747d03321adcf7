//! Stribeck fall: friction above the Coulomb level at low speed, `c·sign(v)·exp(−|v / vs|^p)`.
//!
//! The exponent p is 2 with Gauss, 1 with Tustin, ½ with Bo and Pavelescu (Armstrong-Hélouvry,
//! Dupont and Canudas de Wit, Automatica 30, 1994). Each exponent is a form of the same effect.
//! Gauss is the usual one; another has to beat it. Where friction differs by direction, so does its
//! fall: `(c sign(v) + d)·exp(−|v / vs|^p)`, with the larger excess the way of the sign of d.
//!
//! The fall may lag (frictional lag: Hess and Soom, ASME J. Tribology 112, 1990; Lampaert,
//! Al-Bender and Swevers, 2003): what is left of the excess goes to exp(−|v / vs|^p) by first
//! order. Each lag is a form, too, of which the usual one is none.
//!
//! With generalised Maxwell slip the lag goes with the level, s(v)/C: at rest it is longer than
//! where friction has fallen, by the excess over the Coulomb level (its growth). That is another
//! form again.

use std::sync::OnceLock;

use axis_model::EffectName;

use super::{Action, Effect, Fitted, Instant, Kinematics, Named, Naming, Setting, geometric};
use crate::model::name::Called;
use crate::motion::lag;
use crate::record::dataset::Dataset;

/// c·sign(v)·exp(−|v/vs|^p), for each direction its own c where it falls by direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stribeck {
    exponent: f64,
    /// Where friction has fallen.
    lag_s: f64,
    /// By how much longer it lags at rest, as a share.
    growth: f64,
    by_direction: bool,
}

/// The usual exponent.
pub(crate) const GAUSS: f64 = 2.0;
/// Smallest exponent.
const SMALLEST: f64 = 0.5;
/// From one exponent to the next.
const STEP: f64 = 0.025;
/// Number of exponents: the last is 2.
const COUNT: usize = 61;
/// Smallest lag, s.
const SHORTEST_LAG_S: f64 = 2.0e-4;
/// From one lag to the next.
const LAG_RATIO: f64 = 1.05;
/// Number of lags, the first of which is none; the last is 0.09 s.
const LAGS: usize = 127;
/// Smallest growth of a lag.
const SMALLEST_GROWTH: f64 = 0.12;
/// From one growth to the next.
const GROWTH_RATIO: f64 = 1.25;
/// Number of growths, the first of which is none; the last is 4.3.
const GROWTHS: usize = 18;
/// Number of kinds: each growth, alike in both directions and by direction.
const KINDS: usize = 2 * GROWTHS;
/// The usual one.
pub(crate) static GAUSSIAN: Stribeck = Stribeck {
    exponent: GAUSS,
    lag_s: 0.0,
    growth: 0.0,
    by_direction: false,
};
/// Forms that differ in one thing, in order.
type Row = OnceLock<Vec<&'static dyn Effect>>;
/// Those of a kind and a lag, each exponent.
static BY_LAG: [Row; KINDS * LAGS] = [const { OnceLock::new() }; KINDS * LAGS];
/// Those of a kind and an exponent, each lag.
static BY_EXPONENT: [Row; KINDS * COUNT] = [const { OnceLock::new() }; KINDS * COUNT];

/// A row of forms: made when it is first asked for, and kept.
fn row(row: &'static Row, forms: impl Iterator<Item = Stribeck>) -> &'static [&'static dyn Effect] {
    let kept = |form: Stribeck| -> &'static dyn Effect { Box::leak(Box::new(form)) };
    row.get_or_init(|| forms.map(kept).collect())
}

/// The forms of a kind with a lag, by the place of it.
fn of_lag(kind: usize, lag: usize) -> &'static [&'static dyn Effect] {
    let forms = (0..COUNT).map(|place| form(kind, lag, place));
    row(&BY_LAG[kind * LAGS + lag], forms)
}

/// The forms of a kind with an exponent, by the place of it.
fn of_exponent(kind: usize, place: usize) -> &'static [&'static dyn Effect] {
    let forms = (0..LAGS).map(|lag| form(kind, lag, place));
    row(&BY_EXPONENT[kind * COUNT + place], forms)
}

fn form(kind: usize, lag: usize, place: usize) -> Stribeck {
    Stribeck {
        exponent: SMALLEST + STEP * place as f64,
        lag_s: at_place(lag, (SHORTEST_LAG_S, LAG_RATIO)),
        growth: at_place(kind / 2, (SMALLEST_GROWTH, GROWTH_RATIO)),
        by_direction: kind % 2 == 1,
    }
}

/// What stands at a place of a grid: nothing, then from the smallest on by a ratio.
fn at_place(place: usize, (smallest, ratio): (f64, f64)) -> f64 {
    match place {
        0 => 0.0,
        place => smallest * ratio.powi(place as i32 - 1),
    }
}

/// Place of what is nearest to a value on such a grid, of so many.
fn place_on(value: f64, (smallest, ratio): (f64, f64), count: usize) -> usize {
    let place = 1.0 + ((value / smallest).ln() / ratio.ln()).round();
    place.clamp(0.0, (count - 1) as f64) as usize
}

fn place_of_lag(lag_s: f64) -> usize {
    place_on(lag_s, (SHORTEST_LAG_S, LAG_RATIO), LAGS)
}

fn place_of_growth(growth: f64) -> usize {
    place_on(growth, (SMALLEST_GROWTH, GROWTH_RATIO), GROWTHS)
}

/// The form that is nearest to an exponent and a lag, the same in both directions.
pub(crate) fn nearest(exponent: f64, lag_s: f64) -> &'static dyn Effect {
    let place = ((exponent - SMALLEST) / STEP).round();
    let place = place.clamp(0.0, (COUNT - 1) as f64) as usize;
    of_lag(0, place_of_lag(lag_s))[place]
}

impl Stribeck {
    /// What is left of the excess at a velocity, without the lag.
    pub(crate) fn left(&self, v: f64, vs: f64) -> f64 {
        left(v / vs, self.exponent)
    }

    /// Place of its exponent, and of its lag.
    fn places(&self) -> (usize, usize) {
        let place = (self.exponent - SMALLEST) / STEP;
        (place.round() as usize, place_of_lag(self.lag_s))
    }

    /// Place of its kind.
    fn kind(&self) -> usize {
        2 * place_of_growth(self.growth) + usize::from(self.by_direction)
    }

    /// Half of what lies between this lag and the next, and of what a growth between two of them
    /// makes of it, s.
    fn rounding_of_lag_s(&self) -> f64 {
        let of_lag = 0.5 * (LAG_RATIO - 1.0);
        let of_growth = 0.5 * (GROWTH_RATIO - 1.0) * self.growth / (2.0 + self.growth);
        self.lag_s * of_lag.hypot(of_growth)
    }

    /// The lag where so much of the excess would be left, s.
    fn lag_at(&self, left: f64) -> f64 {
        self.lag_s * (1.0 + self.growth * left)
    }

    /// What is left of the excess where it lags, after a time at a velocity.
    #[must_use]
    pub(crate) fn left_after(&self, left: f64, (v, vs): (f64, f64), time_s: f64) -> f64 {
        let goes_to = self.left(v, vs);
        left + lag::share(time_s, self.lag_at(goes_to)) * (goes_to - left)
    }

    /// What is left of the excess along a motion.
    pub(crate) fn along(&self, motion: &Kinematics, vs: f64) -> Vec<f64> {
        let velocity = motion.velocity_lp.iter();
        let mut fall: Vec<f64> = velocity.map(|v| self.left(*v, vs)).collect();
        if self.lag_s > 0.0 {
            let constant = lag::share(motion.period_s, self.lag_s);
            let share = |goes_to: f64| match self.growth {
                0.0 => constant,
                _ => lag::share(motion.period_s, self.lag_at(goes_to)),
            };
            for piece in &motion.pieces {
                lag_behind(&mut fall[piece.clone()], share);
            }
        }
        fall
    }
}

/// Beyond this power of e nothing is left: 10⁻⁴³. Where the exponential itself underflows it takes
/// several times as long.
const NOTHING_LEFT: f64 = 100.0;

/// exp(−|ratio|^exponent): what is left of a fall, by the velocity over that of the fall.
#[must_use]
pub(crate) fn left(ratio: f64, exponent: f64) -> f64 {
    let power = if exponent == GAUSS {
        ratio * ratio
    } else {
        ratio.abs().powf(exponent)
    };
    if power > NOTHING_LEFT {
        return 0.0;
    }
    (-power).exp()
}

/// Lets values lag: from row to row by a share of the way to what they would be, which is the share
/// where they would be that.
fn lag_behind(values: &mut [f64], share: impl Fn(f64) -> f64) {
    let Some(mut state) = values.first().copied() else {
        return;
    };
    let mut before = state;
    for value in values {
        // Between two rows it goes to the mean of what it would be at them.
        let goes_to = 0.5 * (before + *value);
        state += share(goes_to) * (goes_to - state);
        before = std::mem::replace(value, state);
    }
}

/// Breakaway friction of more than five times Coulomb is something else.
const LARGEST_RATIO: f64 = 4.0;

impl Effect for Stribeck {
    fn called(&self) -> Called {
        EffectName::Stribeck.into()
    }

    fn equation(&self) -> &'static str {
        "c sign(v) exp(-|v/vs|^p), p = 2 unless found"
    }

    fn columns(&self, motion: &Kinematics, _: &Dataset, vs: f64) -> Vec<Vec<f64>> {
        let fall = self.along(motion, vs);
        let pairs = fall.iter().zip(&motion.direction);
        let against = pairs.map(|(fall, direction)| fall * direction).collect();
        if self.by_direction {
            vec![against, fall]
        } else {
            vec![against]
        }
    }

    fn width(&self, _: f64) -> usize {
        if self.by_direction { 2 } else { 1 }
    }

    fn is_tuned(&self) -> bool {
        true
    }

    fn is_level(&self, column: usize) -> bool {
        column == 0
    }

    fn fall(&self) -> Option<Stribeck> {
        Some(*self)
    }

    fn action(&self, at: &Instant, vs: f64, own: &[f64]) -> Action {
        let left = at.left.unwrap_or_else(|| self.left(at.velocity, vs));
        Action {
            force: own.get(1).copied().unwrap_or(0.0) * left,
            ..Action::level(own[0] * left)
        }
    }

    fn forms(&self) -> &'static [&'static dyn Effect] {
        let (_, lag) = self.places();
        of_lag(self.kind(), lag)
    }

    fn lags(&self) -> &'static [&'static dyn Effect] {
        let (place, _) = self.places();
        of_exponent(self.kind(), place)
    }

    fn lag_s(&self) -> f64 {
        self.lag_s
    }

    fn by_direction(&self) -> Option<&'static dyn Effect> {
        let (place, lag) = self.places();
        Some(of_lag(self.kind() | 1, lag)[place])
    }

    fn lag_growing(&self, growth: f64) -> Option<&'static dyn Effect> {
        let (place, lag) = self.places();
        let kind = 2 * place_of_growth(growth) + usize::from(self.by_direction);
        Some(of_lag(kind, lag)[place])
    }

    fn lag_growth(&self) -> f64 {
        self.growth
    }

    fn form(&self) -> f64 {
        self.exponent
    }

    fn start(&self, dataset: &Dataset) -> f64 {
        5.0 * dataset.moving_velocity
    }

    fn grid(&self, _: &Kinematics, setting: &Setting<'_>) -> Vec<f64> {
        let moving = setting.dataset.moving_velocity;
        geometric(0.7 * moving, 40.0 * moving, 14)
    }

    fn first_step(&self, _: &Kinematics, vs: f64) -> f64 {
        0.15 * vs
    }

    fn bounds(&self, motion: &Kinematics) -> (f64, f64) {
        let fastest = motion
            .velocity_lp
            .iter()
            .fold(0.0, |fastest: f64, v| fastest.max(v.abs()));
        (1.0e-3 * fastest, 0.5 * fastest)
    }

    fn is_physical(&self, fitted: &Fitted<'_>) -> bool {
        let &[c, ref by_direction @ ..] = fitted.own else {
            return false;
        };
        let both_ways = by_direction.iter().all(|other| other.abs() < c);
        both_ways && c > 0.0 && c < LARGEST_RATIO * fitted.coulomb
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        let unit = naming.effort_unit("");
        let excess = naming.coefficient("stribeck_excess", 0, unit.clone());
        let velocity = format!("{}/s", naming.length());
        let velocity = naming.nonlinear("stribeck_velocity", naming.parameter, velocity);
        let exponent = naming.form_half_width.map(|half_width| Named {
            name: "stribeck_exponent".into(),
            value: self.exponent,
            half_width: Some(half_width),
            unit: String::new(),
        });
        let lag = naming.lag_half_width.map(|half_width| Named {
            name: "stribeck_lag".into(),
            value: self.lag_s,
            half_width: Some(half_width.hypot(self.rounding_of_lag_s())),
            unit: "s".into(),
        });
        let growth = naming.lag_half_width.filter(|_| self.growth > 0.0);
        let of_excess = excess.half_width.unwrap_or(0.0) / excess.value.abs();
        let share = (0.5 * (GROWTH_RATIO - 1.0)).hypot(of_excess);
        let growth = growth.map(|_| Named {
            name: "stribeck_lag_growth".into(),
            value: self.growth.min(LARGEST_RATIO),
            half_width: Some(share * self.growth),
            unit: String::new(),
        });
        let by_direction = self
            .by_direction
            .then(|| naming.coefficient("stribeck_excess_by_direction", 1, unit));
        let velocity = Some(velocity);
        let all = [Some(excess), by_direction, velocity, exponent, lag, growth];
        all.into_iter().flatten().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_form_knows_its_place_in_both_rows() {
        for kind in 0..KINDS {
            for (lag, place) in [(0, 0), (1, COUNT - 1), (60, 30), (LAGS - 1, 7)] {
                let by_lag = of_lag(kind, lag)[place];
                let by_exponent = of_exponent(kind, place)[lag];
                let wanted = form(kind, lag, place);
                for effect in [by_lag, by_exponent] {
                    assert_eq!(effect.fall(), Some(wanted));
                }
                assert_eq!((wanted.kind(), wanted.places()), (kind, (place, lag)));
                let both_ways = by_lag.by_direction().unwrap().fall().unwrap();
                assert_eq!(both_ways.kind(), kind | 1);
                assert_eq!(both_ways.places(), (place, lag));
            }
        }
    }

    #[test]
    fn the_nearest_growth_is_within_an_eighth_and_no_number_is_none() {
        for growth in [0.12, 0.2, 0.6, 1.0, 4.0] {
            let own = GAUSSIAN.lag_growing(growth).unwrap().lag_growth();
            assert!((own / growth - 1.0).abs() < 0.125, "{own} for {growth}");
        }
        for none in [f64::NAN, -0.5, 0.0] {
            assert_eq!(GAUSSIAN.lag_growing(none).unwrap().lag_growth(), 0.0);
        }
    }
}
