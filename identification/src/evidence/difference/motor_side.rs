//! The stiffness between motor and load, beside friction of the motor's own side.
//!
//! ```text
//! F = M1·a1 + Fc1·z1 + d1·ż1 + Fv1·v1 + F0 + K·w + C·ẇ
//! ```
//!
//! w is the wind-up and z1 the bend of the motor's own friction, which follows the law of the
//! load's with a deflection of its own. A spring that is wound up by the friction of a load alone
//! and one that is as much softer as the motor takes of that friction look nearly alike: w goes
//! with acceleration, friction and velocity of the load, and the motor has hardly another motion.
//! They differ by what accelerates the motor while the spring winds up, M1·ẅ, and by how its own
//! friction turns over. So without friction of the motor's side a stiffness is too large by the
//! share that is not seen of it, and the mass of the load with it. Whether it is seen or not, what
//! the record leaves open of it is in the interval.
//!
//! The motor's friction may turn over by another law than the load's. So it is also fitted by some
//! bends that are free beside each other: that knows less, but holds whatever the law is. Where it
//! contradicts the law of the load's, it stands. First of all it is asked for elements of its own
//! ([`motor_elements`]).
//!
//! How much higher it is at rest is its own, up to twice the load's rise: taken for that it made
//! the stiffness a quarter too large on a machine whose motor has half of it.
//!
//! It goes with what the load's goes with, such as a viscous friction that differs by direction:
//! without that the stiffness of a drawn machine was 256 N/µm for 175, with an interval of 36.
//!
//! Motor − load was measured, so noise of the effort does not bias the stiffness; what encoders
//! round does, and is in the intervals ([`rounding`]).
//! Units: m or rad, s, unit of the effort.

use super::METHOD_OF_STIFFNESS;
use super::columns::Apart;
use super::flanks::{Balance, OWN_WITHOUT_COULOMB, OWN_WITHOUT_FRICTION};
use super::known::Known;
use super::load::{Carried, LoadMotion};
use super::motor_elements;
use super::motor_friction::{HIDDEN_BY_ROUNDING, MotorSide, Rubbing, Seen, is_between_ends};
use super::rounding;
use super::rubbing::Law;
use super::smallest::Smallest;
use super::spring::Spring;
use crate::evidence::thresholds::WRONG_IN_FORM;
use crate::fit::blocks::Blocks;

/// Where the motor's part of a friction is taken for one like the load's it may have no rise or
/// damping, or twice as much. More than this share of the whole is not open: so much the effort
/// tells.
const MOST_UNLIKE: f64 = 0.4;
/// What friction and stiffness are told apart to at best, as a share of the stiffness: it came out
/// with 0.3 to 3.3 % beside the truth on seven drawn machines, most often too soft, with 0.7 % of
/// itself in the statistical interval and less (2026-11-27; 2.1 % without noise of the effort). Why
/// is not known.
const APART: f64 = 0.04;
/// A stiffness is not known from this half width on, as a share of it: half of it, once the report
/// has made it wider.
const VAGUE: f64 = 0.5 / WRONG_IN_FORM;
/// Part of the motor's friction, and of what it does to the stiffness, that is open where it
/// follows a law of elements that slip, the load's. Three machines whose motor had others came out
/// with 3, 6 and 19 % of that beside the truth, beyond what free bends say (2026-11-27).
const OPEN_BY_ELEMENTS: f64 = 0.5;
/// A rise of the motor's friction that is the load's.
const ALIKE: Known = Known::new(1.0, 0.0);
/// One that is not told apart from that.
const ALIKE_OR_NOT: Known = Known::new(1.0, 1.0);

/// The stiffness between motor and load.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stiffness {
    /// Value.
    pub known: Known,
    /// What it would be without friction of the motor's own side.
    pub unrubbed: Known,
    /// Friction of the motor's own side, where some is seen.
    pub motor_side: Option<MotorSide>,
    /// How much higher that is at rest, in the rise of the load's friction.
    pub fall: Known,
}

impl Stiffness {
    /// The same, or what the rows in which the motor moves tell, where all rows do not know it: the
    /// bearings of a motor may turn over at once, and no bend of theirs is as short.
    pub(super) fn or_on_moving_rows(self, spring: Option<Spring>) -> Self {
        let is_known = |known: Known| known.half_width < VAGUE * known.value;
        let is_asked = !is_known(self.known);
        let Some(spring) = spring.filter(|spring| is_asked && is_known(spring.stiffness)) else {
            return self;
        };
        let rubs = spring.motor_coulomb.value > spring.motor_coulomb.half_width;
        Self {
            known: spring.stiffness.within_share(METHOD_OF_STIFFNESS),
            motor_side: rubs.then_some(MotorSide {
                coulomb: spring.motor_coulomb,
                deflection: None,
                law: None,
            }),
            fall: if rubs { ALIKE_OR_NOT } else { ALIKE },
            ..self
        }
    }

