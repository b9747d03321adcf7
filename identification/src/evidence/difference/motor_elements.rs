//! Elements of the motor's own friction.
//!
//! How the friction of the one side turns over says nothing of that of the other. Taken for that of
//! the load, stretched, it left the stiffness of drawn machines 5 to 19 % beside the truth where
//! springs slip on both sides, and unknown where they do beside a bristle of the load: levels that
//! turn over early and late go into what the spring transmits. So the elements' shares are a convex
//! fit of their own on a fine grid of ways, beside all else that is linear, the stiffness with it,
//! and their rise at rest follows in turn.

use super::flanks::OWN_WITHOUT_COULOMB;
use super::known::Known;
use super::motor_friction::{ByLaw, HIDDEN_BY_ROUNDING, Rubbing, STIFFNESS, Seen, is_between_ends};
use crate::evidence::reversal::slip::grid_about;
use crate::evidence::thresholds::DIFFERENCE_T;
use crate::fit::blocks::{Blocks, Fit, Gain, half_width_without_folds};
use crate::model::effects::geometric;

/// The grid, as shares of the deflection of the load's friction.
const FROM: f64 = 0.05;
const TO: f64 = 12.0;
/// Number of its ways: one is an eighth more than the one before.
const GRID: u32 = 48;
/// How much longer the next way of the grid is, in the rounds that follow.
const RATIOS: [f64; 4] = [1.06, 1.06, 1.03, 1.03];
/// Part of the motor's friction, and of what it does to the stiffness, that is open beside what the
/// folds leave open: of eight drawn machines five came out within 13 % of what it does to the
/// stiffness, two with 20 and 46, and one with 16 % of the friction at its motor with twice that,
/// which its folds do not know (2026-11-29).
const OPEN: f64 = 0.25;
/// What is open of the rise of the motor's friction, in that of the load's: its velocity is taken
/// for that of the load's. Of four drawn machines whose motor has others it came out with 0.05 to
/// 0.3 beside the truth (2026-11-29).
const FALL_OPEN: f64 = 0.25;

/// What is seen by elements of the motor's own, where the fit with these is clearly better than
/// without any friction of the motor's side and than one that follows the law of the load's. Where
/// they slip is chosen by all blocks; that is a part of the gain, which is not held out.
pub(super) fn told(
    alike: &Rubbing<'_>,
    by_law: &ByLaw,
    unrubbed: Known,
    without: &Fit,
) -> Option<Seen> {
    let about = alike.carried.friction.deflection;
    let first = with_elements(*alike, about)?;
    let rubbing = &with_elements(first.with_the_best_fall(), about)?;
    let own = rubbing.at(1.0);
    let gain = Gain::of(&by_law.fit, &own.fit);
    let is_better = gain.share > 0.0 && gain.t >= DIFFERENCE_T;
    (is_better && own.is_clear(without)).then(|| {
        let [open, deep] = open_by_folds(rubbing);
        let softer = rubbing.softens(&OWN_WITHOUT_COULOMB, &rubbing.linearised(1.0));
        let mut seen = own.seen;
        let deflection = seen.motor_side.deflection;
        seen.motor_side.deflection = deflection.map(|own| deep_as_seen(own.within(deep), about));
        seen.motor_side.law = Some(rubbing.carried.friction);
        let by_elements = fall_beside_elements(rubbing) / seen.motor_side.coulomb.value;
        let fall = seen.fall.within(by_elements).within(FALL_OPEN);
        seen.fall = fall.within(HIDDEN_BY_ROUNDING * softer);
        let open = (open / seen.stiffness.value).hypot(softer);
        seen.apart_by(open, unrubbed)
            .open_by_elements(OPEN, unrubbed)
    })
}

/// A deflection, in view of that of the load's friction: hardly known where a law would not have
/// been looked for, as that may be the end of the grid.
fn deep_as_seen(own: Known, about: f64) -> Known {
    if is_between_ends(own.value / about) {
        own
    } else {
        own.hardly()
    }
}

/// The same with the elements that leave least.
fn with_elements(mut rubbing: Rubbing<'_>, about: f64) -> Option<Rubbing<'_>> {
    let mut grid = geometric(FROM * about, TO * about, GRID);
    for ratio in RATIOS {
        let (free, blocks) = slipped(&rubbing, &grid);
        let parts = blocks.non_negative_beside(free);
        rubbing.carried.friction = rubbing.carried.friction.slipping(&grid, &parts)?;
        grid = grid_about(&rubbing.carried.friction.elements(), ratio);
    }
    Some(rubbing)
}

/// Half width of the Coulomb level times the rise of the motor's friction, beside the shares of its
/// elements.
fn fall_beside_elements(rubbing: &Rubbing<'_>) -> f64 {
    let elements = rubbing.carried.friction.elements();
    let ways: Vec<f64> = elements.iter().map(|(way, _)| *way).collect();
    let (_, mut columns) = columns(rubbing, &ways);
    columns.push(rubbing.by_fall(1.0));
    let half_widths = Blocks::with(rubbing.rows, &columns).half_widths();
    half_widths.last().copied().unwrap_or(0.0)
}

/// Gram matrices of all that is free, so many columns, and the elements of a grid.
fn slipped(rubbing: &Rubbing<'_>, grid: &[f64]) -> (usize, Blocks) {
    let (free, columns) = columns(rubbing, grid);
    (free, Blocks::with(rubbing.rows, &columns))
}

/// What goes with a friction of the motor's side that has the elements of a grid, and these; so
/// many columns are free, those that all have among them.
fn columns(rubbing: &Rubbing<'_>, grid: &[f64]) -> (usize, Vec<Vec<f64>>) {
    let motion = rubbing.apart.motion;
    let mut carried = rubbing.carried;
    carried.friction.rise *= rubbing.fall;
    let mut columns = carried.on_motor(motion, rubbing.motor, 1.0);
    // Not the bend, which the elements are, and not its rate.
    columns.remove(0);
    columns.pop();
    let free = rubbing.rows.width() - 1 + columns.len();
    columns.extend(rubbing.motor.slipped(motion, carried.friction, grid));
    (free, rubbing.balance.at_efforts(&columns))
}

/// Half widths of stiffness and deflection by what the elements are without each fold.
fn open_by_folds(rubbing: &Rubbing<'_>) -> [f64; 2] {
    let ratio = RATIOS[RATIOS.len() - 1];
    let grid = grid_about(&rubbing.carried.friction.elements(), ratio);
    let (free, blocks) = slipped(rubbing, &grid);
    let folds = blocks.beside_non_negative_without_folds(free);
    let deflection = |own: &Vec<f64>| {
        let parts = own[free..].iter();
        let stiff: f64 = parts.clone().zip(&grid).map(|(part, way)| part / way).sum();
        parts.sum::<f64>() / stiff
    };
    let stiffness: Vec<f64> = folds.iter().map(|own| own[STIFFNESS]).collect();
    let deflections: Vec<f64> = folds.iter().map(deflection).collect();
    [stiffness, deflections].map(|own| half_width_without_folds(&own))
}
