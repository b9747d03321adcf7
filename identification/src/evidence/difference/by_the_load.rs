//! What the load's own motion tells of the axis, with intervals.
//!
//! Wind-up that is fitted to motor − load ([`carried`](super::carried)) has its coefficients over
//! the stiffness: M2/K, Fc2/K, C/K. The stiffness itself is in the effort alone, beside the wind-up
//! that was measured ([`motor_side`]).
//!
//! Intervals are those of the jackknife over held-out blocks. Deflection, rise and velocity of the
//! bristle have them by the derivative of its columns, which are fitted beside the others; so has
//! the gap by the way across it. A
//! product has the root of the sum of squares of its factors' relative half widths.
//!
//! Units: m or rad, s, unit of the effort.

use super::beside::Beside;
use super::columns::{Apart, Way};
use super::known::Known;
use super::linearised::Linearised;
use super::load::{Carried, More, where_it_moves};
use super::motor_friction::MotorSide;
use super::motor_side::{self, Stiffness};
use super::refined::stepped;
use super::rubbing::{ALIKE, LoadFriction, MOST_GROWTH};
use super::slipping;
use super::smallest::Smallest;
use super::spring::Spring;
use crate::evidence::reversal::slip::Elements;
use crate::evidence::thresholds::METHOD;
use crate::model::effects::Effect;
use crate::model::effects::stribeck::{self, GAUSS};

/// What the load's motion tells.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ByTheLoad {
    /// Stiffness between motor and load.
    pub stiffness: Known,
    /// Damping between them.
    pub damping: Known,
    /// Mass of the load.
    pub mass: Known,
    /// What the stiffness would be without friction of the motor's own side.
    pub unrubbed: Known,
    /// Friction of the motor's own side, where some is seen.
    pub motor_side: Option<MotorSide>,
    /// What else the load's friction goes with.
    pub more: More,
    /// Coulomb level of both sides, in the middle of the travel.
    pub coulomb: Known,
    /// Viscous friction of both sides.
    pub viscous: Known,
    /// How much more of that it has forward than backward, halved, where that is told apart.
    pub viscous_asymmetry: Option<Known>,
    /// By which share the Coulomb level is higher forward and lower backward, where it is seen to.
    pub coulomb_asymmetry: Option<Known>,
    /// Deflection of its bristle: Coulomb level over its stiffness.
    pub deflection: Known,
    /// Elements that slip, where they take the place of its bristle.
    pub elements: Option<Elements>,
    /// Damping of its bristle.
    pub bristle_damping: Known,
    /// Friction at rest beyond the Coulomb level.
    pub excess: Known,
    /// Velocity at which that has fallen to 1/e.
    pub velocity: Known,
    /// Lag with which it follows the velocity, where it does not at once, s.
    pub lag: Option<Known>,
    /// By how much longer it lags at rest, as a share, where it does.
    pub lag_growth: Option<Known>,
    /// Exponent of that fall, where it is not Gauss's.
    pub exponent: Option<Known>,
    /// Width of the gap, where there is one.
    pub gap: Option<Known>,
}

/// Turns of the load that are smaller, in counts of its scale, are those of one count, to which a
/// position next to its edge flips for next to nothing. With them a bristle relaxes that did not:
/// 0.9 N of excess for 120 and 10 µm/s of its velocity for 1.5 mm/s (reference machine,
/// 2026-11-24). 1.5 counts and none are how uncertain that is.
const SMALLEST_TURN: f64 = 1.0;
const OTHER_TURNS: [f64; 2] = [0.0, 1.5];
/// Velocity below which the load rests, in moving velocities. A bristle holds what it was bent to
/// for as long as it rests, and so does an error of that: three quarters of the squares that were
/// left of the reference machine's record are there.
const REST: f64 = 0.1;

/// When the load turned is known to this part of a row. A damping is a force over the stiffness
/// that comes earlier: 1.2 µs of the reference machine's row of a millisecond, 2.1 µs of its
/// bristle, are what both come out beside the truth by (mean of 20 draws, 2026-11-24), 3.8 µs that
/// of a stage of 60 kg (2026-11-25). Scales without counts and eight parts of a row leave a quarter
/// of it.
const TIMING: f64 = 4.0e-3;