    /// What levels of the load's friction over the stiffness have to be multiplied with to be those
    /// of both sides, where the load has such a Coulomb level over the stiffness.
    pub(super) fn of_both(&self, coulomb: Known) -> Known {
        let Some(motor) = self.motor_side else {
            return self.unrubbed;
        };
        let both = self.known.value + motor.coulomb.value / coulomb.value;
        let both = Known::new(1.0, self.unrubbed.half_width / self.unrubbed.value).of(both);
        // What moving rows tell is not of the rows that tell the whole.
        match motor.deflection {
            Some(_) => both,
            None => both.beside(self.unrubbed),
        }
    }

    /// What a rise of the load's friction has to be multiplied with to be that of both sides.
    pub(super) fn rise_of_both(&self, coulomb: Known) -> Known {
        let Some(_) = self.motor_side else {
            return Known::new(1.0, self.fall.half_width.min(MOST_UNLIKE));
        };
        let motor_share = 1.0 - self.known.value / self.of_both(coulomb).value;
        let open = (motor_share * self.fall.half_width).min(MOST_UNLIKE);
        Known::new(1.0 - motor_share * (1.0 - self.fall.value), open)
    }

    /// What is not known of a friction of both sides whose motor's part is taken for the load's, as
    /// a share of it.
    pub(super) fn unlike(&self, coulomb: Known) -> f64 {
        let motor_share = 1.0 - self.known.value / self.of_both(coulomb).value;
        if self.motor_side.is_some() {
            motor_share.min(MOST_UNLIKE)
        } else {
            0.0
        }
    }
}

/// The stiffness as the effort shows it; `None` where it would be below zero. A motor that turns by
/// less than a count of its encoder does not.
pub(super) fn stiffness(
    apart: &Apart<'_>,
    carried: Carried,
    smallest: Smallest,
) -> Option<Stiffness> {
    let balance = Balance::of(apart);
    let wound = balance.wound(carried.flanks);
    let motor = LoadMotion::of_motor(apart.motion, apart.path.position, smallest.motor_count);
    let rubbing = Rubbing {
        motor: &motor,
        rounding: rounding::in_the_difference(apart, smallest),
        wound: &wound,
        apart,
        rows: &balance.rows(&OWN_WITHOUT_COULOMB, &wound, &apart.mask),
        carried,
        fall: 1.0,
        balance: &balance,
    };
    let plain = balance.rows(&OWN_WITHOUT_FRICTION, &wound, &apart.mask);
    let plain = Blocks::with(&plain, &[]);
    let without = plain.cross_validate();
    let softer = rubbing.softens(&OWN_WITHOUT_FRICTION, &[]);
    let unrubbed = last(&without.coefficients, &plain.half_widths())?.within_share(softer);
    let alike = rubbing;
    let (rubbing, best) = alike.with_its_own_fall(&without);
    let by_law = rubbing.at(best);
    let own = motor_elements::told(&rubbing, &by_law, unrubbed, &without);
    let seen = own.filter(|seen| seen.can_be(unrubbed)).or_else(|| {
        let is_clear = by_law.is_clear(&without);
        let seen = is_clear.then(|| rubbing.by_the_loads_law(by_law.seen, best, unrubbed));
        seen.filter(|seen| seen.can_be(unrubbed))
    });
    let hides = alike.hides(best);
    let known = seen.map_or_else(
        || alike.hiding(unrubbed, by_law.seen.stiffness, hides),
        |seen| seen.stiffness,
    );
    (unrubbed.value > 0.0).then_some(Stiffness {
        known,
        unrubbed,
        motor_side: seen.map(|seen| seen.motor_side),
        fall: seen.map_or(ALIKE.within(hides), |seen| seen.fall),
    })
}

fn last(values: &[f64], half_widths: &[f64]) -> Option<Known> {
    Some(Known::new(*values.last()?, *half_widths.last()?))
}

