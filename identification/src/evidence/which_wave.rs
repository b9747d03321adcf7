//! Which wave number a ripple has, where the record leaves that open.
//!
//! A ripple shows where the axis is slow. How many periods lie between one slow place and the next
//! nothing tells: beside the wave number that leaves the least there are others, a period more or
//! less between those places, that leave nearly as little. Those that the record does not tell from
//! it are in the interval.

use crate::evidence::thresholds::{CERTAIN_T, EFFORT_SHARE};
use crate::fit::bench::Bench;
use crate::fit::blocks::{Fit, Gain};
use crate::fit::search::smallest;
use crate::fit::tuning::{self, Pair, is_new};
use crate::model::effects::{Against, Setting, wave};
use crate::model::inverse::Model;

/// So many orders to either side are looked at; beyond, the low-pass tells waves apart.
const ORDERS: f64 = 1.5;
/// The same as a share of the wave number, where no revolution is known.
const SHARE: f64 = 0.1;
/// Wave numbers that differ by less than so many periods within the travel are one.
const APART_PERIODS: f64 = 0.5;

/// How far away wave numbers are that the record does not tell from that of a part; zero where it
/// tells it from all others.
#[must_use]
pub(crate) fn half_width(bench: &Bench<'_>, model: &Model, place: usize) -> f64 {
    let others = others(bench, model, place);
    if others.is_empty() {
        return 0.0;
    }
    let found = model.parts[place].parameter;
    let own = bench.cross_validate(model);
    let fit_at = |k: f64| bench.cross_validate(&model.with_parameter(place, k));
    others
        .into_iter()
        .filter(|k| is_open(&own, &fit_at(*k)))
        .map(|k| (k - found).abs())
        .fold(0.0, f64::max)
}

/// The model with each wave at the one of the wave numbers about its own that leaves least, where
/// that leaves as much less as an effect has to; `None` where all stay.
///
/// A wave is found before the laws of friction are, and what these leave where the axis is slow is
/// as large as a ripple: a period more or less between slow places may look better then.
#[must_use]
pub(crate) fn settled(pair: Pair<'_>, model: &Model) -> Option<Model> {
    let places = 0..model.parts.len();
    places.fold(None, |moved, place| {
        let other = at_another(pair, moved.as_ref().unwrap_or(model), place);
        other.or(moved)
    })
}

/// The model with the wave of a part at another place.
fn at_another(pair: Pair<'_>, model: &Model, place: usize) -> Option<Model> {
    let bench = pair.bench;
    let at = |k: f64| model.with_parameter(place, k);
    let left = |k: f64| bench.sse(&at(k));
    let best = smallest(&others(bench, model, place), &left)?;
    let other = tuning::refined_at(pair, at(best), place);
    let gain = Gain::of(&bench.cross_validate(model), &bench.cross_validate(&other));
    (gain.share >= EFFORT_SHARE && gain.t >= CERTAIN_T).then_some(other)
}

/// Wave numbers about that of a part that leave little as well; none where it is no wave that was
/// searched.
fn others(bench: &Bench<'_>, model: &Model, place: usize) -> Vec<f64> {
    if !is_wave(model, place) {
        return Vec::new();
    }
    let part = &model.parts[place];
    let found = part.parameter;
    let without = model.without(part);
    let residual = bench.residual(&bench.fit(&without));
    let setting = Setting {
        dataset: bench.dataset,
        residual: &residual,
    };
    let revolution = bench.dataset.revolution();
    let aside = revolution.map_or(SHARE * found, |revolution| ORDERS / revolution);
    let (lowest, _) = part.effect.bounds(bench.motion);
    let ends = [(found - aside).max(lowest), found + aside];
    let [from, to] = ends.map(|k| wave::periods(bench.motion, k));
    let mut near = part.effect.strongest(bench.motion, &setting, from..to);
    near.retain(|k| is_apart(bench, found, *k) && is_new(bench, &without, part.effect, *k));
    near
}

/// Whether a part is a wave over position whose wave number was searched.
fn is_wave(model: &Model, place: usize) -> bool {
    let effect = model.parts[place].effect;
    effect.repeats() && effect.is_tuned() && effect.against() == Against::Period
}

fn is_apart(bench: &Bench<'_>, one: f64, other: f64) -> bool {
    (one - other).abs() > wave::of_periods(bench.motion, APART_PERIODS)
}

/// Whether a record does not tell a fit from another that leaves less. What sits in few blocks has
/// a small t however much it removes.
fn is_open(own: &Fit, other: &Fit) -> bool {
    let gain = Gain::of(other, own);
    gain.t < CERTAIN_T && gain.share < EFFORT_SHARE
}