/// What the wind-up at a place of such ways tells, by the rows in which the load moves.
pub(super) fn told(
    apart: &Apart<'_>,
    ways: &[Way],
    place: usize,
    smallest: Smallest,
    spring: Option<Spring>,
) -> Option<ByTheLoad> {
    let Some(Way::Carried(carried)) = ways.get(place).copied() else {
        return None;
    };
    let apart = apart.where_known(ways);
    let stiffness = motor_side::stiffness(&apart, carried, smallest)?;
    let stiffness = stiffness.or_on_moving_rows(spring);
    let apart = where_the_load_moves(apart, smallest.velocity);
    let apart = apart.without_strikes(ways);
    let turned = |counts: f64| {
        let smallest_turn = counts * smallest.count;
        let turning = Carried {
            smallest_turn,
            ..carried
        };
        stepped(&apart, slipping::instead(ways, place, turning), place)
    };
    let near = |ways: &[Way]| near(&apart, ways, place, &stiffness);
    let own = turned(SMALLEST_TURN);
    let told = near(&own)?;
    let mut others = OTHER_TURNS.into_iter().map(turned);
    let told = others.try_fold(told, |told, other| Some(told.beside(&near(&other)?)))?;
    let open = with_a_lag_as_good(&apart, &own, place);
    let told = match open.and_then(|open| near(&open)) {
        Some(open) => told.beside(&open),
        None => told,
    };
    let told = told.within(TIMING * apart.motion.period_s).by_method();
    Some(told.slipping(slipping::elements(&apart, ways, place)))
}

/// The same ways with a lag that grows, where theirs does not and leaves no less.
fn with_a_lag_as_good(apart: &Apart<'_>, ways: &[Way], place: usize) -> Option<Vec<Way>> {
    let growing = slipping::with_a_growing_lag(apart, ways, place)?;
    (!slipping::is_better(apart, &growing, ways)).then_some(growing)
}

