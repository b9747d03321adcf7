//! Maxwell slip of the load in the place of its bristle, and what else its friction goes with.
//!
//! Where elements slip is a grid, so their shares are a convex fit beside everything else that is
//! linear. Level and scale of the grid follow by steps of Gauss and Newton, in turn with it, and
//! the grid becomes finer about the elements that have a share.

use super::beside::Beside;
use super::columns::{Apart, Way};
use super::is_clear;
use super::linearised;
use super::load::Carried;
use super::refined::{between_refined_flanks, stepped};
use super::rubbing::{ALIKE, LoadFriction};
use crate::evidence::reversal::slip::{Elements, grid_about};
use crate::fit::blocks::Gain;
use crate::model::effects::geometric;
use crate::model::effects::stribeck::GAUSS;

/// The grid about the deflection of the bristle, as shares of it.
const FROM: f64 = 0.05;
const TO: f64 = 10.0;
/// Number of its ways: one is a quarter more than the one before.
const GRID: u32 = 24;
/// How much longer the next way of the grid is, in the rounds that follow: an element walks along a
/// grid before it becomes finer.
const RATIOS: [f64; 11] = [
    1.12, 1.12, 1.12, 1.06, 1.06, 1.06, 1.03, 1.03, 1.03, 1.015, 1.015,
];
/// The finest one.
const FINEST: f64 = RATIOS[RATIOS.len() - 1];

/// Lags of the falling level that are tried, s.
const LAGS: (f64, f64, u32) = (5.0e-4, 6.4e-2, 8);
/// Exponents of its fall that are tried.
const EXPONENTS: [f64; 5] = [0.5, 0.75, 1.0, 1.25, 1.5];
/// A drag is followed up where it leaves less than this of the squares before anything else moves:
/// a tenth has to go in the end.
const PROMISING: f64 = 0.99;

/// Levels forward that are tried, in those of both directions: steps go on from there.
const FORWARD: [f32; 2] = [0.95, 1.05];

/// The same ways with a wind-up whose friction has another law than a bristle alone, where that
/// leaves less on held-out blocks. A lag, an exponent or a level of its own forward that is not
/// needed beside the rest goes again.
pub(super) fn by_another_law(apart: &Apart<'_>, ways: Vec<Way>, place: usize) -> Vec<Way> {
    let apart = &apart.without_strikes(&ways);
    let ways = levelled_otherwise(apart, ways, place);
    let ways = with_elements_and_more(apart, ways, place);
    // Whether a lag grows is not seen before the elements are there.
    let growing = with_a_growing_lag(apart, &ways, place);
    let growing = growing.filter(|growing| is_better(apart, &ways, growing));
    let ways = growing.map_or(ways, |growing| with_better_elements(apart, growing, place));
    let usual = [
        Level::LagGrowth(0.0),
        Level::Lag(0.0),
        Level::Exponent(GAUSS),
        Level::Forward(ALIKE),
    ];
    usual.into_iter().fold(ways, |ways, usual| {
        let plain = with_level(apart, &ways, place, usual);
        plain
            .filter(|plain| !is_better(apart, plain, &ways))
            .unwrap_or(ways)
    })
}

/// What a level does beside falling.
#[derive(Clone, Copy)]
enum Level {
    /// It falls with such a lag, s.
    Lag(f64),
    /// Its lag grows by such a share.
    LagGrowth(f64),
    /// It falls by such an exponent.
    Exponent(f64),
    /// It is so high forward.
    Forward(f32),
}

/// The same ways with another lag and another exponent of the falling level, and another level
/// forward, the one that leaves least first.
fn levelled_otherwise(apart: &Apart<'_>, mut ways: Vec<Way>, place: usize) -> Vec<Way> {
    while let Some(better) =
        with_another_level(apart, &ways, place).filter(|better| is_better(apart, &ways, better))
    {
        ways = better;
    }
    ways
}

/// The same ways with the lag, its growth, the exponent or the level forward that leaves least, of
/// what it has not yet.
fn with_another_level(apart: &Apart<'_>, ways: &[Way], place: usize) -> Option<Vec<Way>> {
    let own = carried(ways, place)?.friction;
    let exponents = EXPONENTS.into_iter().map(Level::Exponent);
    let forward = FORWARD.into_iter().map(Level::Forward);
    let exponents = exponents.filter(|_| own.exponent == GAUSS);
    let forward = forward.filter(|_| own.forward == ALIKE);
    let tried = exponents.chain(forward);
    let tried = tried.filter_map(|level| with_level(apart, ways, place, level));
    let tried = with_lags(apart, ways, place).chain(tried);
    with_the_best(apart, tried.chain(with_a_growing_lag(apart, ways, place)))
}