#[cfg(test)]
mod tests {
    use axis_model::EffectName::{Coulomb, Inertia, Offset, TorqueRipple, Viscous};

    use super::*;
    use crate::fit::made::{self, Axis, usual};
    use crate::motion::kinematics::Kinematics;
    use crate::simulate::made as simulated;

    const LEAD_M: f64 = 0.01;

    /// Slow about some places, 12 N of ripple at an order: a line from place to place, fast, and a
    /// millimetre to and fro at each, slow.
    fn slow_at(places: &[f64], order: f64) -> Axis {
        let position = |t: f64| {
            let (place, within) = ((t / 2.0) as usize, (t / 2.0).fract());
            let [from, to] = [place, place + 1].map(|at| places[at % places.len()]);
            let moved = ((within - 0.8) / 0.2).clamp(0.0, 1.0);
            let there = from + (to - from) * moved * moved * (3.0 - 2.0 * moved);
            let swing = (within / 0.8).min(1.0);
            there + 1.0e-3 * (std::f64::consts::TAU * 1.5 * swing).sin()
        };
        let rows = (0..12_000).map(|row| position(1.0e-3 * f64::from(row)));
        let mut axis = made::on(simulated::record(1.0e-3, rows.collect()));
        axis.dataset.lead_m_per_rev = Some(LEAD_M);
        let ripple = move |motion: &Kinematics, row: usize| {
            let turns = order * motion.position_lp[row] / LEAD_M;
            let noise = 6.0 * (0.71 * (row * row % 3001) as f64).sin();
            12.0 * (std::f64::consts::TAU * turns).sin() + noise
        };
        axis.put(|motion, row| usual(motion, row) + ripple(motion, row));
        axis
    }

    fn found_at(bench: &Bench<'_>, order: f64) -> Model {
        let ripple = made::found(TorqueRipple, order / LEAD_M);
        let model = made::model(&[Inertia, Viscous, Coulomb, Offset]).with(ripple);
        let pair = Pair { bench, low: bench };
        tuning::refined_at(pair, model, 4)
    }

    fn order(model: &Model) -> f64 {
        model.parts[4].parameter * LEAD_M
    }

    #[test]
    fn what_a_record_does_not_tell_apart_is_in_the_interval() {
        // Seven revolutions from place to place: a seventh of an order is a period more.
        let axis = slow_at(&[0.0, 0.07], 12.0);
        let bench = axis.bench();
        let found = found_at(&bench, 12.0 + 1.0 / 7.0);
        let off = (order(&found) - 12.0).abs();
        assert!((off - 1.0 / 7.0).abs() < 0.03, "{off}");
        let open = LEAD_M * half_width(&bench, &found, 4);
        assert!(open >= off - 0.03, "{open} {off}");
    }

    #[test]
    fn a_wave_that_the_record_tells_from_its_neighbours_has_none_beside_it() {
        // Two and a half millimetres from place to place, and a millimetre about each.
        let places: Vec<f64> = (0..6).map(|place| 2.5e-3 * f64::from(place)).collect();
        for of_the_axis in [12.0, 12.4] {
            let axis = slow_at(&places, of_the_axis);
            let bench = axis.bench();
            let found = found_at(&bench, of_the_axis);
            assert!(
                (order(&found) - of_the_axis).abs() < 0.02,
                "{}",
                order(&found)
            );
            assert_eq!(half_width(&bench, &found, 4), 0.0);
        }
    }

    #[test]
    fn a_wave_that_was_found_a_period_beside_its_own_is_put_there() {
        // Seven and four revolutions from place to place, which no other wave fits as well.
        let axis = slow_at(&[0.0, 0.07, 0.11, 0.04], 12.0);
        let bench = axis.bench();
        let beside = found_at(&bench, 12.0 + 1.0 / 7.0);
        assert!((order(&beside) - 12.0).abs() > 0.1, "{}", order(&beside));
        let pair = Pair {
            bench: &bench,
            low: &bench,
        };
        let moved = settled(pair, &beside).unwrap();
        assert!((order(&moved) - 12.0).abs() < 0.02, "{}", order(&moved));
        assert!(settled(pair, &moved).is_none());
    }

    #[test]
    fn where_another_wave_is_there_is_no_other_place_for_one() {
        let axis = slow_at(&[0.0, 0.07], 12.0);
        let bench = axis.bench();
        let twelfth = made::found(TorqueRipple, 12.0 / LEAD_M);
        let both = found_at(&bench, 12.0 + 1.0 / 7.0).with(twelfth);
        let own = &both.parts[4];
        let free = |order: f64| is_new(&bench, &both.without(own), own.effect, order / LEAD_M);
        assert!(!free(12.0) && free(11.0));
    }
}
