//! Stribeck fall: friction above the Coulomb level at low speed, `c·sign(v)·exp(−|v / vs|^p)`.
//!
//! The exponent p is 2 with Gauss, 1 with Tustin, ½ with Bo and Pavelescu (Armstrong-Hélouvry,
//! Dupont and Canudas de Wit, Automatica 30, 1994). Each exponent is a form of the same effect.
//! Gauss is the usual one; another has to beat it. Where friction differs by direction, so does its
//! fall: `(c sign(v) + d)·exp(−|v / vs|^p)`, with the larger excess the way of the sign of d.

use axis_model::EffectName;

use super::{Action, Effect, Fitted, Instant, Kinematics, Named, Naming, Setting, geometric};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// c·sign(v)·exp(−|v/vs|^p), for each direction its own c where it falls by direction.
#[derive(Clone, Copy)]
pub(crate) struct Stribeck {
    exponent: f64,
    by_direction: bool,
}

/// Smallest exponent.
const SMALLEST: f64 = 0.5;
/// From one exponent to the next.
const STEP: f64 = 0.025;
/// Number of exponents: the last is 2.
const COUNT: usize = 61;
/// One for each exponent, the same both ways and by direction.
static BOTH_WAYS: [Stribeck; COUNT] = exponents(false);
static BY_DIRECTION: [Stribeck; COUNT] = exponents(true);
static FORMS_BOTH_WAYS: [&dyn Effect; COUNT] = forms(&BOTH_WAYS);
static FORMS_BY_DIRECTION: [&dyn Effect; COUNT] = forms(&BY_DIRECTION);
/// The usual one.
pub(crate) static GAUSSIAN: &Stribeck = &BOTH_WAYS[COUNT - 1];

const fn exponents(by_direction: bool) -> [Stribeck; COUNT] {
    let smallest = Stribeck {
        exponent: SMALLEST,
        by_direction,
    };
    let mut all = [smallest; COUNT];
    let mut place = 0;
    while place < COUNT {
        all[place].exponent += STEP * place as f64;
        place += 1;
    }
    all
}

const fn forms(list: &'static [Stribeck; COUNT]) -> [&'static dyn Effect; COUNT] {
    let mut all: [&'static dyn Effect; COUNT] = [&list[0]; COUNT];
    let mut place = 0;
    while place < COUNT {
        all[place] = &list[place];
        place += 1;
    }
    all
}

impl Stribeck {
    /// What is left of the excess at a velocity.
    fn left(&self, v: f64, vs: f64) -> f64 {
        let ratio = (v / vs).abs();
        let power = if self.exponent == 2.0 {
            ratio * ratio
        } else {
            ratio.powf(self.exponent)
        };
        (-power).exp()
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
        let fall: Vec<f64> = motion
            .velocity_lp
            .iter()
            .map(|v| self.left(*v, vs))
            .collect();
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

    fn is_level(&self) -> bool {
        !self.by_direction
    }

    fn fall_exponent(&self) -> Option<f64> {
        Some(self.exponent)
    }

    fn action(&self, at: &Instant, vs: f64, own: &[f64]) -> Action {
        let left = self.left(at.velocity, vs);
        Action {
            force: own.get(1).copied().unwrap_or(0.0) * left,
            ..Action::level(own[0] * left)
        }
    }

    fn forms(&self) -> &'static [&'static dyn Effect] {
        if self.by_direction {
            &FORMS_BY_DIRECTION
        } else {
            &FORMS_BOTH_WAYS
        }
    }

    fn by_direction(&self) -> Option<&'static dyn Effect> {
        let mut forms = FORMS_BY_DIRECTION.into_iter();
        forms.find(|form| form.form() == self.exponent)
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
        let by_direction = self
            .by_direction
            .then(|| naming.coefficient("stribeck_excess_by_direction", 1, unit));
        let all = [Some(excess), by_direction, Some(velocity), exponent];
        all.into_iter().flatten().collect()
    }
}