/// The same ways with each of the lags that are tried, where nothing lags.
fn with_lags(apart: &Apart<'_>, ways: &[Way], place: usize) -> impl Iterator<Item = Vec<Way>> {
    let own = carried(ways, place).filter(|own| own.friction.lag_s == 0.0);
    let (from, to, count) = LAGS;
    let lags = own
        .map(|_| geometric(from, to, count))
        .into_iter()
        .flatten();
    lags.filter_map(move |lag_s| with_level(apart, ways, place, Level::Lag(lag_s)))
}

/// Of ways those that leave least.
fn with_the_best(apart: &Apart<'_>, tried: impl Iterator<Item = Vec<Way>>) -> Option<Vec<Way>> {
    let tried = tried.map(|ways| (apart.blocks(&ways).fit().sse, ways));
    let best = tried.min_by(|a, b| a.0.total_cmp(&b.0));
    best.map(|(_, ways)| ways)
}

/// The same ways with a lag that grows; `None` where nothing lags, or it grows already.
pub(super) fn with_a_growing_lag(
    apart: &Apart<'_>,
    ways: &[Way],
    place: usize,
) -> Option<Vec<Way>> {
    let own = carried(ways, place)?.friction;
    if own.lag_s == 0.0 || own.lag_growth > 0.0 {
        return None;
    }
    with_level(apart, ways, place, Level::LagGrowth(own.rise))
}

/// The same ways with such a level; `None` where it is so already, or would fall otherwise and does
/// not fall.
fn with_level(apart: &Apart<'_>, ways: &[Way], place: usize, level: Level) -> Option<Vec<Way>> {
    let own = carried(ways, place)?;
    let friction = own.friction;
    let (friction, falls) = match level {
        Level::Lag(lag_s) => (friction.lagging(lag_s), true),
        Level::LagGrowth(growth) => (friction.lag_growing(growth), true),
        Level::Exponent(exponent) => (
            LoadFriction {
                exponent,
                ..friction
            },
            true,
        ),
        Level::Forward(forward) => (
            LoadFriction {
                forward,
                ..friction
            },
            false,
        ),
    };
    (friction != own.friction && (friction.rise > 0.0 || !falls)).then(|| {
        let changed = instead(ways, place, Carried { friction, ..own });
        stepped(apart, changed, place)
    })
}

fn with_elements_and_more(apart: &Apart<'_>, ways: Vec<Way>, place: usize) -> Vec<Way> {
    let first = with_elements_or_a_lag_beside(apart, ways, place);
    let more = with_more(apart, first.clone(), place);
    if more == first {
        return first;
    }
    let ways = between_refined_flanks(apart, with_better_elements(apart, more, place));
    stepped(apart, ways, place)
}

/// What ways gain over others on held-out blocks, where the states of both are known.
pub(super) fn gain(apart: &Apart<'_>, before: &[Way], after: &[Way]) -> Gain {
    let apart = apart.where_known(before).where_known(after);
    Gain::of(&apart.cross_validate(before), &apart.cross_validate(after))
}

pub(super) fn is_better(apart: &Apart<'_>, before: &[Way], after: &[Way]) -> bool {
    is_clear(&gain(apart, before, after))
}

/// The same ways with what else the load's friction goes with, one thing after the other.
fn with_more(apart: &Apart<'_>, mut ways: Vec<Way>, place: usize) -> Vec<Way> {
    while let Some(better) = with_one_more(apart, &ways, place) {
        ways = better;
    }
    ways
}

fn with_one_more(apart: &Apart<'_>, ways: &[Way], place: usize) -> Option<Vec<Way>> {
    let carried = carried(ways, place)?;
    let left = |ways: &[Way]| apart.blocks(ways).fit().sse;
    let before = std::cell::LazyCell::new(|| left(ways));
    let others = carried.more.others().into_iter();
    let changed = others.filter_map(|more| {
        let changed = instead(ways, place, Carried { more, ..carried });
        let is_drag = more.squared != carried.more.squared;
        if is_drag && left(&changed) > PROMISING * *before {
            return None;
        }
        Some(stepped(
            apart,
            between_refined_flanks(apart, changed),
            place,
        ))
    });
    let falling = std::iter::once_with(|| with_another_level(apart, ways, place));
    let mut changed = changed.chain(falling.flatten());
    changed.find(|changed| holds_back(apart, changed, place) && is_better(apart, ways, changed))
}