/// The same, judged where the load does not rest.
fn where_the_load_moves(apart: Apart<'_>, moving_velocity: f64) -> Apart<'_> {
    let (path, slowest) = (apart.path, REST * moving_velocity);
    let mask = where_it_moves(apart.motion, path.position, apart.raw, &apart.mask, slowest);
    Apart { mask, ..apart }
}

/// What a wind-up tells by the fit that is linearised about it.
fn near(apart: &Apart<'_>, ways: &[Way], place: usize, spring: &Stiffness) -> Option<ByTheLoad> {
    let Some(Way::Carried(carried)) = ways.get(place) else {
        return None;
    };
    let beside = Beside::of(apart, ways, place)?;
    let linearised = Linearised::about(&beside, &beside.as_it_was());
    let known = linearised.known();
    let friction = linearised.friction();
    let searched = friction.searched();
    // A step of Gauss and Newton from where the search ended.
    let of_friction = |value: f64, parameter: usize| {
        let place = searched.iter().position(|place| *place == parameter)?;
        let change = known[carried.width() + place];
        Some(Known::new(1.0 + change.value, change.half_width).of(value))
    };
    let stiffness = spring.known;
    let of_both = spring.of_both(known[Carried::FRICTION]);
    let unlike = spring.unlike(known[Carried::FRICTION]);
    let coulomb = known[Carried::FRICTION].times(of_both);
    let damping = known[Carried::DAMPING].times(stiffness);
    let deflection = of_friction(friction.deflection, 0)?;
    let bent = known[Carried::BENDING].times(of_both);
    let rise = of_friction(friction.rise, 1)?;
    Some(ByTheLoad {
        stiffness,
        damping: damping.of(-1.0),
        mass: known[Carried::MASS].times(stiffness),
        unrubbed: spring.unrubbed,
        motor_side: spring.motor_side,
        more: carried.more,
        coulomb,
        viscous: known[Carried::VISCOUS].times(of_both),
        viscous_asymmetry: (carried.more.by_direction)
            .then(|| known[Carried::BY_DIRECTION].times(of_both)),
        coulomb_asymmetry: of_friction(friction.forward.into(), LoadFriction::FORWARD)
            .map(|forward| Known::new(forward.value - f64::from(ALIKE), forward.half_width)),
        deflection,
        elements: None,
        bristle_damping: (bent.times(deflection.inverse())).within_share(unlike),
        excess: (rise.times(coulomb)).times(spring.rise_of_both(known[Carried::FRICTION])),
        velocity: of_friction(friction.velocity, 2)?,
        lag: of_friction(friction.lag_s, LoadFriction::LAG),
        lag_growth: of_friction(friction.lag_growth.into(), LoadFriction::LAG_GROWTH)
            .map(|growth| Known::new(growth.value.min(MOST_GROWTH), growth.half_width)),
        exponent: of_friction(friction.exponent, LoadFriction::EXPONENT),
        gap: gap(linearised.others(), &known[linearised.others_from()..]),
    })
}

impl ByTheLoad {
    /// The form of its fall, where it falls.
    pub(crate) fn form(&self) -> Option<&'static dyn Effect> {
        let value = |known: Option<Known>, usual: f64| known.map_or(usual, |known| known.value);
        let form = stribeck::nearest(value(self.exponent, GAUSS), value(self.lag, 0.0));
        let form = form
            .lag_growing(value(self.lag_growth, 0.0))
            .unwrap_or(form);
        (self.excess.value > 0.0).then_some(form)
    }

    /// The same, with forces that are known in time to so much.
    fn within(self, time_s: f64) -> Self {
        let bristle = self.coulomb.value / self.deflection.value;
        let later = |damping: Known, stiffness: f64| {
            let later = Known::new(damping.value + time_s * stiffness, 0.0);
            damping.beside(later)
        };
        Self {
            damping: later(self.damping, self.stiffness.value),
            bristle_damping: later(self.bristle_damping, bristle),
            ..self
        }
    }

    /// The same, nothing of it better known than a coefficient is.
    fn by_method(self) -> Self {
        let known = |known: Known| known.within_share(METHOD);
        Self {
            stiffness: known(self.stiffness),
            damping: known(self.damping),
            mass: known(self.mass),
            unrubbed: known(self.unrubbed),
            motor_side: self.motor_side,
            more: self.more,
            coulomb: known(self.coulomb),
            viscous: known(self.viscous),
            viscous_asymmetry: self.viscous_asymmetry.map(known),
            coulomb_asymmetry: self.coulomb_asymmetry,
            deflection: known(self.deflection),
            elements: self.elements,
            bristle_damping: known(self.bristle_damping),
            excess: known(self.excess),
            velocity: known(self.velocity),
            lag: self.lag.map(known),
            lag_growth: self.lag_growth.map(known),
            exponent: self.exponent.map(known),
            gap: self.gap.map(known),
        }
    }

    /// The same with elements that slip: what they leave open of the deflection beside its scale.
    fn slipping(mut self, elements: Option<Elements>) -> Self {
        let by_folds = elements.as_ref().map(Elements::known_deflection);
        let open = by_folds.map_or(0.0, |deflection| deflection.half_width);
        self.deflection = self.deflection.within(open);
        Self { elements, ..self }
    }

    /// The same, as uncertain as what else could be told is different.
    fn beside(self, other: &Self) -> Self {
        let both = |own: Option<Known>, other: Option<Known>| {
            let pair = own.zip(other);
            pair.map_or(own, |(own, other)| Some(own.beside(other)))
        };
        Self {
            viscous_asymmetry: both(self.viscous_asymmetry, other.viscous_asymmetry),
            coulomb_asymmetry: both(self.coulomb_asymmetry, other.coulomb_asymmetry),
            damping: self.damping.beside(other.damping),
            mass: self.mass.beside(other.mass),
            coulomb: self.coulomb.beside(other.coulomb),
            viscous: self.viscous.beside(other.viscous),
            deflection: self.deflection.beside(other.deflection),
            bristle_damping: self.bristle_damping.beside(other.bristle_damping),
            excess: self.excess.beside(other.excess),
            velocity: self.velocity.beside(other.velocity),
            lag: both(self.lag, other.lag),
            lag_growth: both(self.lag_growth, other.lag_growth),
            exponent: both(self.exponent, other.exponent),
            gap: both(self.gap, other.gap),
            ..self
        }
    }
}

