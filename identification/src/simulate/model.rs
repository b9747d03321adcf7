//! An identified model, ready to be simulated.
//!
//! ```text
//! commanded u ─▶ [ u/(1 + k |u|) ] ─▶ motor ─▶ [ mechanics ] ◀─ load
//!                                       ▲ ripple             ▲ friction level, other forces
//! ```
//!
//! The inverse model gives forces by motion; here they act. Masses are in the mechanics' state, the
//! delay in what holds the efforts ([`hold`](crate::simulate::hold)), the saturation on the effort.
//! Its parameters as a table: [`parameters`](crate::simulate::parameters).

use axis_model::EffectName;

use crate::fit::fitted::Fitted;
use crate::model::effects::stribeck::Stribeck;
use crate::model::effects::torque_saturation::Saturation;
use crate::model::effects::{Action, Effect, Instant, Stage, Steady};
use crate::model::inverse::Part;
use crate::record::dataset::Dataset;
use crate::record::units::EffortHold;
use crate::simulate::axis::{Acting, Mechanics, Shape};

pub(crate) mod estimates;

/// A force with its coefficients.
#[derive(Clone)]
pub(crate) struct Force {
    /// Which effect, and its nonlinear parameter.
    pub part: Part,
    /// Coefficients of its columns.
    pub own: Vec<f64>,
}

impl Force {
    /// A fall that lags, and its velocity.
    fn lagging(&self) -> Option<(Stribeck, f64)> {
        let Part {
            effect, parameter, ..
        } = self.part;
        let fall = effect.fall().filter(|_| effect.lag_s() > 0.0)?;
        Some((fall, parameter))
    }
}

/// A model for free-run simulation.
#[derive(Clone)]
pub(crate) struct Simulated {
    /// Moved mass, and what makes a reversal.
    pub mechanics: Mechanics,
    /// Forces.
    pub forces: Vec<Force>,
    /// The actuator.
    pub saturation: Saturation,
    /// Delay beyond the hold, s.
    pub delay_s: f64,
    /// By how much the recorded effort was logged late, s.
    pub logged_late_s: f64,
    /// Middle and half of the travel of the training record.
    travel: (f64, f64),
    /// Duration of the training record, s.
    duration_s: f64,
}

/// A moment of a simulation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Moment {
    /// Time since the start of the record, s.
    pub time_s: f64,
    /// Position of the motor.
    pub position: f64,
    /// Velocity of the load.
    pub velocity: f64,
    /// Commanded effort.
    pub commanded: f64,
    /// What is left of a fall that lags.
    pub left: Option<f64>,
}

/// Part of the delay of a record that the simulation has by itself, s. A simulated effort is held
/// from its row on; an instantaneous record sees half a period of that as delay.
const fn hold_s(hold: EffortHold, period_s: f64) -> f64 {
    match hold {
        EffortHold::Instant => 0.5 * period_s,
        EffortHold::ZeroOrder => 0.0,
    }
}

impl Simulated {
    /// The simulation of an inverse model; `None` where it has no mass.
    #[must_use]
    pub(crate) fn new(
        dataset: &Dataset,
        period_s: f64,
        fitted: &Fitted,
        shape: Shape,
    ) -> Option<Self> {
        let mass = *fitted.of(EffectName::Inertia)?.first()?;
        let is_force = |part: &Part| part.effect.stage() == Stage::Force && !part.effect.is_mass();
        let forces = fitted.terms().filter(|term| is_force(term.part));
        let forces = forces.map(|term| Force {
            part: term.part.clone(),
            own: term.own.to_vec(),
        });
        let delay_s = fitted.model().delay_s() - hold_s(dataset.hold, period_s);
        (mass > 0.0).then(|| Self {
            mechanics: Mechanics { mass, shape },
            forces: forces.collect(),
            saturation: fitted.model().saturation(),
            delay_s: delay_s.max(0.0),
            logged_late_s: fitted.model().logged_late_s(),
            travel: dataset.travel(),
            duration_s: dataset.train.duration_s(),
        })
    }

    /// Its forces, ready to act.
    #[must_use]
    pub(crate) fn at_work(&self) -> Forces<'_> {
        let steady = |force: &Force| force.part.effect.steady(&force.own);
        let of = |follows_load: bool| {
            let is_one = move |force: &&Force| force.part.effect.follows_load() == follows_load;
            let forces = self.forces.iter().filter(is_one);
            let forces = forces.filter(|force| steady(force).is_none());
            forces.map(AtWork::of).collect()
        };
        let (middle, half) = self.travel;
        let all_steady = self.forces.iter().filter_map(steady);
        Forces {
            model: self,
            middle,
            per_half: 1.0 / half,
            per_duration: 1.0 / self.duration_s,
            steady: all_steady.fold(Steady::default(), Steady::and),
            by_motion: of(false),
            by_load: of(true),
            lagging: self.forces.iter().find_map(Force::lagging),
        }
    }
}

