//! The stiffness of a spring between motor and load, by the rows in which the motor moves.
//!
//! A spring is wound up by the effort less what the motor's own side takes of it: inertia, Coulomb
//! and viscous friction. Where the motor stands its friction is whatever holds, so those rows may
//! bias the stiffness. They are judged all the same when names are given, for a gap shows there.
//! What the moving rows alone say has more noise and less bias: the difference of both is a measure
//! of how far the stiffness is known.

use axis_model::EffectName;

use super::columns::{Apart, Way};
use super::known::Known;
use crate::fit::plain::Plain;

/// The stiffness of the spring among ways without a gap; `None` where the motor comes out with a
/// mass or a friction that it cannot have: then the record does not tell it.
pub(super) fn on_moving_rows(apart: &Apart<'_>, ways: &[Way]) -> Option<Known> {
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
    let fitted = moving.fit(&ways);
    let (_, &[softness, inertia, friction, _]) = fitted.at(place)? else {
        return None;
    };
    let motor_mass = -inertia / softness;
    let masses = 0.0..Plain::moved_mass(apart.motion);
    let can_be = softness > 0.0 && masses.contains(&motor_mass) && friction <= 0.0;
    let column: usize = ways[..place].iter().map(|way| way.width()).sum();
    let half_width = moving.blocks(&ways).half_widths()[column];
    can_be.then(|| Known {
        value: 1.0 / softness,
        half_width: half_width / softness.powi(2),
    })
}

#[cfg(test)]
mod tests {
    use super::super::carried::tests::{WAYS, apart, axis};
    use super::*;

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
