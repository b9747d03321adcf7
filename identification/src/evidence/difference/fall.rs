//! Whether the load's friction falls with the velocity, by the load's own motion.
//!
//! A fall that is slow or small is lost in the noise of an effort. Motor − load shows it through
//! the wind-up: 60 N over 120 N/µm are 50 counts of 10 nm. What the fall is worth is what friction
//! without one leaves more of it, with whatever law of presliding suits that best.

use super::columns::{Apart, Path, Way};
use super::load::Carried;
use super::refined::stepped;
use super::rubbing::LoadFriction;
use super::{Difference, Known, is_clear, slipping};
use crate::evidence::selection::Scored;
use crate::evidence::thresholds::WRONG_IN_FORM;
use crate::fit::blocks::Gain;
use crate::model::inverse::Part;
use crate::motion::kinematics::Kinematics;
use axis_model::EffectName;

/// A fall by less than this share of the level is none.
const SMALLEST: f64 = 0.02;

impl Difference {
    /// The part of a fall of the load's friction that both records show, each by what was made of
    /// it, where none is in the model yet. It is said among the candidates.
    pub(crate) fn name_fall(
        &mut self,
        elsewhere: &Self,
        [(motion, path), (other, there)]: [(&Kinematics, Path<'_>); 2],
    ) -> Option<Part> {
        if !(self.tells_a_fall() && elsewhere.tells_a_fall()) {
            return None;
        }
        let own = self.worth_of_a_fall(motion, path)?;
        let gain = own.smaller(&elsewhere.worth_of_a_fall(other, there)?);
        let told = self.by_the_load.as_ref()?;
        let velocity = told.velocity.value;
        let accepted = is_clear(&gain);
        self.scored.push(Scored {
            effect: EffectName::Stribeck.into(),
            parameter: velocity,
            gain,
            physical: true,
            accepted,
            round: 0,
        });
        let form = told.form().filter(|_| accepted)?;
        Some(Part::found(form, velocity))
    }

    /// Whether the load's motion has a fall beyond its interval and a trifle of the level.
    fn tells_a_fall(&self) -> bool {
        self.by_the_load.as_ref().is_some_and(|told| {
            let Known { value, half_width } = told.excess;
            value > (WRONG_IN_FORM * half_width).max(SMALLEST * told.coulomb.value)
        })
    }

    fn worth_of_a_fall(&self, motion: &Kinematics, path: Path<'_>) -> Option<Gain> {
        let apart = Apart::on(motion, path)?;
        let raw = apart.cleared(&self.extended);
        worth(&apart.seen(&raw), &self.extended.ways())
    }
}

/// What the fall of a wind-up's friction is worth on held-out blocks; `None` where there is none.
fn worth(apart: &Apart<'_>, ways: &[Way]) -> Option<Gain> {
    let is_carried = |way: &Way| matches!(way, Way::Carried(_));
    let place = ways.iter().position(is_carried)?;
    let own = slipping::carried(ways, place)?;
    if own.friction.rise <= 0.0 {
        return None;
    }
    let friction = LoadFriction {
        rise: 0.0,
        ..own.friction
    };
    let level = slipping::instead(ways, place, Carried { friction, ..own });
    let level = stepped(apart, level, place);
    let gain = slipping::gain(apart, &level, ways);
    if !is_clear(&gain) {
        return Some(gain);
    }
    let slips = slipping::by_another_law(apart, level, place);
    Some(gain.smaller(&slipping::gain(apart, &slips, ways)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::difference::carried::instead;
    use crate::evidence::difference::carried::tests::{FRICTION, LEVEL, UNIT, WAYS, apart, rubbed};

    fn worth_of(friction: LoadFriction) -> Option<Gain> {
        let axis = rubbed(friction, 0.0, |_| 0.0);
        let apart = apart(&axis);
        let ways = instead(&apart, &WAYS, UNIT, 0.0).unwrap();
        worth(&apart, &ways)
    }

    #[test]
    fn a_fall_is_worth_what_no_presliding_explains() {
        let gain = worth_of(FRICTION).unwrap();
        assert!(is_clear(&gain) && gain.share > 0.9, "{gain:?}");
    }

    #[test]
    fn friction_without_a_fall_is_worth_none_whatever_its_presliding() {
        let at = [4.0e-6, 20.0e-6, 60.0e-6];
        let slips = LEVEL.slipping(&at, &[0.3, 0.4, 0.3]).unwrap();
        for friction in [LEVEL, slips] {
            let gain = worth_of(friction);
            assert!(!gain.is_some_and(|gain| is_clear(&gain)), "{gain:?}");
        }
    }
}