/// A force at work.
struct AtWork<'a> {
    effect: &'static dyn Effect,
    parameter: f64,
    own: &'a [f64],
    on_motor: bool,
}

impl<'a> AtWork<'a> {
    fn of(force: &'a Force) -> Self {
        let Force { part, own } = force;
        Self {
            effect: part.effect,
            parameter: part.parameter,
            own,
            on_motor: part.effect.acts_on_motor(),
        }
    }
}

/// The forces of a model, in the order in which they are known at a moment: those that follow from
/// the motion, then those that follow the load.
pub(crate) struct Forces<'a> {
    model: &'a Simulated,
    /// Middle of the travel, one over its half, and one over the duration of the training record.
    middle: f64,
    per_half: f64,
    per_duration: f64,
    /// All that are the same everywhere; their level is the Coulomb friction.
    steady: Steady,
    by_motion: Vec<AtWork<'a>>,
    by_load: Vec<AtWork<'a>>,
    /// A fall that lags, and its velocity.
    lagging: Option<(Stribeck, f64)>,
}

impl Forces<'_> {
    /// What they act on.
    #[inline]
    #[must_use]
    pub(crate) const fn mechanics(&self) -> &Mechanics {
        &self.model.mechanics
    }

    /// What is left of a fall that lags, where there is one: as after a long time at a velocity.
    #[must_use]
    pub(crate) fn left_at(&self, velocity: f64) -> Option<f64> {
        let (fall, vs) = self.lagging?;
        Some(fall.left(velocity, vs))
    }

    /// The same after a time at another velocity.
    #[inline]
    #[must_use]
    pub(crate) fn left_after(&self, left: Option<f64>, velocity: f64, time_s: f64) -> Option<f64> {
        let (fall, vs) = self.lagging?;
        Some(fall.left_after(left?, (velocity, vs), time_s))
    }

    #[inline]
    fn instant(&self, now: Moment) -> Instant {
        Instant {
            position: now.position,
            scaled: (now.position - self.middle) * self.per_half,
            velocity: now.velocity,
            left: now.left,
            time_s: now.time_s,
            time_share: now.time_s * self.per_duration,
            ..Instant::default()
        }
    }

    /// What acts at a moment.
    #[inline]
    #[must_use]
    pub(crate) fn acting(&self, now: Moment) -> Acting {
        let instant = self.instant(now);
        let mut acting = Acting {
            motor: self.model.saturation.delivered(now.commanded),
            ..Acting::default()
        };
        acting.add(self.steady.at(now.velocity), false);
        acting.add_all(&self.by_motion, &instant);
        if self.by_load.is_empty() {
            return acting;
        }
        let loaded = Instant {
            effort: acting.motor,
            resistance: acting.resistance(now.velocity),
            surface: self.surface(&instant),
            ..instant
        };
        acting.add_all(&self.by_load, &loaded);
        acting
    }

    /// Friction level over Coulomb friction, as far as it is a matter of the surface.
    fn surface(&self, at: &Instant) -> f64 {
        let level = |force: &AtWork<'_>| force.effect.action(at, force.parameter, force.own).level;
        let of_surface = |force: &&AtWork<'_>| !force.effect.comes_and_goes();
        let coulomb = self.steady.level;
        let more: f64 = self.by_motion.iter().filter(of_surface).map(level).sum();
        if coulomb > 0.0 {
            (coulomb + more) / coulomb
        } else {
            1.0
        }
    }
}