/// The gap among ways that are fitted beside a wind-up, by the factor of the way across it.
fn gap(others: &[Way], known: &[Known]) -> Option<Known> {
    let mut column = 0;
    for way in others {
        if let Way::Flanks(flanks) = way {
            return Some(known[column].of(flanks.gap()));
        }
        column += way.width();
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    impl ByTheLoad {
        /// Elements that slip, and nothing else.
        pub(crate) fn of_elements(elements: Elements) -> Self {
            let none = Known::new(0.0, 0.0);
            Self {
                stiffness: none,
                damping: none,
                mass: none,
                unrubbed: none,
                motor_side: None,
                more: More::default(),
                coulomb: none,
                viscous: none,
                viscous_asymmetry: None,
                coulomb_asymmetry: None,
                deflection: elements.known_deflection(),
                elements: Some(elements),
                bristle_damping: none,
                excess: none,
                velocity: none,
                lag: None,
                lag_growth: None,
                exponent: None,
                gap: None,
            }
        }
    }

    use crate::evidence::difference::carried::instead;
    use crate::evidence::difference::carried::tests::{
        FRICTION, STIFFNESS, UNIT, WAYS, apart, axis,
    };
    use crate::evidence::difference::edges::Flanks;

    const SMALLEST: Smallest = Smallest {
        count: 0.0,
        motor_count: 0.0,
        velocity: UNIT,
    };

    #[test]
    fn masses_screw_and_friction_are_those_of_the_axis() {
        let axis = axis(|_| 0.0);
        let apart = apart(&axis);
        let ways = instead(&apart, &WAYS, UNIT, 0.0).unwrap();
        let told = told(&apart, &ways, 1, SMALLEST, None).unwrap();
        let wanted = [
            (told.unrubbed, STIFFNESS, 0.005),
            (told.coulomb, 25.0, 0.01),
            (told.viscous, 200.0, 0.01),
            (told.deflection, FRICTION.deflection, 0.01),
            (told.excess, 25.0 * FRICTION.rise, 0.05),
            (told.velocity, FRICTION.velocity, 0.05),
        ];
        for (known, truth, share) in wanted {
            assert!(
                (known.value / truth - 1.0).abs() < share,
                "{known:?}, {truth}"
            );
            let half_width = known.half_width / known.value;
            assert!((1.0e-6..2.0 * share).contains(&half_width), "{known:?}");
        }
        // What friction of the motor's side could hide is in their intervals.
        for (known, truth) in [(told.stiffness, STIFFNESS), (told.mass, 60.0)] {
            assert!((known.value / truth - 1.0).abs() < 0.005, "{known:?}");
            let half_width = known.half_width / known.value;
            assert!((1.0e-3..0.25).contains(&half_width), "{known:?}");
        }
        // The made axis has no damper, no gap and no friction of its motor.
        assert_eq!(told.motor_side, None);
        assert!(told.damping.value.abs() < 1.0e-5 * STIFFNESS, "{told:?}");
        let bristle = told.bristle_damping;
        assert!(
            bristle.value.abs() <= 3.0 * bristle.half_width,
            "{bristle:?}"
        );
        // Half a millisecond of the bristle's stiffness.
        let most = 0.5e-3 * 25.0 / FRICTION.deflection;
        assert!(bristle.half_width < most, "{bristle:?}");
        assert_eq!(told.gap, None);
    }

    #[test]
    fn only_a_wind_up_that_the_load_asks_for_tells() {
        let axis = axis(|_| 0.0);
        let apart = apart(&axis);
        assert_eq!(told(&apart, &WAYS, 1, SMALLEST, None), None);
        assert_eq!(told(&apart, &WAYS, 7, SMALLEST, None), None);
    }

    #[test]
    fn a_gap_is_as_many_times_as_wide_as_the_factor_of_its_way_says() {
        let flanks = Flanks {
            low: -1.0e-5,
            high: 3.0e-5,
            ..Flanks::default()
        };
        let ways = [
            Way::Pitch { per_length: 100.0 },
            Way::Constant,
            Way::Flanks(flanks),
        ];
        let nine = Known::new(9.0, 9.0);
        let gap = gap(&ways, &[nine, nine, nine, Known::new(1.02, 0.05)]).unwrap();
        assert!((gap.value - 4.08e-5).abs() < 1.0e-12, "{gap:?}");
        assert!((gap.half_width - 2.0e-6).abs() < 1.0e-12, "{gap:?}");
        assert_eq!(super::gap(&ways[..2], &[nine; 3]), None);
    }
}