/// Whether a drag, where there is one, is against the motion: a fall about the highest velocity is
/// a drag that pushes.
pub(super) fn holds_back(apart: &Apart<'_>, ways: &[Way], place: usize) -> bool {
    let is_dragged = carried(ways, place).is_some_and(|own| own.more.squared);
    let fitted = apart.fit(ways);
    let drag = fitted.at(place).and_then(|(_, own)| own.last().copied());
    !is_dragged || drag.is_some_and(|drag| drag > 0.0)
}

pub(super) fn carried(ways: &[Way], place: usize) -> Option<Carried> {
    match ways.get(place)? {
        Way::Carried(carried) => Some(*carried),
        _ => None,
    }
}

pub(super) fn instead(ways: &[Way], place: usize, carried: Carried) -> Vec<Way> {
    let mut changed = ways.to_vec();
    changed[place] = Way::Carried(carried);
    changed
}

/// The same ways with better elements. Where none are, they are asked for beside a lag: behind a
/// deep bristle neither says much without the other.
fn with_elements_or_a_lag_beside(apart: &Apart<'_>, ways: Vec<Way>, place: usize) -> Vec<Way> {
    let better = with_better_elements(apart, ways.clone(), place);
    if better != ways {
        return better;
    }
    let lagging = with_the_best(apart, with_lags(apart, &ways, place));
    let both = lagging.and_then(|lagging| with_elements(apart, &lagging, place));
    let both = both.filter(|both| is_better(apart, &ways, both));
    both.unwrap_or(ways)
}

/// The same ways with elements that leave clearly less than what they have, where some do.
fn with_better_elements(apart: &Apart<'_>, ways: Vec<Way>, place: usize) -> Vec<Way> {
    let changed = with_elements(apart, &ways, place);
    let changed = changed.filter(|changed| is_better(apart, &ways, changed));
    changed.unwrap_or(ways)
}

/// The same ways with the elements that leave least about the deflection of a wind-up.
fn with_elements(apart: &Apart<'_>, ways: &[Way], place: usize) -> Option<Vec<Way>> {
    let mut changed = ways.to_vec();
    let about = carried(ways, place)?.friction.deflection;
    let mut grid = geometric(FROM * about, TO * about, GRID);
    for ratio in RATIOS {
        let own = carried(&changed, place)?;
        let beside = Beside::of(&apart.where_known(&changed), &changed, place)?;
        let (free, blocks) = beside.slipped(&grid);
        let parts = blocks.non_negative_beside(free);
        let friction = own.friction.slipping(&grid, &parts)?;
        changed = instead(&changed, place, Carried { friction, ..own });
        let moved = linearised::step(&apart.where_known(&changed), &changed, place);
        let moved = moved.unwrap_or(Carried { friction, ..own });
        changed = instead(&changed, place, moved);
        grid = grid_about(&moved.friction.elements(), ratio);
    }
    Some(stepped(apart, changed, place))
}

