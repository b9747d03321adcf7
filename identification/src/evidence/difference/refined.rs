//! A wind-up by the load's motion, refined: flanks as far apart as motor − load says, and the
//! friction that leaves least.

use axis_model::EffectName;

use super::beside::Beside;
use super::columns::{Apart, Way};
use super::linearised::Linearised;
use super::load::Carried;
use crate::evidence::thresholds::GAP_FACTOR;

/// Most steps of Gauss and Newton, from where the descents end.
const MOST_STEPS: usize = 5;
/// Part of the squares that a step leaves where no further one is worth it.
const SETTLED: f64 = 0.999;

/// Rounds in which the width of a gap settles: what it is off by falls to less than a third in
/// each.
const FLANK_ROUNDS: usize = 5;
/// The same ways with flanks as far apart as motor − load says. The balance of the motor's forces
/// finds them through the noise of the effort; beside a wind-up without noise the factor of the
/// way across the gap tells how much wider they stand, and comes to one.
pub(super) fn between_refined_flanks(apart: &Apart<'_>, mut ways: Vec<Way>) -> Vec<Way> {
    for _ in 0..FLANK_ROUNDS {
        let fitted = apart.fit(&ways);
        let Some((Way::Flanks(flanks), own)) = fitted.of(EffectName::Backlash) else {
            break;
        };
        if !GAP_FACTOR.contains(&own[0]) {
            break;
        }
        let wider = flanks.wider_by(own[0]);
        for way in &mut ways {
            *way = match *way {
                Way::Flanks(_) => Way::Flanks(wider),
                Way::Carried(carried) => Way::Carried(Carried {
                    flanks: Some(wider),
                    ..carried
                }),
                other => other,
            };
        }
    }
    ways
}

/// The same ways with the bristle that leaves least (Gauss and Newton): a descent of one parameter
/// after the other ends early where rise and velocity go together.
pub(super) fn stepped(apart: &Apart<'_>, mut ways: Vec<Way>, place: usize) -> Vec<Way> {
    let Some(beside) = Beside::of(&apart.where_known(&ways), &ways, place) else {
        return ways;
    };
    let mut best = beside.as_it_was();
    for _ in 0..MOST_STEPS {
        let Some(moved) = Linearised::about(&beside, &best).step() else {
            break;
        };
        let moved = beside.with(moved);
        if moved.left >= best.left {
            break;
        }
        let is_settled = moved.left > SETTLED * best.left;
        best = moved;
        if is_settled {
            break;
        }
    }
    ways[place] = Way::Carried(best.carried);
    ways
}