impl Rubbing<'_> {
    /// What rounding hides of a friction of the motor's side, as a share of the stiffness.
    fn hides(&self, at: f64) -> f64 {
        let softer = self.softens(&OWN_WITHOUT_COULOMB, &self.bend(at));
        (HIDDEN_BY_ROUNDING * softer).min(VAGUE)
    }

    /// A stiffness where no friction of the motor's side is seen: as soft as it would be with as
    /// much of it as could hide, which hides best where it turns over as that of the load does.
    fn hiding(&self, unrubbed: Known, by_law: Known, hides: f64) -> Known {
        let hidden = self.at(1.0).seen.stiffness;
        let softest = [by_law, hidden].map(|known| known.value - known.half_width);
        let less = unrubbed.value - softest[0].min(softest[1]);
        unrubbed.within(less.max(0.0)).within_share(hides)
    }

    /// What is seen where the motor's friction follows the load's law, told apart no better than
    /// this way of doing it does.
    fn by_the_loads_law(&self, by_law: Seen, at: f64, unrubbed: Known) -> Seen {
        let seen = self.by_whatever_law(by_law, at, unrubbed);
        match self.carried.friction.law {
            Law::Slip(_) => seen.open_by_elements(OPEN_BY_ELEMENTS, unrubbed),
            Law::Dahl => seen.apart_by(APART, unrubbed),
        }
    }

    /// What holds of what is seen by the law of the load's, with such a deflection, whatever law
    /// the motor's friction follows: this, with half of what is otherwise with free bends in its
    /// intervals, or what is told with those. A deflection at an end of what was searched, or by a
    /// law that does not hold, is hardly known.
    fn by_whatever_law(&self, mut seen: Seen, at: f64, unrubbed: Known) -> Seen {
        let (free_stiffness, free_coulomb) = self.of_any_shape(unrubbed);
        let (stiffness, coulomb) = (seen.stiffness, seen.motor_side.coulomb);
        let apart = (free_stiffness.value - stiffness.value).abs();
        let contradicts = apart > free_stiffness.half_width.hypot(stiffness.half_width);
        if contradicts || !is_between_ends(at) {
            seen.motor_side.deflection = seen.motor_side.deflection.map(Known::hardly);
        }
        if contradicts {
            seen.fall = ALIKE_OR_NOT;
            return seen.with(free_stiffness, free_coulomb);
        }
        let softer = self.softens(&OWN_WITHOUT_COULOMB, &self.linearised(at));
        seen.fall = seen.fall.within(HIDDEN_BY_ROUNDING * softer);
        let coulomb = coulomb.within(0.5 * (free_coulomb.value - coulomb.value));
        seen.with(stiffness.within(0.5 * apart), coulomb)
            .apart_by(softer, unrubbed)
    }
}

#[cfg(test)]
mod tests {
    use super::super::carried::instead;
    use super::super::carried::tests::{
        FRICTION, STIFFNESS, UNIT, WAYS, apart, axis, rubbed_on_both,
    };
    use super::super::columns::Way;
    use super::super::rubbing::LoadFriction;
    use super::*;
    use crate::fit::made::Axis;

    /// Encoders that round nothing.
    const FINE: Smallest = Smallest {
        count: 0.0,
        motor_count: 0.0,
        velocity: 0.0,
    };

    /// What the balance says beside the wind-up that the load's motion asks for.
    fn told(axis: &Axis) -> Stiffness {
        told_of(axis, FINE)
    }

    /// The same before encoders with such counts.
    fn told_of(axis: &Axis, smallest: Smallest) -> Stiffness {
        let apart = apart(axis);
        let ways = instead(&apart, &WAYS, UNIT, 0.0).unwrap();
        let Way::Carried(carried) = ways[1] else {
            panic!("{ways:?}")
        };
        stiffness(&apart.where_known(&ways), carried, smallest).unwrap()
    }

    /// Stiffness and friction of the motor's side as they are told beside 25 N of the load's.
    fn both_told(by_direction: [f64; 2], fall: f64) -> Stiffness {
        let motor = LoadFriction {
            deflection: 0.4 * FRICTION.deflection,
            rise: fall * FRICTION.rise,
            ..FRICTION
        };
        let axis = rubbed_on_both(FRICTION, by_direction, (15.0, motor), |_| 0.0);
        let told = told(&axis);
        let seen = told.motor_side.unwrap();
        // A bristle is none of elements.
        assert!(seen.elements().is_empty(), "{seen:?}");
        for (known, truth) in [
            (told.known, STIFFNESS),
            (seen.coulomb, 15.0),
            (seen.deflection.unwrap(), motor.deflection),
        ] {
            let off = (known.value - truth).abs();
            assert!(off < 0.1 * truth && off < known.half_width, "{known:?}");
        }
        told
    }

    #[test]
    fn viscous_friction_that_differs_by_direction_on_both_sides_is_no_stiffness() {
        let _ = both_told([60.0, 40.0], 1.0);
    }

    #[test]
    fn friction_of_the_motors_side_falls_in_its_own_way() {
        for fall in [0.25, 1.5] {
            let told = both_told([0.0; 2], fall);
            assert!((told.fall.value - fall).abs() < 0.2, "{fall} {told:?}");
        }
    }