/// The elements of a wind-up with what they are without each fold of the record.
pub(super) fn elements(apart: &Apart<'_>, ways: &[Way], place: usize) -> Option<Elements> {
    let own = carried(ways, place)?.friction.elements();
    if own.is_empty() {
        return None;
    }
    let grid = grid_about(&own, FINEST);
    let beside = Beside::of(&apart.where_known(ways), ways, place)?;
    let (free, blocks) = beside.slipped(&grid);
    Elements::of(&grid, &blocks.non_negative_beside_without_folds(free), &own)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::difference::carried::instead as carried_instead;
    use crate::evidence::difference::carried::tests::{FRICTION, UNIT, WAYS, apart, axis, rubbed};

    #[test]
    fn elements_and_another_viscous_friction_either_way_are_found() {
        let at = [4.0e-6, 20.0e-6, 60.0e-6];
        let truth = FRICTION.slipping(&at, &[0.3, 0.4, 0.3]).unwrap();
        let axis = rubbed(truth, 60.0, |_| 0.0);
        let apart = apart(&axis);
        let ways = carried_instead(&apart, &WAYS, UNIT, 0.0).unwrap();
        let found = carried(&ways, 1).unwrap();
        assert!(
            found.more.by_direction && !found.more.over_position,
            "{found:?}"
        );
        let told = elements(&apart, &ways, 1).unwrap();
        let deflection = told.known_deflection();
        let off = (deflection.value / truth.deflection - 1.0).abs();
        assert!(off < 0.05, "{deflection:?} {}", truth.deflection);
        // The force after any way from rest.
        for way in [1.0e-6, 4.0e-6, 10.0e-6, 20.0e-6, 40.0e-6] {
            let wanted: f64 = truth
                .elements()
                .iter()
                .map(|(at, share)| share * (way / at).min(1.0))
                .sum();
            let force = told.known_force(way).value;
            assert!((force - wanted).abs() < 0.03, "{way}: {force} {wanted}");
        }
        let own = apart.fit(&ways);
        let (_, own) = own.at(1).unwrap();
        let by_direction = own[Carried::BY_DIRECTION] / own[Carried::VISCOUS];
        assert!((by_direction - 30.0 / 200.0).abs() < 0.02, "{by_direction}");
    }

    #[test]
    fn a_level_that_lags_is_found_with_its_lag() {
        for lag_s in [2.0e-3, 10.0e-3] {
            let truth = LoadFriction { lag_s, ..FRICTION };
            let axis = rubbed(truth, 0.0, |_| 0.0);
            let ways = carried_instead(&apart(&axis), &WAYS, UNIT, 0.0).unwrap();
            let found = carried(&ways, 1).unwrap().friction;
            assert!((found.lag_s / lag_s - 1.0).abs() < 0.05, "{found:?}");
            assert!((found.rise / 0.4 - 1.0).abs() < 0.05, "{found:?}");
        }
    }

    #[test]
    fn elements_that_bend_far_are_found_beside_a_fall_that_lags() {
        let at = [30.0e-6, 150.0e-6, 300.0e-6];
        let deep = LoadFriction {
            lag_s: 12.0e-3,
            ..FRICTION
        };
        let truth = deep.slipping(&at, &[0.2, 0.4, 0.4]).unwrap();
        let axis = rubbed(truth, 0.0, |_| 0.0);
        let apart = apart(&axis);
        let found = carried_instead(&apart, &WAYS, UNIT, 0.0).unwrap();
        let found = carried(&found, 1).unwrap().friction;
        assert!((found.lag_s / 12.0e-3 - 1.0).abs() < 0.1, "{found:?}");
        assert!(!found.elements().is_empty());
        assert!((found.deflection / truth.deflection - 1.0).abs() < 0.1);
    }

    #[test]
    fn a_lag_that_goes_with_the_level_is_told_from_one_that_does_not() {
        for (lag_s, growth) in [(2.0e-3, 0.4), (10.0e-3, 0.6), (10.0e-3, 0.0)] {
            let truth = LoadFriction {
                lag_s,
                lag_growth: growth,
                ..FRICTION
            };
            let axis = rubbed(truth, 0.0, |_| 0.0);
            let ways = carried_instead(&apart(&axis), &WAYS, UNIT, 0.0).unwrap();
            let found = carried(&ways, 1).unwrap().friction;
            let off = (found.lag_growth - growth).abs();
            assert!(off <= 0.1 * growth, "{found:?}");
            assert!((found.lag_s / lag_s - 1.0).abs() < 0.05, "{found:?}");
        }
    }

    #[test]
    fn the_exponent_of_a_fall_is_found_alone_and_beside_a_lag() {
        for (exponent, lag_s) in [(1.0, 0.0), (0.7, 0.0), (1.0, 5.0e-3)] {
            let truth = LoadFriction {
                lag_s,
                exponent,
                ..FRICTION
            };
            let axis = rubbed(truth, 0.0, |_| 0.0);
            let ways = carried_instead(&apart(&axis), &WAYS, UNIT, 0.0).unwrap();
            let found = carried(&ways, 1).unwrap().friction;
            assert!((found.exponent / exponent - 1.0).abs() < 0.1, "{found:?}");
            assert!((found.lag_s - lag_s).abs() <= 0.1 * lag_s, "{found:?}");
            assert!((found.rise / 0.4 - 1.0).abs() < 0.1, "{found:?}");
        }
    }

    #[test]
    fn a_level_that_differs_by_direction_is_found_for_bristles_and_elements() {
        let at = [4.0e-6, 20.0e-6, 60.0e-6];
        let slips = FRICTION.slipping(&at, &[0.3, 0.4, 0.3]).unwrap();
        for (friction, forward) in [(FRICTION, 1.12), (FRICTION, 0.9), (slips, 0.88)] {
            let truth = LoadFriction {
                forward,
                ..friction
            };
            let axis = rubbed(truth, 0.0, |_| 0.0);
            let ways = carried_instead(&apart(&axis), &WAYS, UNIT, 0.0).unwrap();
            let found = carried(&ways, 1).unwrap().friction;
            assert!((found.forward - forward).abs() < 0.01, "{found:?}");
        }
    }

    #[test]
    fn a_bristle_stays_one_however_closely_it_is_asked() {
        let axis = axis(|_| 0.0);
        let apart = apart(&axis);
        let ways = carried_instead(&apart, &WAYS, UNIT, 0.0).unwrap();
        let found = carried(&ways, 1).unwrap();
        assert!(found.rubs_as_a_bristle(), "{found:?}");
        assert_eq!(elements(&apart, &ways, 1), None);
    }
}
