//! A spring between motor and load, and the friction of the motor's own side before it, by the
//! rows in which the motor moves.
//!
//! A spring is wound up by the effort less what the motor's own side takes of it: inertia, Coulomb
//! and viscous friction, and a damper beside the spring follows the rate of the effort. Where the
//! motor stands its friction is whatever holds: those rows bias the stiffness, by up to a third.
//! They are judged all the same when names are given, for a gap shows there. The damper is asked
//! because its part goes with the motion; as far as it moves the stiffness, that is uncertain.

use axis_model::EffectName;

use super::columns::{Apart, Way};
use super::known::Known;
use crate::fit::plain::Plain;

/// What moving rows tell of a spring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spring {
    /// Its stiffness.
    pub stiffness: Known,
    /// Coulomb friction of the motor's own side.
    pub motor_coulomb: Known,
}

/// The spring among ways without a gap; `None` where the motor comes out with a mass or a friction
/// that it cannot have: then the record does not tell it.
pub(super) fn on_moving_rows(apart: &Apart<'_>, ways: &[Way]) -> Option<Spring> {
    let place = ways
        .iter()
        .position(|way| way.called() == EffectName::Compliance)?;
    let is_gap = |way: &Way| matches!(way, Way::Play(_) | Way::Flanks(_));
    if ways.iter().any(is_gap) {
        return None;
    }
    let mut ways = ways.to_vec();
    ways[place] = Way::WindUp {
        motor_friction: true,
    };
    let moving = apart.where_moving();
    let first: usize = ways[..place].iter().map(|way| way.width()).sum();
    let mut columns = moving.design(&ways);
    let undamped = spring(&moving, &columns, first)?;
    columns.push(moving.rate_of_force());
    let damped = spring(&moving, &columns, first)?;
    Some(Spring {
        stiffness: damped.stiffness.beside(undamped.stiffness),
        motor_coulomb: damped.motor_coulomb.beside(undamped.motor_coulomb),
    })
}

/// The spring by columns of which those of the wind-up begin at a place: softness, what the motor's
/// mass takes of it, and its friction.
fn spring(apart: &Apart<'_>, columns: &[Vec<f64>], first: usize) -> Option<Spring> {
    let blocks = apart.blocks_of(columns, &apart.target);
    let (own, half_widths) = (blocks.fit().coefficients, blocks.half_widths());
    let known = |place: usize| Known::new(own[first + place], half_widths[first + place]);
    let [softness, inertia, friction] = [0, 1, 2].map(known);
    let motor_mass = -inertia.value / softness.value;
    let masses = 0.0..Plain::moved_mass(apart.motion);
    let rubs = friction.value <= friction.half_width;
    let can_be = softness.value > 0.0 && masses.contains(&motor_mass) && rubs;
    can_be.then(|| {
        let stiffness = softness.inverse();
        Spring {
            stiffness,
            motor_coulomb: friction.times(stiffness).of(-1.0),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::super::carried::tests::{WAYS, apart, axis};
    use super::super::columns::Path;
    use super::*;
    use crate::fit::made::{self, usual};

    /// 30 of 90 kg and 10 of the 25 N of friction on the motor, the rest behind 5 N/µm with a
    /// damper that lets it follow over so many seconds; 30 N change with position.
    fn known(follows_s: f64) -> Option<Spring> {
        let mut axis = made::axis(|motion, row| {
            usual(motion, row) + 30.0 * (700.0 * motion.position_lp[row]).sin()
        });
        let motion = &mut axis.motion;
        let share = 1.0 - (-motion.period_s / follows_s).exp();
        let mut apart = 0.0;
        let after = |row: usize| {
            let own = 30.0 * motion.acceleration[row] + 10.0 * motion.direction[row];
            apart += share * ((motion.effort[row] - own) / 5.0e6 - apart);
            apart
        };
        motion.difference = Some((0..motion.len()).map(after).collect());
        let path = Path {
            position: &axis.dataset.train.position,
            transmitted: &axis.motion.effort_lp,
            hold: axis.dataset.hold,
        };
        let wind_up = Way::WindUp {
            motor_friction: false,
        };
        let apart = Apart::on(&axis.motion, path).unwrap();
        on_moving_rows(&apart, &[Way::Constant, wind_up])
    }

    #[test]
    fn the_moving_rows_tell_spring_and_friction_of_the_motor_with_a_damper_and_without() {
        for follows_s in [1.0e-6, 2.0e-3] {
            let known = known(follows_s).unwrap();
            for (known, wanted) in [(known.stiffness, 5.0e6), (known.motor_coulomb, 10.0)] {
                let off = (known.value - wanted).abs();
                assert!(off < 0.02 * wanted, "{follows_s} {known:?}");
                assert!(known.half_width < 0.05 * wanted, "{follows_s} {known:?}");
            }
        }
    }

    #[test]
    fn between_flanks_and_without_a_spring_nothing_is_told() {
        let axis = axis(|_| 0.0);
        let apart = apart(&axis);
        let gap = Way::Play(crate::simulate::load::Behind::default());
        let behind_a_gap = [&WAYS[..], &[gap]].concat();
        assert!(on_moving_rows(&apart, &behind_a_gap).is_none());
        assert!(on_moving_rows(&apart, &WAYS[..1]).is_none());
    }
}
