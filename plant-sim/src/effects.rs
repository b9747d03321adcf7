//! What real axes have besides mass, screw and friction law: one file for each effect.
//!
//! The parameters are those of the vocabulary ([`axis_model`]). A file of this folder says what an
//! effect *does*: it implements [`Simulated`] for the parameters. Adding one is adding its file and
//! its line in `simulated`.
//!
//! ```text
//! commanded ─ delivered_n ─ delay_s ─▶ motor ─ motor_n ─▶ screw ─▶ table ─ table_n
//!                                                          mass: its own + added_mass_kg
//!                                                          friction: factor · level + level_n
//!                                                          load scale: scale_error_m
//! ```

use axis_model::{Effect, EffectName};

mod delay;
mod friction_drift;
mod load_dependent_friction;
mod offset;
mod payload;
mod pitch_error;
mod position_dependent_friction;
mod position_dependent_inertia;
mod torque_constant_ripple;
mod torque_ripple;
mod torque_saturation;

/// Friction never vanishes altogether: a bristle without friction has no equation.
const SMALLEST_FACTOR: f64 = 1.0e-3;

/// Where an axis stands in the middle of a sub-step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Instant {
    /// Motor position at the table, m.
    pub motor_m: f64,
    /// Table position, m.
    pub table_m: f64,
    /// Table velocity, m/s.
    pub table_m_per_s: f64,
    /// Time since the axis was switched on, s.
    pub time_s: f64,
    /// Travel per motor revolution, m.
    pub lead_m: f64,
    /// Force that the drive delivers to the motor, before any ripple, N.
    pub delivered_n: f64,
    /// Force that the screw transmits to the table, N.
    pub transmitted_n: f64,
}

/// What an effect does to an axis. Everything is off unless an effect says otherwise.
pub trait Simulated {
    /// What the simulator cannot do with these parameters, and what to do about it.
    fn refusal(&self) -> Option<&'static str> {
        None
    }

    /// Force on the motor, N.
    fn motor_n(&self, _at: &Instant) -> f64 {
        0.0
    }

    /// Force on the table, N.
    fn table_n(&self, _at: &Instant) -> f64 {
        0.0
    }

    /// Mass that moves with the table beside its own, kg.
    fn added_mass_kg(&self, _at: &Instant) -> f64 {
        0.0
    }

    /// Factor on the friction level at the table.
    fn friction_factor(&self, _at: &Instant) -> f64 {
        1.0
    }

    /// Friction level at the table beside the one of the law, N.
    fn friction_level_n(&self, _at: &Instant) -> f64 {
        0.0
    }

    /// Error of the load scale at a table position, m.
    fn scale_error_m(&self, _table_m: f64) -> f64 {
        0.0
    }

    /// Force that a commanded force delivers, N.
    fn delivered_n(&self, commanded_n: f64) -> f64 {
        commanded_n
    }

    /// Time by which the force acts later, besides the transport delay of the bus, s.
    fn delay_s(&self) -> f64 {
        0.0
    }
}

/// What an effect does, where it is one of this folder.
fn simulated(effect: &Effect) -> Option<&dyn Simulated> {
    match effect {
        Effect::Offset(own) => Some(own),
        Effect::TorqueRipple(own) => Some(own),
        Effect::PitchError(own) => Some(own),
        Effect::PositionDependentFriction(own) => Some(own),
        Effect::FrictionDrift(own) => Some(own),
        Effect::LoadDependentFriction(own) => Some(own),
        Effect::Payload(own) => Some(own),
        Effect::PositionDependentInertia(own) => Some(own),
        Effect::TorqueConstantRipple(own) => Some(own),
        Effect::TorqueSaturation(own) => Some(own),
        Effect::Delay(own) => Some(own),
        _ => None,
    }
}

/// An effect that the simulator does not have, or not with these parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Refused {
    /// Which.
    pub effect: EffectName,
    /// Why, and what to do.
    pub text: &'static str,
}

/// What all effects of an axis do together within a sub-step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Acting {
    /// Force on the motor, N.
    pub motor_n: f64,
    /// Force on the table, N.
    pub table_n: f64,
    /// Mass that moves with the table beside its own, kg.
    pub added_mass_kg: f64,
    /// Factor on the friction level at the table.
    pub friction_factor: f64,
    /// Friction level at the table beside the one of the law, N.
    pub friction_level_n: f64,
}

impl Acting {
    /// Nothing.
    pub const NONE: Self = Self {
        motor_n: 0.0,
        table_n: 0.0,
        added_mass_kg: 0.0,
        friction_factor: 1.0,
        friction_level_n: 0.0,
    };
}

/// All further effects of an axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Effects(Vec<Effect>);

impl Effects {
    /// Takes one more.
    ///
    /// # Errors
    /// [`Refused`] where the simulator does not have it.
    pub fn add(&mut self, effect: impl Into<Effect>) -> Result<(), Refused> {
        let effect = effect.into();
        let refused = |text| Refused {
            effect: effect.name(),
            text,
        };
        let own = simulated(&effect).ok_or_else(|| refused(elsewhere(effect.name())))?;
        own.refusal().map_or(Ok(()), |text| Err(refused(text)))?;
        self.0.push(effect);
        Ok(())
    }

