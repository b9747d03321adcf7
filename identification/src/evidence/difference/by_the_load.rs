//! What the load's own motion tells of the axis, with intervals.
//!
//! Wind-up that is fitted to motor − load ([`carried`](super::carried)) has its coefficients over
//! the stiffness: M2/K, Fc2/K, C/K. The stiffness itself is in the effort alone, beside the wind-up
//! that was measured: `F = M1·a1 + F0 + K·D(d − c) + C·ḋ in contact` ([`flanks`](super::flanks)).
//!
//! Intervals are those of the jackknife over held-out blocks. Deflection, rise and velocity of the
//! bristle have them by the derivative of its columns, which are fitted beside the others; so has
//! the gap by the way across it. A
//! product has the root of the sum of squares of its factors' relative half widths.
//!
//! Units: m or rad, s, unit of the effort.

use super::columns::{Apart, Way};
use super::flanks::{Balance, Stiffness};
use super::known::Known;
use super::load::{Carried, LoadFriction};
use crate::fit::blocks::Blocks;

/// What the load's motion tells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ByTheLoad {
    /// Stiffness between motor and load.
    pub stiffness: Known,
    /// Damping between them.
    pub damping: Known,
    /// Mass of the load.
    pub mass: Known,
    /// Whether the motor's own side has friction beside that of the load.
    pub motor_rubs: bool,
    /// Coulomb level of the load.
    pub coulomb: Known,
    /// Viscous friction of the load.
    pub viscous: Known,
    /// Deflection of its bristle: Coulomb level over its stiffness.
    pub deflection: Known,
    /// Friction at rest beyond the Coulomb level.
    pub excess: Known,
    /// Velocity at which that has fallen to 1/e.
    pub velocity: Known,
    /// Width of the gap, where there is one.
    pub gap: Option<Known>,
}

/// Part of a parameter by which its columns are differentiated.
const STEP: f64 = 0.01;

/// What the wind-up at a place of such ways tells.
pub(super) fn told(apart: &Apart<'_>, ways: &[Way], place: usize) -> Option<ByTheLoad> {
    let Some(Way::Carried(carried)) = ways.get(place).copied() else {
        return None;
    };
    let apart = &apart.where_known(ways);
    let fitted = apart.fit(ways);
    let (way, own) = fitted.at(place)?;
    let Stiffness {
        known: stiffness,
        is_rubbed,
    } = Balance::of(apart).stiffness(carried.flanks)?;
    let others: Vec<Way> = ways.iter().copied().filter(|one| *one != way).collect();
    let columns = apart.columns(way);
    let bent = derivatives(apart, carried, own);
    let design = [columns, bent, apart.design(&others)].concat();
    let design: Vec<&[f64]> = design.iter().map(Vec::as_slice).collect();
    let blocks = Blocks::new(&design, &apart.target, &apart.mask, apart.motion.period_s);
    let (values, half_widths) = (blocks.fit().coefficients, blocks.half_widths());
    let known = |column: usize| Known::new(values[column], half_widths[column]);
    let LoadFriction {
        deflection,
        rise,
        velocity,
    } = carried.friction;
    // A step of Gauss and Newton from where the search ended.
    let of_friction = |value: f64, parameter: usize| {
        let column = own.len() + parameter;
        Known::new(1.0 + values[column], half_widths[column]).of(value)
    };
    let coulomb = known(Carried::FRICTION).times(stiffness);
    let damping = known(Carried::DAMPING).times(stiffness);
    Some(ByTheLoad {
        stiffness,
        damping: damping.of(-1.0),
        mass: known(Carried::MASS).times(stiffness),
        motor_rubs: is_rubbed,
        coulomb,
        viscous: known(Carried::VISCOUS).times(stiffness),
        deflection: of_friction(deflection, 0),
        excess: of_friction(rise, 1).times(coulomb),
        velocity: of_friction(velocity, 2),
        gap: gap(
            &others,
            &values[own.len() + 3..],
            &half_widths[own.len() + 3..],
        ),
    })
}

/// The gap among ways that are fitted beside a wind-up, by the factor of the way across it.
fn gap(others: &[Way], values: &[f64], half_widths: &[f64]) -> Option<Known> {
    let mut column = 0;
    for way in others {
        if let Way::Flanks(flanks) = way {
            let [factor, half_width] = [values[column], half_widths[column]];
            return Some(Known::new(factor, half_width).of(flanks.gap()));
        }
        column += way.width();
    }
    None
}

/// How motor − load changes with deflection, rise and velocity, each by its own size.
fn derivatives(apart: &Apart<'_>, carried: Carried, own: &[f64]) -> Vec<Vec<f64>> {
    let at = |factors: [f64; 3]| {
        let friction = carried.friction.scaled(factors);
        apart.predicted(
            Way::Carried(Carried {
                friction,
                ..carried
            }),
            own,
        )
    };
    let place = |parameter: usize, by: f64| {
        let mut factors = [1.0; 3];
        factors[parameter] += by;
        at(factors)
    };
    let of = |parameter: usize| {
        let pairs = place(parameter, STEP)
            .into_iter()
            .zip(place(parameter, -STEP));
        pairs.map(|(up, down)| (up - down) / (2.0 * STEP)).collect()
    };
    (0..3).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::difference::carried::instead;
    use crate::evidence::difference::carried::tests::{
        FRICTION, STIFFNESS, UNIT, WAYS, apart, axis,
    };
    use crate::evidence::difference::edges::Flanks;

    #[test]
    fn masses_screw_and_friction_are_those_of_the_axis() {
        let axis = axis(|_| 0.0);
        let apart = apart(&axis);
        let ways = instead(&apart, &WAYS, UNIT).unwrap();
        let told = told(&apart, &ways, 1).unwrap();
        let wanted = [
            (told.stiffness, STIFFNESS, 0.005),
            (told.mass, 60.0, 0.005),
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
        // The made axis has no damper, no gap and no friction of its motor.
        assert!(!told.motor_rubs);
        assert!(told.damping.value.abs() < 1.0e-5 * STIFFNESS, "{told:?}");
        assert_eq!(told.gap, None);
    }

    #[test]
    fn only_a_wind_up_that_the_load_asks_for_tells() {
        let axis = axis(|_| 0.0);
        let apart = apart(&axis);
        assert_eq!(told(&apart, &WAYS, 1), None);
        assert_eq!(told(&apart, &WAYS, 7), None);
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
        let gap = gap(&ways, &[9.0, 9.0, 9.0, 1.02], &[9.0, 9.0, 9.0, 0.05]).unwrap();
        assert!((gap.value - 4.08e-5).abs() < 1.0e-12, "{gap:?}");
        assert!((gap.half_width - 2.0e-6).abs() < 1.0e-12, "{gap:?}");
        assert_eq!(super::gap(&ways[..2], &[1.0; 3], &[0.0; 3]), None);
    }
}