    #[test]
    fn friction_of_the_motors_side_is_seen_by_how_it_turns_over() {
        let told = both_told([0.0; 2], 1.0);
        // Without it the spring would be as much stiffer as the load has less of all friction.
        let stiffer = told.unrubbed.value / STIFFNESS;
        assert!((stiffer / (40.0 / 25.0) - 1.0).abs() < 0.1, "{stiffer}");
    }

    #[test]
    fn what_a_motor_encoder_rounds_is_in_the_interval() {
        let axis = axis(|_| 0.0);
        let [fine, coarse] = [0.0, 4.0e-6].map(|motor_count| {
            let smallest = Smallest {
                motor_count,
                ..FINE
            };
            told_of(&axis, smallest)
        });
        assert_eq!(fine.known.value, coarse.known.value);
        let wider = |of: fn(&Stiffness) -> Known| of(&coarse).half_width / of(&fine).half_width;
        assert!(wider(|told| told.unrubbed) > 1.1 && wider(|told| told.known) > 1.5);
    }

    #[test]
    fn moving_rows_tell_what_all_rows_do_not_know() {
        let spring = Spring {
            stiffness: Known::new(4.0e6, 3.0e4),
            motor_coulomb: Known::new(12.0, 2.0),
        };
        let of_all = |half_width: f64| Stiffness {
            known: Known::new(5.0e6, half_width),
            unrubbed: Known::new(6.0e6, 1.0e5),
            motor_side: None,
            fall: ALIKE_OR_NOT,
        };
        let stiffness = |half_width: f64, spring: Option<Spring>| {
            of_all(half_width).or_on_moving_rows(spring).known.value
        };
        assert_eq!(stiffness(2.0e6, Some(spring)), 5.0e6);
        assert_eq!(stiffness(3.0e6, None), 5.0e6);
        let told = of_all(3.0e6).or_on_moving_rows(Some(spring));
        assert_eq!(
            told.known,
            spring.stiffness.within_share(METHOD_OF_STIFFNESS)
        );
        let motor = told.motor_side.unwrap();
        assert_eq!(
            (motor.coulomb, motor.deflection),
            (spring.motor_coulomb, None)
        );
        // A friction that may be none is none.
        let unsure = Spring {
            motor_coulomb: Known::new(2.0, 3.0),
            ..spring
        };
        assert_eq!(
            of_all(3.0e6).or_on_moving_rows(Some(unsure)).motor_side,
            None
        );
    }

    #[test]
    fn where_none_is_seen_what_could_hide_is_in_the_interval() {
        let told = told(&axis(|_| 0.0));
        assert_eq!(told.motor_side, None);
        assert_eq!(told.known.value, told.unrubbed.value);
        assert!(told.known.half_width > 3.0 * told.unrubbed.half_width);
        assert!((told.unrubbed.value / STIFFNESS - 1.0).abs() < 0.005);
    }

    /// What is told of a load with such friction and a motor with elements of its own.
    fn elements_told(of_load: LoadFriction, of_motor: LoadFriction) {
        let axis = rubbed_on_both(of_load, [0.0; 2], (30.0, of_motor), |_| 0.0);
        let told = told(&axis);
        let off = (told.known.value - STIFFNESS).abs();
        assert!(
            off < 0.05 * STIFFNESS && off < told.known.half_width,
            "{told:?}"
        );
        let motor = told.motor_side.unwrap();
        assert!(
            (motor.coulomb.value - 30.0).abs() < 2.0,
            "{:?}",
            motor.coulomb
        );
        let force = |elements: &[(f64, f64)], way: f64| -> f64 {
            let own = elements.iter();
            own.map(|(at, share)| share * (way / at).min(1.0)).sum()
        };
        for way in [1.0e-6, 4.0e-6, 10.0e-6, 30.0e-6] {
            let [is, wanted] = [motor.elements(), of_motor.elements()].map(|own| force(&own, way));
            assert!((is - wanted).abs() < 0.05, "{way}: {is} {wanted}");
        }
    }

    #[test]
    fn elements_of_the_motor_have_nothing_to_do_with_those_of_the_load() {
        let of_load = FRICTION.slipping(&[4.0e-6, 20.0e-6, 60.0e-6], &[0.3, 0.4, 0.3]);
        let of_motor = FRICTION.slipping(&[2.0e-6, 6.0e-6, 40.0e-6], &[0.6, 0.1, 0.3]);
        elements_told(of_load.unwrap(), of_motor.unwrap());
    }

    #[test]
    fn elements_of_the_motor_are_told_beside_a_bristle_of_the_load() {
        let of_motor = FRICTION.slipping(&[2.0e-6, 6.0e-6, 40.0e-6], &[0.6, 0.1, 0.3]);
        elements_told(FRICTION, of_motor.unwrap());
    }
}