    /// The effects, in the order in which they came.
    #[must_use]
    pub fn list(&self) -> &[Effect] {
        &self.0
    }

    fn all(&self) -> impl Iterator<Item = &dyn Simulated> {
        self.0.iter().filter_map(simulated)
    }

    /// What they do at an instant, which nobody asks for where there is none.
    #[must_use]
    pub fn acting(&self, at: impl FnOnce() -> Instant) -> Acting {
        if self.0.is_empty() {
            return Acting::NONE;
        }
        let at = at();
        Acting {
            motor_n: self.motor_n(&at),
            table_n: self.table_n(&at),
            added_mass_kg: self.added_mass_kg(&at),
            friction_factor: self.friction_factor(&at),
            friction_level_n: self.friction_level_n(&at),
        }
    }

    /// Force on the motor, N.
    #[must_use]
    fn motor_n(&self, at: &Instant) -> f64 {
        self.all().map(|effect| effect.motor_n(at)).sum()
    }

    /// Force on the table, N.
    #[must_use]
    fn table_n(&self, at: &Instant) -> f64 {
        self.all().map(|effect| effect.table_n(at)).sum()
    }

    /// Mass that moves with the table beside its own, kg.
    #[must_use]
    fn added_mass_kg(&self, at: &Instant) -> f64 {
        self.all().map(|effect| effect.added_mass_kg(at)).sum()
    }

    /// Factor on the friction level.
    #[must_use]
    fn friction_factor(&self, at: &Instant) -> f64 {
        let factors = self.all().map(|effect| effect.friction_factor(at));
        factors.product::<f64>().max(SMALLEST_FACTOR)
    }

    /// Friction level beside the one of the law, N.
    #[must_use]
    fn friction_level_n(&self, at: &Instant) -> f64 {
        self.all().map(|effect| effect.friction_level_n(at)).sum()
    }

    /// Error of the load scale at a table position, m.
    #[must_use]
    pub fn scale_error_m(&self, table_m: f64) -> f64 {
        self.all().map(|effect| effect.scale_error_m(table_m)).sum()
    }

    /// Force that a commanded force delivers, N.
    #[must_use]
    pub fn delivered_n(&self, commanded_n: f64) -> f64 {
        self.all()
            .fold(commanded_n, |force_n, effect| effect.delivered_n(force_n))
    }

    /// Time by which the force acts later, s.
    #[must_use]
    pub fn delay_s(&self) -> f64 {
        self.all().map(Simulated::delay_s).sum()
    }
}

/// Where the simulator has an effect that is not one of this folder.
const fn elsewhere(effect: EffectName) -> &'static str {
    match effect {
        EffectName::Inertia => "give motor_inertia_kg and table_mass_kg in [axis.mechanics]",
        EffectName::Backlash => "give backlash_m in [axis.mechanics]",
        EffectName::Compliance => "give screw_stiffness_n_per_m in [axis.mechanics]",
        EffectName::LoggedLate => "the log is late, not the axis; leave it out",
        _ => "the simulator has no such effect; leave it out",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use axis_model::{Backlash, Delay, FrictionDrift, Offset, PositionDependentFriction};

    const AT: Instant = Instant {
        motor_m: 0.1,
        table_m: 0.1,
        table_m_per_s: 0.0,
        time_s: 0.0,
        lead_m: 0.01,
        delivered_n: 0.0,
        transmitted_n: 0.0,
    };

    #[test]
    fn an_axis_without_effects_is_left_alone() {
        let none = Effects::default();
        assert_eq!(none.acting(|| unreachable!("of none")), Acting::NONE);
        assert_eq!((none.scale_error_m(0.1), none.delay_s()), (0.0, 0.0));
        assert_eq!(none.delivered_n(123.4), 123.4);
    }

    #[test]
    fn forces_add_up_and_factors_multiply() {
        let mut effects = Effects::default();
        effects.add(Offset { offset: 20.0 }).unwrap();
        effects.add(Offset { offset: 5.0 }).unwrap();
        let warm_up = FrictionDrift {
            gain: 0.5,
            time_constant: 10.0,
            viscous_gain: None,
        };
        effects.add(warm_up).unwrap();
        let slope = PositionDependentFriction {
            linear: 2.0,
            quadratic: None,
        };
        effects.add(slope).unwrap();
        let acting = effects.acting(|| AT);
        assert_eq!(acting.table_n, -25.0);
        assert!((acting.friction_factor - 1.2 * 1.5).abs() < 1.0e-12);
        let far = Instant {
            table_m: -0.6,
            ..AT
        };
        assert_eq!(effects.acting(|| far).friction_factor, SMALLEST_FACTOR);
    }

    #[test]
    fn an_effect_that_is_not_simulated_is_refused_by_name() {
        let mut effects = Effects::default();
        let gap = Backlash {
            gap: 1.0e-5,
            ..Backlash::default()
        };
        let refused = effects.add(gap).unwrap_err();
        assert_eq!(refused.effect, EffectName::Backlash);
        assert!(refused.text.contains("backlash_m in [axis.mechanics]"));
        assert_eq!(effects.add(Delay { delay: 1.0e-4 }), Ok(()));
        assert_eq!(effects.list().len(), 1);
    }
}