impl Acting {
    #[inline]
    fn add_all(&mut self, forces: &[AtWork<'_>], at: &Instant) {
        for force in forces {
            let action = force.effect.action(at, force.parameter, force.own);
            self.add(action, force.on_motor);
        }
    }

    #[inline]
    fn add(&mut self, action: Action, on_motor: bool) {
        self.level += action.level;
        self.mass += action.mass;
        if on_motor {
            self.motor -= action.force;
        } else {
            self.load += action.force;
        }
    }

    /// Force against the motor at a velocity, the inertia apart; at rest it holds the effort.
    #[inline]
    fn resistance(&self, velocity: f64) -> f64 {
        if velocity == 0.0 {
            self.motor
        } else {
            self.load + self.level * velocity.signum()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::made;
    use EffectName::{
        Coulomb, Delay, FrictionDrift, Inertia, Offset, PositionDependentFriction, TorqueRipple,
        TorqueSaturation, Viscous,
    };

    /// Positions from 1 m to 5 m over 10 s.
    fn dataset() -> Dataset {
        let positions = vec![1.0, 2.0, 3.0, 4.0, 5.0];
        made::dataset(made::record(2.0, positions), None)
    }

    fn model(parts: &[(EffectName, f64, &[f64])]) -> Option<Simulated> {
        Simulated::new(&dataset(), 2.0, &made::fitted(parts), Shape::default())
    }

    const MASS: (EffectName, f64, &[f64]) = (Inertia, 0.0, &[90.0]);

    #[test]
    fn without_a_positive_mass_there_is_no_simulation() {
        assert!(model(&[(Coulomb, 0.0, &[25.0])]).is_none());
        assert!(model(&[(Inertia, 0.0, &[0.0])]).is_none());
        assert!(model(&[(Inertia, 0.0, &[-90.0])]).is_none());
        let simulated = model(&[MASS]).unwrap();
        assert_eq!(
            (simulated.mechanics.mass, simulated.forces.len()),
            (90.0, 0)
        );
    }

    #[test]
    fn friction_is_a_level_and_forces_act_against_positive_motion_on_the_load() {
        let parts = [
            MASS,
            (Coulomb, 0.0, &[25.0]),
            (Viscous, 0.0, &[200.0]),
            (Offset, 0.0, &[3.0]),
        ];
        let now = Moment {
            velocity: 0.1,
            commanded: 60.0,
            ..Moment::default()
        };
        let acting = model(&parts).unwrap().at_work().acting(now);
        let wanted = Acting {
            motor: 60.0,
            load: 23.0,
            level: 25.0,
            mass: 0.0,
        };
        assert_eq!(acting, wanted);
    }

    #[test]
    fn what_resists_is_load_and_friction_by_direction_and_at_rest_the_effort() {
        let acting = Acting {
            motor: 60.0,
            load: 23.0,
            level: 25.0,
            mass: 0.0,
        };
        for (velocity, wanted) in [(0.1, 48.0), (-0.1, -2.0), (0.0, 60.0)] {
            assert_eq!(acting.resistance(velocity), wanted, "{velocity} m/s");
        }
    }

    #[test]
    fn ripple_acts_against_the_motor() {
        // A cosine of 7 N at its crest.
        let parts = [MASS, (TorqueRipple, 0.5, &[7.0, 0.0])];
        let now = Moment {
            position: 4.0,
            commanded: 60.0,
            ..Moment::default()
        };
        let acting = model(&parts).unwrap().at_work().acting(now);
        assert!((acting.motor - 53.0).abs() < 1.0e-12 && acting.load == 0.0);
    }

    #[test]
    fn a_saturating_drive_delivers_less_on_both_sides() {
        let simulated = model(&[MASS, (TorqueSaturation, 0.01, &[])]).unwrap();
        for sign in [1.0, -1.0] {
            let now = Moment {
                commanded: sign * 100.0,
                ..Moment::default()
            };
            assert_eq!(simulated.at_work().acting(now).motor, sign * 50.0);
        }
    }

    #[test]
    fn positions_count_from_the_middle_of_the_travel_and_times_by_the_duration() {
        let now = Moment {
            time_s: 2.5,
            position: 4.0,
            ..Moment::default()
        };
        let instant = model(&[MASS]).unwrap().at_work().instant(now);
        assert_eq!((instant.scaled, instant.time_share), (0.5, 0.25));
        assert_eq!((instant.position, instant.time_s), (4.0, 2.5));
        // Friction by place 6 N a half travel, friction that falls to 1/e of 8 N in 2.5 s.
        let parts = [
            MASS,
            (PositionDependentFriction, 1.0, &[6.0]),
            (FrictionDrift, 2.5, &[8.0, 0.0]),
        ];
        let level = model(&parts).unwrap().at_work().acting(now).level;
        assert!(
            (level - (3.0 + 8.0 * (-1.0_f64).exp())).abs() < 1.0e-12,
            "{level}"
        );
    }

    #[test]
    fn the_hold_of_an_instantaneous_record_is_part_of_its_delay() {
        for (hold, delay_s, wanted) in [
            (EffortHold::ZeroOrder, 1.5, 1.5),
            (EffortHold::Instant, 1.5, 0.5),
            (EffortHold::Instant, 0.75, 0.0),
        ] {
            let dataset = Dataset { hold, ..dataset() };
            let fitted = made::fitted(&[MASS, (Delay, delay_s, &[])]);
            let simulated = Simulated::new(&dataset, 2.0, &fitted, Shape::default()).unwrap();
            assert_eq!(simulated.delay_s, wanted, "{hold:?}, {delay_s} s");
        }
    }
}
