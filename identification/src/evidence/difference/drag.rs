//! A drag of the load in the place of a fall of its friction that goes over most velocities.
//!
//! Both bend friction over the velocity the same way: beside 2000 N s/m, 4 kN s²/m² pass for 155 N
//! that fall over 100 mm/s, and a bristle half as long. Falls that are known go over some mm/s, so
//! a wide one has to leave clearly less than a drag.

use super::columns::{Apart, Way};
use super::load::{Carried, More};
use super::refined::stepped;
use super::rubbing::LoadFriction;
use super::slipping;
use crate::model::effects::stribeck::GAUSS;

/// A fall is wide from this part of the highest velocity of a record on.
const WIDE: f64 = 0.1;
/// Deflections to start from, in those beside the fall.
const DEFLECTIONS: [f64; 4] = [0.6, 1.0, 1.6, 2.5];

/// The same ways, with a drag for a wide fall where that leaves as little.
pub(super) fn for_a_wide_fall(apart: &Apart<'_>, ways: Vec<Way>, place: usize) -> Vec<Way> {
    let Some(own) = slipping::carried(&ways, place).filter(|own| is_wide(apart, *own)) else {
        return ways;
    };
    let dragged = |factor: f64| {
        let friction = LoadFriction {
            deflection: factor * own.friction.deflection,
            rise: 0.0,
            lag_s: 0.0,
            lag_growth: 0.0,
            exponent: GAUSS,
            ..own.friction
        };
        let more = More {
            squared: true,
            ..own.more
        };
        let dragged = Carried {
            friction,
            more,
            ..own
        };
        let changed = stepped(apart, slipping::instead(&ways, place, dragged), place);
        (apart.blocks(&changed).fit().sse, changed)
    };
    let tried = DEFLECTIONS.into_iter().map(dragged);
    let tried = tried.filter(|(_, changed)| slipping::holds_back(apart, changed, place));
    let best = tried.min_by(|a, b| a.0.total_cmp(&b.0));
    let as_good = best.filter(|(_, best)| !slipping::is_better(apart, best, &ways));
    as_good.map_or(ways, |(_, best)| best)
}

fn is_wide(apart: &Apart<'_>, own: Carried) -> bool {
    let LoadFriction { rise, velocity, .. } = own.friction;
    let rows = apart.motion.velocity_lp.iter();
    let highest = rows.fold(0.0_f64, |highest, v| highest.max(v.abs()));
    rise > 0.0 && !own.more.squared && velocity > WIDE * highest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::difference::carried::instead;
    use crate::evidence::difference::carried::tests::{
        FRICTION, LEVEL, UNIT, WAYS, apart, dragged, rubbed, rubbing_alone,
    };

    /// N s²/m².
    const DRAG: f64 = 3000.0;

    #[test]
    fn a_drag_is_no_fall_and_leaves_the_deflection_as_it_is() {
        let axis = dragged(LEVEL, DRAG);
        let apart = apart(&axis);
        let passes_for_it = LoadFriction {
            deflection: 0.5 * FRICTION.deflection,
            velocity: 0.05,
            exponent: 0.8,
            ..FRICTION
        };
        let wide = rubbing_alone(passes_for_it);
        let ways = stepped(&apart, vec![Way::Constant, Way::Carried(wide)], 1);
        let own = slipping::carried(&ways, 1).unwrap();
        assert!(own.friction.rise > 0.0 && !own.more.squared, "{own:?}");
        let ways = for_a_wide_fall(&apart, ways, 1);
        let own = slipping::carried(&ways, 1).unwrap();
        assert!(own.more.squared, "{own:?}");
        let deflection = own.friction.deflection;
        let off = (deflection / FRICTION.deflection - 1.0).abs();
        assert!(off < 0.05, "{own:?}");
        let fitted = apart.fit(&ways);
        let (_, coefficients) = fitted.at(1).unwrap();
        let ratio = coefficients[own.width() - 1] / coefficients[Carried::VISCOUS];
        assert!((ratio * 200.0 / DRAG - 1.0).abs() < 0.1, "{ratio}");
    }

    #[test]
    fn a_fall_over_some_of_the_velocities_stays_one() {
        // The highest velocity is 0.1 m/s.
        for velocity in [4.0e-3, 30.0e-3] {
            let friction = LoadFriction {
                velocity,
                ..FRICTION
            };
            let axis = rubbed(friction, 0.0, |_| 0.0);
            let apart = apart(&axis);
            let ways = instead(&apart, &WAYS, UNIT, 0.0).unwrap();
            let own = slipping::carried(&ways, 1).unwrap();
            assert!(!own.more.squared && own.friction.rise > 0.2, "{own:?}");
        }
    }

    #[test]
    fn what_pushes_with_the_square_of_the_velocity_is_no_drag() {
        let axis = dragged(LEVEL, -1000.0);
        let apart = apart(&axis);
        let ways = instead(&apart, &WAYS, UNIT, 0.0).unwrap();
        let own = slipping::carried(&ways, 1).unwrap();
        assert!(!own.more.squared, "{own:?}");
    }
}
